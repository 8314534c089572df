#include "forward/external/umbridge_client.hpp"

#include <fmt/format.h>
#include <httplib.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <map>
#include <regex>
#include <thread>

#include "base/errors.hpp"
#include "forward/external/shallow_json.hpp"

namespace calomel {

namespace {

constexpr std::size_t largest_answer = std::size_t(1) << 29;  ///< [bytes]
constexpr double behind = 5;                                  ///< the deadline come the library's own limits of each wait [s], should it ever fail
constexpr std::size_t shown = 160;                            ///< characters of a server's own words

constexpr double longest_pause = 30;  ///< between two tries [s]

/// A server's own words on one line: no more than `shown` bytes of them, cut between letters; what is no UTF-8 is replaced.
std::string shortened(const std::string& text) {
  std::size_t end = std::min(text.size(), shown);
  while (end > 0 && end < text.size() && ((unsigned char)(text[end]) & 0xC0) == 0x80) --end;
  std::string out = Json::parse(Json(text.substr(0, end)).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
  for (char& c : out)
    if ((unsigned char)(c) < 32) c = ' ';
  return out + (text.size() > end ? " ..." : "");
}

/// A value that should have been a number, in the server's words. What is nested is not written out.
std::string shortened(const Json& value) {
  return value.is_structured() ? "a list or an object" : shortened(value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

/// The numbers of a JSON array, or why they are none.
Answered<std::vector<double>> numbers_of(const Json& list, std::size_t size) {
  if (!list.is_array()) return {std::nullopt, "returned something other than a list of numbers"};
  if (list.size() != size) return {std::nullopt, fmt::format("returned {} numbers, and {} were announced", list.size(), size)};
  std::vector<double> out;
  out.reserve(size);
  for (const auto& x : list) {
    if (!x.is_number() || !std::isfinite(x.get<double>())) return {std::nullopt, fmt::format("returned {}, and a finite number is expected", shortened(x))};
    out.push_back(x.get<double>());
  }
  return {std::move(out), ""};
}

/// The JSON of an answer, or a description of a body that is not JSON. NaN and Infinity, which are no JSON, are named.
Answered<Json> json_of(const std::string& body) {
  Json json = shallow_json(body);
  if (!json.is_discarded()) return {std::move(json), ""};
  static const std::regex not_finite("[\\[, ](-?Infinity|NaN|nan|-?inf)[\\], ]");
  if (std::regex_search(body.substr(0, std::size_t(1) << 16), not_finite)) return {std::nullopt, "returned NaN or Infinity, and a finite number is expected"};
  return {std::nullopt, "returned invalid JSON: " + shortened(body)};
}

}  // namespace

/// What one attempt came to.
struct UmbridgeClient::Reply {
  int status = 0;  ///< 0: none
  std::string body;
  std::string problem;    ///< where there is no answer
  bool too_slow = false;  ///< the whole timeout has passed: no retry
};

namespace {

/// Breaks exchanges off when their time is over: the library bounds each wait for a piece, not their sum.
class Deadlines {
 public:
  using Client = std::shared_ptr<httplib::Client>;
  Deadlines() : thread_([this](const std::stop_token& over) { watch(over); }) {}

  /// One exchange's time, for the life of the object.
  class Watched {
   public:
    Watched(Deadlines& deadlines, const Client& client, double seconds) : deadlines_(deadlines), client_(client) {
      const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
      const std::lock_guard guard(deadlines_.lock_);
      deadlines_.ends_[client_] = end;
      if (end < deadlines_.next_) {
        deadlines_.next_ = end;
        deadlines_.changed_.notify_one();
      }
    }
    ~Watched() { (void)over(); }
    Watched(const Watched&) = delete;
    Watched& operator=(const Watched&) = delete;
    /// Ends the watch; whether the exchange was broken off. An answer without a stated length then looks whole.
    bool over() {
      const std::lock_guard guard(deadlines_.lock_);
      return deadlines_.ends_.erase(client_) == 0;
    }

   private:
    Deadlines& deadlines_;
    Client client_;
  };

 private:
  using Clock = std::chrono::steady_clock;
  void watch(const std::stop_token& over) {
    std::unique_lock guard(lock_);
    while (!over.stop_requested()) {
      next_ = Clock::now() + std::chrono::hours(1);
      std::vector<Client> late;
      for (auto at = ends_.begin(); at != ends_.end();) {
        if (at->second <= Clock::now()) {
          late.push_back(at->first);
          at = ends_.erase(at);
        } else {
          next_ = std::min(next_, at->second);
          ++at;
        }
      }
      if (!late.empty()) {  // without the lock: a client that is connecting answers late
        guard.unlock();
        for (const auto& client : late) client->stop();
        guard.lock();
        continue;
      }
      const auto next = next_;
      changed_.wait_until(guard, over, next, [&] { return next_ < next; });
    }
  }
  std::mutex lock_;
  std::condition_variable_any changed_;
  std::map<Client, Clock::time_point> ends_;
  Clock::time_point next_{};  ///< when the thread looks again
  std::jthread thread_;       ///< after all that it uses
};

}  // namespace

/// Connections that are kept open, one for each request under way.
class UmbridgeClient::Connections {
 public:
  explicit Connections(const UmbridgeOptions& options) : options_(options) {}

  Reply send(const std::string& path, const std::optional<Json>& body) {
    auto client = take();
    Reply reply;
    httplib::Request request;
    request.method = body ? "POST" : "GET";
    request.path = path;
    if (body) {
      request.body = body->dump();
      request.headers.emplace("Content-Type", "application/json");
    }
    bool large = false;
    request.content_receiver = [&](const char* data, std::size_t size, std::uint64_t, std::uint64_t) {
      large = reply.body.size() + size > largest_answer;
      if (large) return false;
      reply.body.append(data, size);
      return true;
    };
    Deadlines::Watched watched(deadlines_, client, options_.timeout);
    const auto result = client->send(request);
    reply.too_slow = watched.over();
    if (result && !reply.too_slow) {
      reply.status = result->status;
      give_back(std::move(client));
      return reply;
    }
    reply.body.clear();
    reply.problem = large ? "the response is larger than " + std::to_string(largest_answer) + " bytes" : problem_of(result.error(), reply.too_slow);
    return reply;
  }

 private:
  std::string problem_of(httplib::Error error, bool late) const {
    if (late) return fmt::format("no complete response within {:g} s", options_.timeout);
    if (error == httplib::Error::Connection) return "no connection";
    if (error == httplib::Error::ConnectionTimeout) return fmt::format("no connection within {:g} s", options_.connect_timeout);
    if (error == httplib::Error::Read) return "the connection was closed before the response was complete";
    return "the exchange broke off (" + httplib::to_string(error) + ")";
  }

  Deadlines::Client take() {
    {
      const std::lock_guard guard(lock_);
      if (!idle_.empty()) {
        auto client = std::move(idle_.back());
        idle_.pop_back();
        return client;
      }
    }
    auto client = std::make_shared<httplib::Client>(options_.url);
    const auto parts = [](double seconds) { return std::pair{time_t(seconds), time_t(1e6 * (seconds - std::floor(seconds)))}; };
    const auto [wait, wait_us] = parts(options_.timeout + behind);
    const auto [connect, connect_us] = parts(std::min(options_.connect_timeout, options_.timeout));
    client->set_connection_timeout(connect, connect_us);
    client->set_read_timeout(wait, wait_us);
    client->set_write_timeout(wait, wait_us);
    client->set_keep_alive(true);
    client->set_tcp_nodelay(true);
    return client;
  }
  void give_back(Deadlines::Client client) {
    const std::lock_guard guard(lock_);
    idle_.push_back(std::move(client));
  }

  const UmbridgeOptions& options_;
  std::mutex lock_;
  std::vector<Deadlines::Client> idle_;
  Deadlines deadlines_;
};

UmbridgeClient::UmbridgeClient(UmbridgeOptions options) : options_(std::move(options)) {
  while (options_.url.ends_with('/')) options_.url.pop_back();
  static const std::regex form("http://[A-Za-z0-9._\\-\\[\\]:]+");
  if (!std::regex_match(options_.url, form))
    throw InputError({.problem = "names no server",
                      .key = "model.url",
                      .value = '"' + options_.url + '"',
                      .range = "http://HOST:PORT",
                      .suggestion = "e.g. \"http://localhost:4242\""});
  connections_ = std::make_unique<Connections>(options_);
}

UmbridgeClient::~UmbridgeClient() = default;

Answered<Json> UmbridgeClient::request(const std::string& path, const std::optional<Json>& body) const {
  Reply reply;
  double pause = options_.pause;
  for (int attempt = 0;; ++attempt, pause *= 2) {
    reply = connections_->send(path, body);
    const bool busy = reply.status == 502 || reply.status == 503 || reply.status == 504;  // of something between the server and us
    if (reply.status != 0 && !busy) break;
    if (options_.stop && *options_.stop) throw Interrupted();
    if (attempt < options_.retries && !reply.too_slow) {
      wait(std::min(pause, longest_pause));
      continue;
    }
    if (busy) reply.problem = fmt::format("status {}", reply.status);
    // A server that answers other questions has lost this one: then the model fails there, and the run with it.
    if (path != "/Info" && connections_->send("/Info", std::nullopt).status == 200)
      return {std::nullopt, fmt::format("did not respond to {} requests of {}: {}", attempt + 1, path, reply.problem), true};
    throw Unreachable(
        fmt::format("the server {} does not respond to {} ({}, {} times); start it, or correct model.url", options_.url, path, reply.problem, attempt + 1));
  }
  auto json = json_of(reply.body);
  if (json.value && json.value->is_object() && json.value->contains("error")) {
    const Json& error = (*json.value)["error"];
    const auto word = [&](const char* key) {
      return error.is_object() && error.contains(key) && error[key].is_string() ? error[key].get<std::string>() : std::string();
    };
    return {std::nullopt, fmt::format("refuses {} with status {}, {}: {}", path, reply.status,
                                      word("type").empty() ? "an error without a type" : shortened(word("type")), shortened(word("message")))};
  }
  if (reply.status != 200) return {std::nullopt, fmt::format("refuses {} with status {}: {}", path, reply.status, shortened(reply.body))};
  if (json.value && !json.value->is_object()) return {std::nullopt, "returned no JSON object for " + path + ": " + shortened(reply.body)};
  return json;
}

void UmbridgeClient::wait(double seconds) const {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end) {
    if (options_.stop && *options_.stop) throw Interrupted();
    std::this_thread::sleep_for(std::min<std::chrono::duration<double>>(end - std::chrono::steady_clock::now(), std::chrono::milliseconds(100)));
  }
}

Json UmbridgeClient::about(const std::string& path) const {
  Json body{{"name", options_.name}};
  if (!options_.config.empty()) body["config"] = options_.config;
  auto answer = path == "/Info" ? request(path, std::nullopt) : request(path, body);
  if (!answer.value) throw NumericsError(fmt::format("the model \"{}\" at {} {}", options_.name, options_.url, answer.message));
  return std::move(*answer.value);
}

std::vector<std::string> UmbridgeClient::models() const {
  const Json info = about("/Info");
  const auto version = info.find("protocolVersion");
  if (version == info.end() || !version->is_number() || version->get<double>() != 1.0)
    throw NumericsError(fmt::format("the server {} does not report UM-Bridge 1.0 (its /Info: {})", options_.url,
                                    shortened(info.dump(-1, ' ', false, Json::error_handler_t::replace))));
  std::vector<std::string> names;
  if (const auto list = info.find("models"); list != info.end() && list->is_array())
    for (const auto& m : *list)
      if (m.is_string()) names.push_back(m.get<std::string>());
  return names;
}

UmbridgeSupport UmbridgeClient::support() const {
  const Json answer = about("/ModelInfo");
  const auto support = answer.find("support");
  const auto has = [&](const char* key) {
    return support != answer.end() && support->is_object() && support->contains(key) && (*support)[key].is_boolean() && (*support)[key].get<bool>();
  };
  return {has("Evaluate"), has("Gradient"), has("ApplyJacobian"), has("ApplyHessian")};
}

std::vector<std::size_t> UmbridgeClient::sizes(const std::string& path, const char* key) const {
  const Json answer = about(path);
  const auto list = answer.find(key);
  std::vector<std::size_t> out;
  const bool is_list = list != answer.end() && list->is_array();
  if (is_list)
    for (const auto& x : *list)
      if (x.is_number_integer() && x.get<std::int64_t>() > 0) out.push_back(x.get<std::size_t>());
  if (!is_list || out.empty() || out.size() != list->size())
    throw NumericsError(fmt::format("the model \"{}\" at {} returned no list of sizes for {}: {}", options_.name, options_.url, path,
                                    shortened(answer.dump(-1, ' ', false, Json::error_handler_t::replace))));
  return out;
}

std::vector<std::size_t> UmbridgeClient::input_sizes() const { return sizes("/InputSizes", "inputSizes"); }
std::vector<std::size_t> UmbridgeClient::output_sizes() const { return sizes("/OutputSizes", "outputSizes"); }

Answered<Blocks> UmbridgeClient::evaluate(const Blocks& input, std::span<const std::size_t> sizes) const {
  Json body{{"name", options_.name}, {"input", input}};
  if (!options_.config.empty()) body["config"] = options_.config;
  auto answer = request("/Evaluate", body);
  if (!answer.value) return {std::nullopt, answer.message, answer.lost};
  const auto output = answer.value->find("output");
  if (output == answer.value->end() || !output->is_array()) return {std::nullopt, "returned no output for /Evaluate"};
  if (output->size() != sizes.size()) return {std::nullopt, fmt::format("returned {} output blocks, and {} were announced", output->size(), sizes.size())};
  Blocks blocks;
  for (std::size_t b = 0; b < sizes.size(); ++b) {
    auto block = numbers_of((*output)[b], sizes[b]);
    if (!block.value) return {std::nullopt, fmt::format("{} (output block {})", block.message, b)};
    blocks.push_back(std::move(*block.value));
  }
  return {std::move(blocks), ""};
}

Answered<std::vector<double>> UmbridgeClient::action(const std::string& path, Json body, const Blocks& input, std::size_t out_wrt, std::size_t in_wrt,
                                                     std::size_t size) const {
  body.update({{"name", options_.name}, {"input", input}, {"outWrt", out_wrt}, {"inWrt", in_wrt}});
  if (!options_.config.empty()) body["config"] = options_.config;
  auto answer = request(path, body);
  if (!answer.value) return {std::nullopt, answer.message};
  const auto output = answer.value->find("output");
  return output == answer.value->end() ? Answered<std::vector<double>>{std::nullopt, "returned no output for " + path} : numbers_of(*output, size);
}

Answered<std::vector<double>> UmbridgeClient::gradient(const Blocks& input, std::size_t out_wrt, std::size_t in_wrt, std::span<const double> sens) const {
  return action("/Gradient", {{"sens", sens}}, input, out_wrt, in_wrt, input.at(in_wrt).size());
}

Answered<std::vector<double>> UmbridgeClient::apply_jacobian(const Blocks& input, std::size_t out_wrt, std::size_t in_wrt, std::span<const double> vec,
                                                             std::size_t size) const {
  return action("/ApplyJacobian", {{"vec", vec}}, input, out_wrt, in_wrt, size);
}

}  // namespace calomel
