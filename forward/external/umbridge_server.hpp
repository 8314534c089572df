#pragma once
/// Server of UM-Bridge 1.0: models of this program behind HTTP.
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "forward/external/umbridge_client.hpp"

namespace calomel {

/// A model that is offered. Its functions are called from several threads at once, at most ServeOptions::threads; they throw InputError for an input that the
/// model refuses (answered 400, InvalidInput) and anything else for one that it fails at (500, InvalidOutput). `config` is the request's, an empty object where
/// it has none.
struct ServedModel {
  std::string name;
  std::vector<std::size_t> input_sizes, output_sizes;
  std::function<Blocks(const Blocks& input, const Json& config)> evaluate;
  using Directional = std::function<std::vector<double>(const Blocks& input, std::size_t out_wrt, std::size_t in_wrt, const std::vector<double>& direction,
                                                        const Json& config)>;
  Directional gradient;        ///< sens' J of (out_wrt, in_wrt), or empty: not supported
  Directional apply_jacobian;  ///< J vec of (out_wrt, in_wrt), or empty: not supported
};

struct ServeOptions {
  std::string host = "127.0.0.1";
  int port = 4242;                                  ///< 0: any that is free
  int threads = 1;                                  ///< evaluations side by side
  int waiting = 64;                                 ///< requests that may wait for one; further ones are refused with status 503
  std::size_t largest_body = std::size_t(1) << 24;  ///< [bytes]; a greater one is refused with status 413
  double timeout = 10;                              ///< for a request to arrive and an answer to be taken [s]
};

class UmbridgeServer {
 public:
  /// Errors: InputError naming --port where the place is taken.
  UmbridgeServer(std::vector<ServedModel> models, ServeOptions options);
  ~UmbridgeServer();
  UmbridgeServer(const UmbridgeServer&) = delete;
  UmbridgeServer& operator=(const UmbridgeServer&) = delete;

  [[nodiscard]] int port() const { return port_; }
  /// Answers until `stop` is true; evaluations that have begun are made to their end, those that wait are refused.
  void run(const std::atomic<bool>& stop);
  /// Requests answered so far, errors included.
  [[nodiscard]] std::size_t answered() const { return answered_; }

 private:
  struct Http;
  void route();
  [[nodiscard]] const ServedModel& model_of(const Json& body) const;
  [[nodiscard]] Json evaluate(const Json& body);
  std::vector<ServedModel> models_;
  ServeOptions options_;
  std::unique_ptr<Http> http_;
  int port_ = 0;
  std::atomic<std::size_t> answered_ = 0;
};

}  // namespace calomel
