/// Every trap of the protocol, by raw HTTP.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>

#include "base/json.hpp"
#include "forward/external/umbridge_server.hpp"
#include "tests/unit/forward/external/served.hpp"

namespace calomel {
namespace {

struct Answer {
  int status = 0;
  Json body;
};

Answer post(const Served& served, const std::string& path, const std::string& body, const char* type = "application/json") {
  httplib::Client client("127.0.0.1", served.port());
  const auto r = client.Post(path, body, type);
  return r ? Answer{r->status, Json::parse(r->body, nullptr, false)} : Answer{};
}

/// A connection of bytes to a port of this machine.
class Connection {
 public:
  Connection(const char* address, int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(std::uint16_t(port));
    inet_pton(AF_INET, address, &to.sin_addr);
    open_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
  }
  ~Connection() { ::close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  [[nodiscard]] bool open() const { return open_; }
  /// False where the other end has closed.
  bool send(std::string_view bytes) const { return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == ssize_t(bytes.size()); }
  /// Bytes that come within `seconds`, to the end of the first piece; nothing: none came, or the other end has closed.
  [[nodiscard]] std::string read(double seconds) const {
    pollfd waiting{socket_, POLLIN, 0};
    char buffer[4096];
    if (::poll(&waiting, 1, int(1000 * seconds)) <= 0) return "";
    const auto n = ::recv(socket_, buffer, sizeof buffer, 0);
    return n > 0 ? std::string(buffer, std::size_t(n)) : "";
  }

 private:
  int socket_;
  bool open_ = false;
};

/// Blocks of two and one number in, of one and three out. Its gradient and the action of its Jacobian divide by the last number.
ServedModel blocks() {
  ServedModel m{.name = "blocks",
                .input_sizes = {2, 1},
                .output_sizes = {1, 3},
                .evaluate =
                    [](const Blocks& x, const Json&) {
                      return Blocks{{x[0][0]}, {x[0][1], x[1][0], 7}};
                    },
                .gradient = {},
                .apply_jacobian = {}};
  m.gradient = [](const Blocks& x, std::size_t, std::size_t in, const std::vector<double>& w, const Json&) {
    return in == 0 ? std::vector<double>{w[0], w[0]} : std::vector<double>{w[0] / x[1][0]};
  };
  m.apply_jacobian = [](const Blocks& x, std::size_t out, std::size_t, const std::vector<double>& v, const Json&) {
    return out == 0 ? std::vector<double>{v[0] / x[1][0]} : std::vector<double>{v[0], v[0], v[0]};
  };
  return m;
}

void expect_refused(const Served& served, const std::string& path, const std::string& body, int status, const std::string& type) {
  const auto a = post(served, path, body);
  EXPECT_EQ(a.status, status) << path << ' ' << body;
  ASSERT_TRUE(a.body.contains("error")) << a.body;
  EXPECT_EQ(a.body["error"]["type"], type) << path << ' ' << body;
  EXPECT_GT(a.body["error"]["message"].get<std::string>().size(), 5u);
}

class UmbridgeServerTest : public testing::Test {
 protected:
  Served served{{straight_line(),
                 {.name = "plain",
                  .input_sizes = {1, 1},
                  .output_sizes = {1},
                  .evaluate = [](const Blocks& x, const Json& c) { return Blocks{{x[0][0] / x[1][0] + c.value("add", 0.0)}}; },
                  .gradient = {},
                  .apply_jacobian = {}}},
                {.threads = 2, .largest_body = 4096}};
};

TEST_F(UmbridgeServerTest, InfoAndSizesHaveNoOtherKeys) {
  httplib::Client client("127.0.0.1", served.port());
  const auto info = Json::parse(client.Get("/Info")->body);
  EXPECT_EQ(info.size(), 2u);
  EXPECT_TRUE(info["protocolVersion"].is_number());
  EXPECT_EQ(info["protocolVersion"], 1.0);
  EXPECT_EQ(info["models"], (Json{"line", "plain"}));
  EXPECT_EQ(post(served, "/InputSizes", R"({"name": "plain"})").body, (Json{{"inputSizes", {1, 1}}}));
  EXPECT_EQ(post(served, "/OutputSizes", R"({"name": "line", "config": {}})").body, (Json{{"outputSizes", {4}}}));
  EXPECT_EQ(post(served, "/ModelInfo", R"({"name": "plain"})").body,
            (Json{{"support", {{"Evaluate", true}, {"Gradient", false}, {"ApplyJacobian", false}, {"ApplyHessian", false}}}}));
  EXPECT_EQ(post(served, "/ModelInfo", R"({"name": "line"})").body,
            (Json{{"support", {{"Evaluate", true}, {"Gradient", true}, {"ApplyJacobian", true}, {"ApplyHessian", false}}}}));
}

TEST_F(UmbridgeServerTest, EvaluateIgnoresTheContentType) {
  for (const char* type : {"application/json", "text/plain", "application/x-www-form-urlencoded"}) {
    const auto a = post(served, "/Evaluate", R"({"name": "line", "input": [[1, 0.1]]})", type);
    EXPECT_EQ(a.status, 200) << type;
    EXPECT_EQ(a.body, (Json{{"output", {{1.0, 1.1, 1.2, 1.0 + 0.1 * 3}}}})) << type;
  }
  EXPECT_EQ(post(served, "/Evaluate", R"({"name": "plain", "input": [[1], [2]], "config": {"add": 1}})").body, (Json{{"output", {{1.5}}}}));
  EXPECT_EQ(post(served, "/Gradient", R"({"name": "line", "input": [[0, 0]], "outWrt": 0, "inWrt": 0, "sens": [1, 2, 3, 4]})").body,
            (Json{{"output", {10.0, 20.0}}}));
  EXPECT_EQ(post(served, "/ApplyJacobian", R"({"name": "line", "input": [[0, 0]], "outWrt": 0, "inWrt": 0, "vec": [2, -1]})").body,
            (Json{{"output", {2.0, 1.0, 0.0, -1.0}}}));
}

TEST_F(UmbridgeServerTest, TheModelIsLookedForBeforeTheFeatureAndTheFeatureBeforeTheInput) {
  expect_refused(served, "/Evaluate", R"({"name": "zzz", "input": 5})", 400, "ModelNotFound");
  expect_refused(served, "/Gradient", R"({"name": "zzz"})", 400, "ModelNotFound");
  expect_refused(served, "/Gradient", R"({"name": "plain", "input": 5})", 400, "UnsupportedFeature");
  expect_refused(served, "/ApplyJacobian", R"({"name": "zzz", "input": 5})", 400, "ModelNotFound");
  expect_refused(served, "/ApplyJacobian", R"({"name": "plain", "input": 5})", 400, "UnsupportedFeature");
  expect_refused(served, "/ApplyHessian", R"({"name": "line", "input": 5})", 400, "UnsupportedFeature");
  expect_refused(served, "/ApplyHessian", R"({"name": "zzz"})", 400, "ModelNotFound");
}

TEST_F(UmbridgeServerTest, WrongInputsAreRefused) {
  for (const char* body :
       {R"({"name": "line"})", R"({"name": "line", "input": 5})", R"({"name": "line", "input": [[1]]})", R"({"name": "line", "input": [[1, 2], [3]]})",
        R"({"name": "line", "input": [["a", 2]]})", R"({"name": "line", "input": [[null, 2]]})", R"({"name": "line", "input": [[NaN, 2]]})",
        R"({"name": "line", "input": [[Infinity, 2]]})", R"({"name": "line", "input": [[1e999, 2]]})", R"({"name": "line", "input": [[true, 2]]})", "{", "",
        "[]", R"({"input": [[1, 2]]})", R"({"name": 7, "input": [[1, 2]]})", R"({"name": "line", "input": [[1, 2]], "config": 3})",
        R"({"name": "line", "input": [[-200, 2]]})"})
    expect_refused(served, "/Evaluate", body, 400, "InvalidInput");
  for (const char* body :
       {R"({"name": "line", "input": [[0, 0]], "outWrt": 1, "inWrt": 0, "sens": [1, 2, 3, 4]})",
        R"({"name": "line", "input": [[0, 0]], "outWrt": 0, "inWrt": -1, "sens": [1, 2, 3, 4]})",
        R"({"name": "line", "input": [[0, 0]], "outWrt": 0, "inWrt": 0, "sens": [1]})", R"({"name": "line", "input": [[0, 0]], "outWrt": 0, "inWrt": 0})",
        R"({"name": "line", "input": [[0, 0]], "outWrt": 0, "inWrt": 0, "sens": [1, 2, 3, null]})",
        R"({"name": "line", "input": [[0, 0]], "outWrt": 0, "inWrt": 0, "sens": [1, 2, 3, NaN]})",
        R"({"name": "line", "input": [[0, NaN]], "outWrt": 0, "inWrt": 0, "sens": [1, 2, 3, 4]})"})
    expect_refused(served, "/Gradient", body, 400, "InvalidInput");
  for (const char* body : {R"({"name": "line", "input": [[0, 0]], "outWrt": 0, "inWrt": 0, "vec": [1, Infinity]})",
                           R"({"name": "line", "input": [[0, 0]], "outWrt": 0, "inWrt": 0, "vec": [1, 1e999]})",
                           R"({"name": "line", "input": [[0, 0]], "outWrt": 0, "inWrt": 0, "vec": [1, 2, 3, 4]})",
                           R"({"name": "line", "input": [[0, 0]], "outWrt": 1, "inWrt": 0, "vec": [1, 2]})"})
    expect_refused(served, "/ApplyJacobian", body, 400, "InvalidInput");
}

TEST_F(UmbridgeServerTest, WhatTheModelFailsAtIsItsOwn) {
  expect_refused(served, "/Evaluate", R"({"name": "line", "input": [[200, 2]]})", 500, "InvalidOutput");
  expect_refused(served, "/Evaluate", R"({"name": "plain", "input": [[1], [0]]})", 500, "InvalidOutput");  // infinity is never sent as a number
  EXPECT_EQ(post(served, "/Evaluate", R"({"name": "plain", "input": [[1], [2]]})").status, 200) << "and the server goes on";
}

TEST_F(UmbridgeServerTest, GreatBodiesAndUnknownPathsAreRefused) {
  EXPECT_EQ(post(served, "/Evaluate", std::string(10000, ' ')).status, 413);
  expect_refused(served, "/Nothing", "{}", 404, "NotFound");
  httplib::Client client("127.0.0.1", served.port());
  client.set_keep_alive(true);
  for (int i = 0; i < 2; ++i) {  // on one connection: the body of what is unknown is not taken for the next request
    EXPECT_EQ(client.Post("/Nothing", R"({"name": "line"})", "text/plain")->status, 404);
    EXPECT_EQ(client.Put("/Evaluate", R"({"name": "line"})", "text/plain")->status, 404);
    EXPECT_EQ(client.Get("/Evaluate")->status, 404);
    EXPECT_EQ(client.Post("/OutputSizes", R"({"name": "line"})", "text/plain")->status, 200);
  }
}

/// Of the block that is requested, not of all: /Gradient answers in the size of the input block, /ApplyJacobian in that of the output block.
TEST(UmbridgeServer, DerivativesHaveTheSizeOfTheirBlock) {
  const Served served({blocks()});
  EXPECT_EQ(post(served, "/Evaluate", R"({"name": "blocks", "input": [[1, 2], [3]]})").body,
            (Json{{"output", Json::array({Json::array({1.0}), Json::array({2.0, 3.0, 7.0})})}}));
  EXPECT_EQ(post(served, "/Gradient", R"({"name": "blocks", "input": [[1, 2], [3]], "outWrt": 1, "inWrt": 0, "sens": [5, 0, 0]})").body,
            (Json{{"output", Json::array({5.0, 5.0})}}));
  EXPECT_EQ(post(served, "/Gradient", R"({"name": "blocks", "input": [[1, 2], [2]], "outWrt": 0, "inWrt": 1, "sens": [5]})").body,
            (Json{{"output", Json::array({2.5})}}));
  EXPECT_EQ(post(served, "/ApplyJacobian", R"({"name": "blocks", "input": [[1, 2], [2]], "outWrt": 0, "inWrt": 1, "vec": [5]})").body,
            (Json{{"output", Json::array({2.5})}}));
  EXPECT_EQ(post(served, "/ApplyJacobian", R"({"name": "blocks", "input": [[1, 2], [3]], "outWrt": 1, "inWrt": 0, "vec": [5, 0]})").body,
            (Json{{"output", Json::array({5.0, 5.0, 5.0})}}));
  expect_refused(served, "/Gradient", R"({"name": "blocks", "input": [[1, 2], [3]], "outWrt": 1, "inWrt": 0, "sens": [5]})", 400, "InvalidInput");
  expect_refused(served, "/ApplyJacobian", R"({"name": "blocks", "input": [[1, 2], [3]], "outWrt": 1, "inWrt": 1, "vec": [5, 0]})", 400, "InvalidInput");
}

TEST(UmbridgeServer, NoDerivativeIsSentThatIsNotFinite) {
  const Served served({blocks()});
  expect_refused(served, "/Gradient", R"({"name": "blocks", "input": [[1, 2], [0]], "outWrt": 0, "inWrt": 1, "sens": [5]})", 500, "InvalidOutput");
  expect_refused(served, "/ApplyJacobian", R"({"name": "blocks", "input": [[1, 2], [0]], "outWrt": 0, "inWrt": 1, "vec": [5]})", 500, "InvalidOutput");
}

/// A form of a web page, as `curl -d` says of every body, may have 8 KB in the HTTP library: a body is JSON whatever it is called, and as long as it may be.
TEST(UmbridgeServer, ALongBodyIsReadWhateverTheContentType) {
  const Served served({straight_line()});
  const std::string body = R"({"name": "line", "input": [[1, 0.1]])" + std::string(20000, ' ') + "}";
  for (const char* type : {"application/json", "application/x-www-form-urlencoded", "multipart/form-data; boundary=x", "multipart/form-data"})
    EXPECT_EQ(post(served, "/Evaluate", body, type).status, 200) << type;
  const Connection nameless("127.0.0.1", served.port());
  nameless.send("POST /OutputSizes HTTP/1.1\r\nHost: a\r\nContent-Length: 16\r\n\r\n{\"name\": \"line\"}");
  EXPECT_NE(nameless.read(5).find("200 OK"), std::string::npos) << "without any Content-Type";
}

/// In every form: in pieces without a total length, or compressed.
TEST_F(UmbridgeServerTest, GreatBodiesAreRefusedHoweverTheyCome) {
  const Connection pieces("127.0.0.1", served.port());
  pieces.send("POST /Evaluate HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n");
  for (int i = 0; i < 10; ++i) pieces.send("400\r\n" + std::string(1024, ' ') + "\r\n");
  pieces.send("0\r\n\r\n");
  EXPECT_EQ(pieces.read(5).substr(0, 12), "HTTP/1.1 413");

  httplib::Client client("127.0.0.1", served.port());
  client.set_compress(true);
  const auto answer = client.Post("/Evaluate", std::string(100000, ' '), "application/json");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 413);
  const auto small = client.Post("/Evaluate", R"({"name": "line", "input": [[1, 0.1]]})" + std::string(2000, ' '), "application/json");
  ASSERT_TRUE(small);
  EXPECT_EQ(small->status, 200) << "compressed and small enough";
  EXPECT_EQ(post(served, "/OutputSizes", R"({"name": "line"})").status, 200) << "and the server goes on";
}

/// What says beforehand that it is too great is not read at all, and what is nested without end is not followed.
TEST_F(UmbridgeServerTest, WhatIsTooGreatOrTooDeepIsRefusedAtOnce) {
  for (const char* length : {"99999999999", "99999999999999999999999", "-5", "abc"}) {
    const Connection c("127.0.0.1", served.port());
    c.send("POST /Evaluate HTTP/1.1\r\nHost: a\r\nContent-Length: " + std::string(length) + "\r\n\r\n");
    const auto began = std::chrono::steady_clock::now();
    EXPECT_EQ(c.read(5).substr(0, 10), "HTTP/1.1 4") << length;
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(), 1) << length;
  }
  // What follows is not taken for a request: the connection is closed.
  const Connection smuggling("127.0.0.1", served.port());
  smuggling.send("POST /Evaluate HTTP/1.1\r\nHost: a\r\nContent-Length: 99999999999\r\n\r\nGET /Info HTTP/1.1\r\nHost: a\r\n\r\n");
  std::string said;
  for (std::string piece; !(piece = smuggling.read(2)).empty();) said += piece;
  EXPECT_EQ(said.substr(0, 12), "HTTP/1.1 413");
  EXPECT_NE(said.find("InvalidInput"), std::string::npos);
  EXPECT_EQ(said.find("protocolVersion"), std::string::npos) << said;
  const Served roomy({straight_line(), blocks()});
  const std::string deep = std::string(100000, '[') + std::string(100000, ']');
  expect_refused(roomy, "/Evaluate", R"({"name": "line", "input": [[1, 0.1]], "config": {"a": )" + deep + "}}", 400, "InvalidInput");
  expect_refused(roomy, "/Gradient", R"({"name": "line", "input": [[0, 0]], "outWrt": 0, "inWrt": 0, "sens": )" + deep + "}", 400, "InvalidInput");
  EXPECT_EQ(post(roomy, "/OutputSizes", R"({"name": "line"})").status, 200) << "and the server goes on";
}

TEST_F(UmbridgeServerTest, APartOfAnAnswerIsNone) {
  httplib::Client client("127.0.0.1", served.port());
  const auto r = client.Post("/Evaluate", {{"Range", "bytes=0-3"}}, R"({"name": "line", "input": [[1, 0.1]]})", "application/json");
  ASSERT_TRUE(r);
  EXPECT_EQ(r->status, 200);
  EXPECT_TRUE(Json::parse(r->body, nullptr, false).is_object()) << r->body;
}

/// A request that never ends is given up after its time, whether it stands still or drips, and others are answered meanwhile.
TEST(UmbridgeServer, ARequestHasItsTimeToArrive) {
  const Served served({straight_line()}, {.timeout = 1});
  for (const bool drips : {false, true}) {
    const Connection slow("127.0.0.1", served.port());
    slow.send("POST /Evaluate HTTP/1.1\r\nHost: a\r\nContent-Length: 1000\r\n\r\n{");
    EXPECT_EQ(post(served, "/OutputSizes", R"({"name": "line"})").status, 200) << "meanwhile";
    const auto began = std::chrono::steady_clock::now();
    const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(); };
    std::string said;
    while (said.empty() && seconds() < 8) {
      if (drips) slow.send(" ");
      said = slow.read(0.1);
    }
    EXPECT_EQ(said.substr(0, 10), "HTTP/1.1 4") << drips;
    EXPECT_GT(seconds(), 0.7);
    EXPECT_LT(seconds(), 4) << drips;
  }
}

/// 127.0.0.2 is this machine too, but another address: a server that listens to all of them would answer there.
TEST(UmbridgeServer, ListensAtItsHostAlone) {
  const Served usual({straight_line()}), other({straight_line()}, {.host = "127.0.0.2"});
  EXPECT_TRUE(Connection("127.0.0.1", usual.port()).open());
  EXPECT_FALSE(Connection("127.0.0.2", usual.port()).open());
  EXPECT_TRUE(Connection("127.0.0.2", other.port()).open());
  EXPECT_FALSE(Connection("127.0.0.1", other.port()).open());
}

TEST(UmbridgeServer, RefusesWhatCannotWait) {
  std::atomic<bool> go = false;
  std::atomic<int> entered = 0;
  ServedModel slow{.name = "slow", .input_sizes = {1}, .output_sizes = {1}, .evaluate = {}, .gradient = {}, .apply_jacobian = {}};
  slow.evaluate = [&](const Blocks&, const Json&) {
    ++entered;
    while (!go) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return Blocks{{1.0}};
  };
  const Served served({slow}, {.threads = 1, .waiting = 0});
  std::thread first([&] { (void)post(served, "/Evaluate", R"({"name": "slow", "input": [[1]]})"); });
  while (entered == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  expect_refused(served, "/Evaluate", R"({"name": "slow", "input": [[1]]})", 503, "ServerBusy");
  go = true;
  first.join();
}

/// When the server ends, what has begun is made to its end, and what waits is sent away.
TEST(UmbridgeServer, ASlowModelDoesNotKeepAServerThatEnds) {
  std::atomic<int> entered = 0;
  ServedModel slow{.name = "slow", .input_sizes = {1}, .output_sizes = {1}, .evaluate = {}, .gradient = {}, .apply_jacobian = {}};
  slow.evaluate = [&](const Blocks&, const Json&) {
    ++entered;
    std::this_thread::sleep_for(std::chrono::milliseconds(2000));
    return Blocks{{1.0}};
  };
  auto served = std::make_unique<Served>(std::vector{slow}, ServeOptions{.threads = 1, .waiting = 8});
  std::atomic<int> made = 0, refused = 0;
  std::vector<std::jthread> clients;
  for (int i = 0; i < 5; ++i)
    clients.emplace_back([&, port = served->port()] {
      httplib::Client client("127.0.0.1", port);
      client.set_read_timeout(20);
      if (const auto r = client.Post("/Evaluate", R"({"name": "slow", "input": [[1]]})", "application/json")) ++(r->status == 200 ? made : refused);
    });
  while (entered == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  std::this_thread::sleep_for(std::chrono::milliseconds(1000));  // the others wait by now
  served.reset();
  clients.clear();
  EXPECT_EQ(entered, 1);
  EXPECT_EQ(made, 1);
  EXPECT_EQ(refused, 4);
}

TEST(UmbridgeServer, AnOccupiedPortIsReported) {
  const Served served({straight_line()});
  EXPECT_THROW(UmbridgeServer({straight_line()}, {.port = served.port()}), InputError);
}

}  // namespace
}  // namespace calomel
