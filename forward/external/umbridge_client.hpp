#pragma once
/// Client of UM-Bridge 1.0 (Seelinger et al. 2023, JOSS 8(83), 4748): models behind HTTP, which take blocks of numbers and give blocks of numbers.
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/json.hpp"

namespace calomel {

using Blocks = std::vector<std::vector<double>>;

struct UmbridgeOptions {
  std::string url;                          ///< "http://HOST:PORT"
  std::string name;                         ///< of the model, among those that the server lists
  double timeout = 300;                     ///< of one answer, first to last byte [s]
  double connect_timeout = 5;               ///< [s]
  int retries = 4;                          ///< of a request that was not answered
  double pause = 0.1;                       ///< before the first of them [s]; each further one is twice as long, up to half a minute
  const std::atomic<bool>* stop = nullptr;  ///< true: no more requests are sent (Interrupted)
  Json config = Json::object();             ///< handed to the model with every request; left out where empty
};

/// Requests that a model supports.
struct UmbridgeSupport {
  bool evaluate = false, gradient = false, apply_jacobian = false, apply_hessian = false;
};

/// An answer, or why there is none.
template <class T>
struct Answered {
  std::optional<T> value;
  std::string message;  ///< a clause; empty with a value
  bool lost = false;    ///< nothing came, or half of an answer: another try may have one
};

class UmbridgeClient {
 public:
  /// Errors: InputError naming model.url where it is not http://HOST:PORT.
  explicit UmbridgeClient(UmbridgeOptions options);
  ~UmbridgeClient();
  UmbridgeClient(const UmbridgeClient&) = delete;
  UmbridgeClient& operator=(const UmbridgeClient&) = delete;

  [[nodiscard]] const UmbridgeOptions& options() const { return options_; }

  /// Names of the server's models. Errors: Unreachable; NumericsError for an answer that is none of UM-Bridge 1.0.
  [[nodiscard]] std::vector<std::string> models() const;
  /// Of the model. Errors: the same.
  [[nodiscard]] UmbridgeSupport support() const;
  [[nodiscard]] std::vector<std::size_t> input_sizes() const;
  [[nodiscard]] std::vector<std::size_t> output_sizes() const;

  /// The model at `input`; `sizes`: what the blocks of the answer must be. Safe from several threads at once, each with a connection of its own.
  /// A model that fails there, or answers what cannot be (other sizes, a NaN, no JSON), is an answer with a message. Errors: Unreachable where the server is
  /// gone; Interrupted.
  [[nodiscard]] Answered<Blocks> evaluate(const Blocks& input, std::span<const std::size_t> sizes) const;
  /// sens' J: (size of input block in_wrt), of output block out_wrt.
  [[nodiscard]] Answered<std::vector<double>> gradient(const Blocks& input, std::size_t out_wrt, std::size_t in_wrt, std::span<const double> sens) const;
  /// J vec: `size` numbers, the size of output block out_wrt.
  [[nodiscard]] Answered<std::vector<double>> apply_jacobian(const Blocks& input, std::size_t out_wrt, std::size_t in_wrt, std::span<const double> vec,
                                                             std::size_t size) const;

 private:
  class Connections;
  struct Reply;
  /// One request, repeated while it is not answered. Errors: Unreachable, Interrupted.
  [[nodiscard]] Answered<Json> request(const std::string& path, const std::optional<Json>& body) const;
  void wait(double seconds) const;
  [[nodiscard]] Json about(const std::string& path) const;
  [[nodiscard]] std::vector<std::size_t> sizes(const std::string& path, const char* key) const;
  [[nodiscard]] Answered<std::vector<double>> action(const std::string& path, Json body, const Blocks& input, std::size_t out_wrt, std::size_t in_wrt,
                                                     std::size_t size) const;
  UmbridgeOptions options_;
  std::unique_ptr<Connections> connections_;
};

}  // namespace calomel
