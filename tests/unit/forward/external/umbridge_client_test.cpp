#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "forward/external/umbridge_client.hpp"
#include "tests/unit/forward/external/served.hpp"

namespace calomel {
namespace {

const std::vector<std::size_t> two{2};

/// Answers with what it is given, then with what it repeats, every tenth of a second.
class DrippingServer {
 public:
  DrippingServer(std::string first, std::string again) : first_(std::move(first)), again_(std::move(again)), socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    (void)::bind(socket_, reinterpret_cast<const sockaddr*>(&at), size);
    (void)::listen(socket_, 4);
    (void)::getsockname(socket_, reinterpret_cast<sockaddr*>(&at), &size);
    port_ = ntohs(at.sin_port);
    thread_ = std::jthread([this](const std::stop_token& over) {
      while (!over.stop_requested()) {
        pollfd waiting{socket_, POLLIN, 0};
        if (::poll(&waiting, 1, 50) <= 0) continue;
        const int taken = ::accept(socket_, nullptr, nullptr);
        const auto send = [&](std::string_view bytes) { return ::send(taken, bytes.data(), bytes.size(), MSG_NOSIGNAL) > 0; };
        for (bool open = send(first_); open && !over.stop_requested(); open = send(again_)) std::this_thread::sleep_for(std::chrono::milliseconds(100));
        ::close(taken);
      }
    });
  }
  ~DrippingServer() {
    thread_.request_stop();
    thread_.join();
    ::close(socket_);
  }
  DrippingServer(const DrippingServer&) = delete;
  DrippingServer& operator=(const DrippingServer&) = delete;
  [[nodiscard]] std::string url() const { return "http://127.0.0.1:" + std::to_string(port_); }

 private:
  std::string first_, again_;
  int socket_, port_ = 0;
  std::jthread thread_;
};

Answered<Blocks> answer_to(const std::string& body, int status = 200) {
  const Faulty faulty([&](const httplib::Request&, httplib::Response& r) {
    r.status = status;
    r.set_content(body, "text/html");
  });
  const UmbridgeClient client({.url = faulty.url(), .name = "m", .retries = 1, .pause = 0.001});
  return client.evaluate({{1.0}}, two);
}

TEST(UmbridgeClient, SendsRequestsAndReadsResponses) {
  const Served served({straight_line()});
  const UmbridgeClient client({.url = served.url() + "/", .name = "line"});
  EXPECT_EQ(client.models(), std::vector<std::string>{"line"});
  EXPECT_TRUE(client.support().gradient);
  EXPECT_FALSE(client.support().apply_hessian);
  EXPECT_EQ(client.input_sizes(), std::vector<std::size_t>{2});
  EXPECT_EQ(client.output_sizes(), std::vector<std::size_t>{4});
  const std::vector<std::size_t> four{4};
  const auto y = client.evaluate({{1.0, 0.1}}, four);
  ASSERT_TRUE(y.value) << y.message;
  EXPECT_EQ((*y.value)[0][3], 1.0 + 0.1 * 3);  // every bit comes through
  const std::vector<double> w{1, 2, 3, 4}, v{2, -1};
  EXPECT_EQ(*client.gradient({{0, 0}}, 0, 0, w).value, (std::vector<double>{10, 20}));
  EXPECT_EQ(*client.apply_jacobian({{0, 0}}, 0, 0, v, 4).value, (std::vector<double>{2, 1, 0, -1}));
}

TEST(UmbridgeClient, ReportsRefusalsAndFailuresOfAModel) {
  const Served served({straight_line()});
  const UmbridgeClient client({.url = served.url(), .name = "line"});
  const std::vector<std::size_t> four{4};
  EXPECT_NE(client.evaluate({{-200, 0}}, four).message.find("InvalidInput"), std::string::npos);
  const auto failed = client.evaluate({{200, 0}}, four);
  EXPECT_NE(failed.message.find("status 500"), std::string::npos) << failed.message;
  EXPECT_NE(failed.message.find("the solver stopped"), std::string::npos) << failed.message;
}

TEST(UmbridgeClient, WrongResponsesAreReported) {
  EXPECT_TRUE(answer_to(R"({"output": [[1.0, 2.0]]})").value) << "and whatever the Content-Type says";
  EXPECT_NE(answer_to(R"({"output": [[1.0]]})").message.find("returned 1 numbers, and 2 were announced"), std::string::npos);
  EXPECT_NE(answer_to(R"({"output": [[1.0, 2.0], [3.0]]})").message.find("returned 2 output blocks, and 1 were announced"), std::string::npos);
  EXPECT_NE(answer_to(R"({"output": [[NaN, 2.0]]})").message.find("NaN"), std::string::npos);
  EXPECT_NE(answer_to(R"({"output": [[1e999, 2.0]]})").message.find("invalid JSON"), std::string::npos);
  EXPECT_NE(answer_to(R"({"output": [["a", 2.0]]})").message.find("\"a\""), std::string::npos);
  EXPECT_NE(answer_to(R"({"output": [[null, 2.0]]})").message.find("null"), std::string::npos);
  EXPECT_NE(answer_to("{}").message.find("returned no output"), std::string::npos);
  EXPECT_NE(answer_to("[1]").message.find("no JSON object"), std::string::npos);
  EXPECT_NE(answer_to(R"({"output": [[1.0, 2)").message.find("invalid JSON"), std::string::npos);
  EXPECT_NE(answer_to("<html>gateway</html>", 500).message.find("status 500"), std::string::npos);
  EXPECT_NE(answer_to(R"({"error": {"type": "InvalidOutput", "message": "overflow"}})").message.find("overflow"), std::string::npos)
      << "an error with status 200";
}

// What a server says is cut between letters and is UTF-8 afterwards, so that it can stand in an artefact; what it nests is not followed.
TEST(UmbridgeClient, StrangeWordsAreMadePlain) {
  std::string long_words;
  for (int i = 0; i < 100; ++i) long_words += "\u00e9";
  for (const std::string& words : {"x" + long_words, "xx" + long_words, std::string("\xff\xfe broken"), std::string("two\nlines")}) {
    const auto said =
        answer_to("{\"error\": {\"type\": \"" + std::string(5000, 'T') + "\", \"message\": \"" + (words == "two\nlines" ? "two\\nlines" : words) + "\"}}", 500)
            .message;
    EXPECT_NO_THROW((void)Json(said).dump()) << said;
    EXPECT_LT(said.size(), 500u);
    EXPECT_EQ(said.find('\n'), std::string::npos);
  }
  const std::string deep = std::string(200000, '[') + std::string(200000, ']');
  EXPECT_NE(answer_to("{\"output\": [[" + deep + ", 2.0]]}").message.find("invalid JSON"), std::string::npos);
  EXPECT_NE(answer_to("{\"output\": [[[[1]], 2.0]]}").message.find("a list"), std::string::npos);
}

TEST(UmbridgeClient, ARequestToABusyServerIsRepeated) {
  std::atomic<int> calls = 0;
  const Faulty faulty([&](const httplib::Request&, httplib::Response& r) {
    r.status = ++calls < 3 ? 503 : 200;
    r.set_content(R"({"output": [[1.0, 2.0]]})", "application/json");
  });
  const UmbridgeClient client({.url = faulty.url(), .name = "m", .retries = 3, .pause = 0.001});
  EXPECT_TRUE(client.evaluate({{1.0}}, two).value);
  EXPECT_EQ(calls, 3);
}

TEST(UmbridgeClient, AHungModelFailsOnceAfterItsTimeout) {
  std::atomic<bool> over = false;
  std::atomic<int> calls = 0;
  const Faulty faulty([&](const httplib::Request&, httplib::Response&) {
    ++calls;
    for (int i = 0; i < 100 && !over; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  });
  const UmbridgeClient client({.url = faulty.url(), .name = "m", .timeout = 0.3, .retries = 5, .pause = 0.001});
  const auto answer = client.evaluate({{1.0}}, two);
  over = true;
  EXPECT_FALSE(answer.value);
  EXPECT_NE(answer.message.find("0.3 s"), std::string::npos) << answer.message;
  EXPECT_TRUE(answer.lost);
  EXPECT_EQ(calls, 1);
  EXPECT_FALSE(answer_to("{}").lost) << "an answer that is wrong is an answer";
}

// A timeout is that of the whole exchange, also if the response arrives slowly: line by line in its head, or in a body of unknown length that ends with the
// connection.
TEST(UmbridgeClient, WhatDripsHasItsTimeToo) {
  for (const auto& [first, again] :
       {std::pair{"HTTP/1.1 200 OK\r\n", "X-Wait: 1\r\n"}, {"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\n\r\n{\"output\": [[0.1, ", " "}}) {
    const DrippingServer dripping(first, again);
    const UmbridgeClient client({.url = dripping.url(), .name = "m", .timeout = 0.5, .retries = 0, .pause = 0.001});
    const auto began = std::chrono::steady_clock::now();
    try {
      const auto answer = client.evaluate({{1.0}}, two);
      EXPECT_FALSE(answer.value);
      EXPECT_TRUE(answer.lost) << answer.message;
    } catch (const Unreachable& e) {
      EXPECT_NE(std::string(e.what()).find("0.5 s"), std::string::npos) << e.what();
    }
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(), 4);
  }
}

TEST(UmbridgeClient, AStopEndsThePausesBetweenTries) {
  std::string url;
  { url = Served({straight_line()}).url(); }
  const std::atomic<bool> stop = true;
  const UmbridgeClient client({.url = url, .name = "line", .retries = 20, .pause = 60, .stop = &stop});
  EXPECT_THROW((void)client.models(), Interrupted);
}

TEST(UmbridgeClient, ADeadServerIsUnreachable) {
  std::string url;
  { url = Served({straight_line()}).url(); }
  const UmbridgeClient client({.url = url, .name = "line", .retries = 1, .pause = 0.001});
  try {
    (void)client.models();
    FAIL() << "nobody is there";
  } catch (const Unreachable& e) {
    EXPECT_NE(std::string(e.what()).find(url), std::string::npos) << e.what();
  }
}

TEST(UmbridgeClient, AUrlThatNamesNoServerIsRefused) {
  for (const char* url : {"localhost:4242", "https://localhost", "http://", "http://host/path"})
    EXPECT_THROW(UmbridgeClient({.url = url, .name = "m"}), InputError) << url;
}

}  // namespace
}  // namespace calomel
