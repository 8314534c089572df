#include "forward/external/umbridge_server.hpp"

#include <fmt/format.h>
#include <httplib.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <thread>
#include <utility>

#include "base/errors.hpp"
#include "forward/external/shallow_json.hpp"

namespace calomel {

namespace {

constexpr time_t idle = 2;               ///< that a connection without a request is kept [s]; the server's end waits for it
constexpr int connections_a_thread = 8;  ///< that are kept open for each evaluation under way

/// Counts evaluations under way and those that wait.
class Turnstile {
 public:
  Turnstile(int threads, int waiting) : free_(threads), room_(waiting) {}
  /// False where too many wait already, or nothing is begun any more.
  bool enter() {
    std::unique_lock guard(lock_);
    if (closed_ || (free_ == 0 && waiting_ >= room_)) return false;
    ++waiting_;
    changed_.wait(guard, [&] { return closed_ || free_ > 0; });
    --waiting_;
    if (closed_) return false;
    --free_;
    return true;
  }
  /// Those that wait are sent away.
  void close() {
    {
      const std::lock_guard guard(lock_);
      closed_ = true;
    }
    changed_.notify_all();
  }
  void leave() {
    {
      const std::lock_guard guard(lock_);
      ++free_;
    }
    changed_.notify_one();
  }

 private:
  std::mutex lock_;
  std::condition_variable changed_;
  int free_, room_, waiting_ = 0;
  bool closed_ = false;
};

/// What a request is refused with.
struct Refusal {
  int status;
  std::string type, message;
  bool closes = false;  ///< the connection: what follows on it is no request
};

[[noreturn]] void refuse(const std::string& message) { throw Refusal{400, "InvalidInput", message}; }

}  // namespace

struct UmbridgeServer::Http {
  Http(int threads, int waiting) : turnstile(threads, waiting) {}
  httplib::Server server;
  Turnstile turnstile;
};

namespace {

/// Numbers of a list that must have `size` of them.
std::vector<double> numbers_of(const Json& list, std::size_t size, const std::string& what) {
  if (!list.is_array() || list.size() != size) refuse(fmt::format("{} must be a list of {} numbers", what, size));
  std::vector<double> out;
  for (const auto& x : list) {
    if (!x.is_number() || !std::isfinite(x.get<double>())) refuse(fmt::format("{} must be finite numbers", what));
    out.push_back(x.get<double>());
  }
  return out;
}

Blocks input_of(const Json& body, const std::vector<std::size_t>& sizes) {
  const auto input = body.find("input");
  if (input == body.end()) refuse("the request has no input");
  if (!input->is_array() || input->size() != sizes.size()) refuse(fmt::format("input must be a list of {} blocks", sizes.size()));
  Blocks out;
  for (std::size_t b = 0; b < sizes.size(); ++b) out.push_back(numbers_of((*input)[b], sizes[b], fmt::format("input block {}", b)));
  return out;
}

Json config_of(const Json& body) {
  const auto config = body.find("config");
  if (config == body.end()) return Json::object();
  if (!config->is_object()) refuse("config must be an object");
  return *config;
}

std::size_t index_of(const Json& body, const char* key, std::size_t size) {
  const auto at = body.find(key);
  if (at == body.end() || !at->is_number_integer() || at->get<std::int64_t>() < 0 || std::size_t(at->get<std::int64_t>()) >= size)
    refuse(fmt::format("{} must be a whole number from 0 to {}", key, size - 1));
  return at->get<std::size_t>();
}

Json given(const std::vector<double>& values) {
  for (const double x : values)
    if (!std::isfinite(x)) throw NumericsError("the model's result is not finite");
  return values;
}

}  // namespace

const ServedModel& UmbridgeServer::model_of(const Json& body) const {
  const auto name = body.find("name");
  if (name == body.end() || !name->is_string()) throw Refusal{400, "InvalidInput", "the request names no model"};
  for (const auto& m : models_)
    if (m.name == name->get<std::string>()) return m;
  std::vector<std::string> known;
  for (const auto& m : models_) known.push_back(m.name);
  throw Refusal{400, "ModelNotFound", fmt::format("there is no model \"{}\"; there are: {}", name->get<std::string>().substr(0, 100), join(known))};
}

namespace {

/// A request's whole body, decompressed. The library bounds each wait for a piece; this bounds the sum, whether pieces state their length, come without one or
/// are compressed, and the time. What is beyond the bounds is refused, with what is wrong and the status; one that states so beforehand is not read at all.
std::string read_body(const httplib::Request& request, const httplib::ContentReader& read, const httplib::Response& response, std::size_t largest,
                      double seconds) {
  const auto too_large = [&] { return Refusal{413, "InvalidInput", fmt::format("the body is too large; it may have {} bytes", largest), true}; };
  if (const std::string length = request.get_header_value("Content-Length"); !length.empty()) {
    const bool whole = std::all_of(length.begin(), length.end(), [](unsigned char c) { return std::isdigit(c); });
    if (!whole) throw Refusal{400, "InvalidInput", "Content-Length is no number of bytes", true};
    if (length.size() > 18 || std::stoull(length) > largest) throw too_large();
  }
  std::string body;
  bool late = false, large = false;
  const auto began = std::chrono::steady_clock::now();
  const bool whole = read([&](const char* piece, std::size_t size) {
    late = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count() > seconds;
    large = size > largest - body.size();
    if (late || large) return false;
    body.append(piece, size);
    return true;
  });
  if (large || (!whole && response.status == 413)) throw too_large();
  if (late) throw Refusal{408, "InvalidInput", fmt::format("the body did not arrive within {} s", number_text(seconds)), true};
  if (!whole) throw Refusal{400, "InvalidInput", "the body breaks off", true};
  return body;
}

}  // namespace

Json UmbridgeServer::evaluate(const Json& body) {
  const auto& m = model_of(body);
  const auto config = config_of(body);
  const Blocks out = m.evaluate(input_of(body, m.input_sizes), config);
  Json output = Json::array();
  for (const auto& block : out) output.push_back(given(block));
  return {{"output", std::move(output)}};
}

namespace {

/// sens' J or J vec: the direction is the list at `key`, on the output block or on the input block.
Json directional(const ServedModel& m, const Json& body, const ServedModel::Directional& of, const char* key, bool on_output) {
  const auto out_wrt = index_of(body, "outWrt", m.output_sizes.size()), in_wrt = index_of(body, "inWrt", m.input_sizes.size());
  const auto input = input_of(body, m.input_sizes);
  const auto direction = body.find(key);
  if (direction == body.end()) refuse(fmt::format("the request has no {}", key));
  return {
      {"output", given(of(input, out_wrt, in_wrt, numbers_of(*direction, on_output ? m.output_sizes[out_wrt] : m.input_sizes[in_wrt], key), config_of(body)))}};
}

}  // namespace

void UmbridgeServer::route() {
  auto& server = http_->server;
  const auto send = [this](httplib::Response& response, int status, const Json& body) {
    ++answered_;
    response.status = status;
    response.set_content(body.dump(-1, ' ', false, Json::error_handler_t::replace), "application/json");
  };
  const auto unknown_path = [](const httplib::Request& request) {
    return Refusal{404, "NotFound", fmt::format("{} {} is not part of UM-Bridge 1.0", request.method, request.path.substr(0, 100))};
  };
  // The library closes a connection when an answer cannot be written whole, and of its own accord never: the last message states that it cannot continue.
  const auto refused = [send](httplib::Response& response, const Refusal& r) {
    send(response, r.status, {{"error", {{"type", r.type}, {"message", r.message}}}});
    if (!r.closes) return;
    response.set_header("Connection", "close");
    const auto body = std::make_shared<const std::string>(std::exchange(response.body, ""));
    response.set_content_provider(body->size(), "application/json", [body](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
      sink.write(body->data() + offset, length);
      return false;
    });
  };
  // The body is JSON whatever its Content-Type is, so the library must not read it as a form, which it limits to 8 KB, nor as parts of one.
  // It hands out its own request, which is not const where it was made.
  server.set_pre_routing_handler([](const httplib::Request& request, httplib::Response&) {
    auto& own = const_cast<httplib::Request&>(request);
    own.headers.erase("Content-Type");
    // nor is a part of an answer an answer
    own.headers.erase("Range");
    own.ranges.clear();
    return httplib::Server::HandlerResponse::Unhandled;
  });
  // What is no JSON, NaN and Infinity included, is refused.
  const auto answer = [this, send, refused](const std::string& path, bool heavy, std::function<Json(const Json&)> make) {
    http_->server.Post(path,
                       [this, send, refused, heavy, make](const httplib::Request& request, httplib::Response& response, const httplib::ContentReader& read) {
                         try {
                           const Json body = shallow_json(read_body(request, read, response, options_.largest_body, options_.timeout));
                           if (!body.is_object()) refuse(fmt::format("the body is not a JSON object of at most {} levels", deepest_json));
                           if (!heavy) return send(response, 200, make(body));
                           if (!http_->turnstile.enter()) throw Refusal{503, "ServerBusy", "too many requests wait already, or the server ends"};
                           const std::shared_ptr<void> leaving(nullptr, [this](void*) { http_->turnstile.leave(); });
                           send(response, 200, make(body));
                         } catch (const Refusal& r) {
                           refused(response, r);
                         } catch (const InputError& e) {
                           refused(response, {400, "InvalidInput", e.what()});
                         } catch (const std::exception& e) {
                           refused(response, {500, "InvalidOutput", e.what()});
                         }
                       });
  };
  server.Get("/Info", [this, send](const httplib::Request&, httplib::Response& response) {
    Json names = Json::array();
    for (const auto& m : models_) names.push_back(m.name);
    send(response, 200, {{"protocolVersion", 1.0}, {"models", names}});
  });
  answer("/ModelInfo", false, [this](const Json& body) -> Json {
    const auto& m = model_of(body);
    return {{"support", {{"Evaluate", true}, {"Gradient", bool(m.gradient)}, {"ApplyJacobian", bool(m.apply_jacobian)}, {"ApplyHessian", false}}}};
  });
  answer("/InputSizes", false, [this](const Json& body) -> Json { return {{"inputSizes", model_of(body).input_sizes}}; });
  answer("/OutputSizes", false, [this](const Json& body) -> Json { return {{"outputSizes", model_of(body).output_sizes}}; });
  answer("/Evaluate", true, [this](const Json& body) { return evaluate(body); });
  answer("/Gradient", true, [this](const Json& body) {
    const auto& m = model_of(body);
    if (!m.gradient) throw Refusal{400, "UnsupportedFeature", "the model has no gradient"};
    return directional(m, body, m.gradient, "sens", true);
  });
  answer("/ApplyJacobian", true, [this](const Json& body) {
    const auto& m = model_of(body);
    if (!m.apply_jacobian) throw Refusal{400, "UnsupportedFeature", "the model has no action of its Jacobian"};
    return directional(m, body, m.apply_jacobian, "vec", false);
  });
  answer("/ApplyHessian", false, [this](const Json& body) -> Json {
    (void)model_of(body);
    throw Refusal{400, "UnsupportedFeature", "no model of this server has a Hessian"};
  });
  // Anything else is read too, so that the next request of the connection is found behind it.
  const auto unknown = [this, refused, unknown_path](const httplib::Request& request, httplib::Response& response, const httplib::ContentReader& read) {
    try {
      (void)read_body(request, read, response, options_.largest_body, options_.timeout);
      refused(response, unknown_path(request));
    } catch (const Refusal& r) {
      refused(response, r);
    }
  };
  server.Post(".*", unknown).Put(".*", unknown).Patch(".*", unknown).Delete(".*", unknown);
  server.set_error_handler([refused, unknown_path](const httplib::Request& request, httplib::Response& response) {
    if (!response.body.empty() || response.has_header("Connection")) return;  // already reported
    refused(response, response.status == 404 ? unknown_path(request) : Refusal{response.status, "InvalidRequest", "the request cannot be read"});
  });
}

UmbridgeServer::UmbridgeServer(std::vector<ServedModel> models, ServeOptions options)
    : models_(std::move(models)), options_(std::move(options)), http_(std::make_unique<Http>(options_.threads, options_.waiting)) {
  auto& server = http_->server;
  const int workers = options_.threads * connections_a_thread + options_.waiting;
  server.new_task_queue = [workers] { return new httplib::ThreadPool(std::size_t(workers)); };
  server.set_payload_max_length(options_.largest_body);
  const auto seconds = time_t(options_.timeout);
  server.set_read_timeout(seconds);
  server.set_write_timeout(seconds);
  server.set_keep_alive_max_count(1000000);
  server.set_keep_alive_timeout(idle);
  server.set_tcp_nodelay(true);
  server.set_socket_options([](socket_t socket) {  // httplib's own let two servers share a port
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  route();
  port_ = options_.port == 0 ? server.bind_to_any_port(options_.host) : server.bind_to_port(options_.host, options_.port) ? options_.port : -1;
  if (port_ < 0)
    throw InputError({.problem = fmt::format("nothing can be served at {}", options_.host),
                      .key = "--port",
                      .value = std::to_string(options_.port),
                      .suggestion = "another program has the port, or the host is not of this machine; take another, or --port 0 for any that is free"});
}

UmbridgeServer::~UmbridgeServer() = default;

void UmbridgeServer::run(const std::atomic<bool>& stop) {
  std::atomic<bool> over = false;
  std::thread watcher([&] {
    while (!over) {
      if (stop) http_->turnstile.close(), http_->server.stop();  // again and again: it does nothing before the server listens
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  http_->server.listen_after_bind();
  over = true;
  watcher.join();
}

}  // namespace calomel
