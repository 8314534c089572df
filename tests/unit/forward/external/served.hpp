#pragma once
/// Servers on a free port of this machine, for tests.
#include <Eigen/Core>  // before httplib, whose <resolv.h> makes a macro of a name of Eigen's

#include <httplib.h>

#include <atomic>
#include <thread>

#include "base/errors.hpp"
#include "forward/external/umbridge_server.hpp"

namespace calomel {

/// The program's own server with these models, as long as the object lives.
class Served {
 public:
  explicit Served(std::vector<ServedModel> models, ServeOptions options = {})
      : server_(std::move(models), at_any_port(std::move(options))), thread_([this] { server_.run(stop_); }) {}
  ~Served() {
    stop_ = true;
    thread_.join();
  }
  [[nodiscard]] std::string url() const { return "http://127.0.0.1:" + std::to_string(server_.port()); }
  [[nodiscard]] int port() const { return server_.port(); }

 private:
  static ServeOptions at_any_port(ServeOptions options) {
    options.port = 0;
    return options;
  }
  std::atomic<bool> stop_ = false;
  UmbridgeServer server_;
  std::thread thread_;
};

/// y_i = a + b t_i at t = 0, 1, 2, 3, with its gradient; a below -100 is refused, a above 100 fails.
inline ServedModel straight_line() {
  ServedModel m{.name = "line", .input_sizes = {2}, .output_sizes = {4}, .evaluate = {}, .gradient = {}, .apply_jacobian = {}};
  m.evaluate = [](const Blocks& x, const Json&) {
    if (x[0][0] < -100) throw InputError({.problem = "is too small", .key = "a"});
    if (x[0][0] > 100) throw NumericsError("the solver stopped");
    Blocks y(1);
    for (int i = 0; i < 4; ++i) y[0].push_back(x[0][0] + x[0][1] * i);
    return y;
  };
  m.gradient = [](const Blocks&, std::size_t, std::size_t, const std::vector<double>& w, const Json&) {
    return std::vector<double>{w[0] + w[1] + w[2] + w[3], w[1] + 2 * w[2] + 3 * w[3]};
  };
  m.apply_jacobian = [](const Blocks&, std::size_t, std::size_t, const std::vector<double>& v, const Json&) {
    return std::vector<double>{v[0], v[0] + v[1], v[0] + 2 * v[1], v[0] + 3 * v[1]};
  };
  return m;
}

/// A server of a model "m" ([1] -> [2]) whose /Evaluate says `body` with `status`.
class Faulty {
 public:
  explicit Faulty(std::function<void(const httplib::Request&, httplib::Response&)> evaluate) {
    const auto say = [](const char* body) { return [body](const httplib::Request&, httplib::Response& r) { r.set_content(body, "text/plain"); }; };
    server_.Get("/Info", say(R"({"protocolVersion": 1.0, "models": ["m"]})"));
    server_.Post("/ModelInfo", say(R"({"support": {"Evaluate": true, "Gradient": false, "ApplyJacobian": false, "ApplyHessian": false}})"));
    server_.Post("/InputSizes", say(R"({"inputSizes": [1]})"));
    server_.Post("/OutputSizes", say(R"({"outputSizes": [2]})"));
    server_.Post("/Evaluate", std::move(evaluate));
    port_ = server_.bind_to_any_port("127.0.0.1");
    server_.set_keep_alive_timeout(1);
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    while (!server_.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ~Faulty() {
    server_.stop();
    thread_.join();
  }
  [[nodiscard]] std::string url() const { return "http://127.0.0.1:" + std::to_string(port_); }

 private:
  httplib::Server server_;
  int port_ = 0;
  std::thread thread_;
};

}  // namespace calomel
