#include <gtest/gtest.h>

#include <chrono>

#include "forward/external/umbridge_client.hpp"
#include "tests/unit/external/served.hpp"

namespace calomel {
namespace {

const std::vector<std::size_t> two{2};

Answered<Blocks> answer_to(const std::string& body, int status = 200) {
  const Faulty faulty([&](const httplib::Request&, httplib::Response& r) {
    r.status = status;
    r.set_content(body, "text/html");
  });
  const UmbridgeClient client({.url = faulty.url(), .name = "m", .retries = 1, .pause = 0.001});
  return client.evaluate({{1.0}}, two);
}

TEST(UmbridgeClient, AsksAndIsAnswered) {
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

TEST(UmbridgeClient, SaysWhatAModelRefusesAndFailsAt) {
  const Served served({straight_line()});
  const UmbridgeClient client({.url = served.url(), .name = "line"});
  const std::vector<std::size_t> four{4};
  EXPECT_NE(client.evaluate({{-200, 0}}, four).message.find("InvalidInput"), std::string::npos);
  const auto failed = client.evaluate({{200, 0}}, four);
  EXPECT_NE(failed.message.find("status 500"), std::string::npos) << failed.message;
  EXPECT_NE(failed.message.find("the solver stopped"), std::string::npos) << failed.message;
}

TEST(UmbridgeClient, LiesAreToldAsWhatTheyAre) {
  EXPECT_TRUE(answer_to(R"({"output": [[1.0, 2.0]]})").value) << "and whatever the Content-Type says";
  EXPECT_NE(answer_to(R"({"output": [[1.0]]})").message.find("1 numbers where 2"), std::string::npos);
  EXPECT_NE(answer_to(R"({"output": [[1.0, 2.0], [3.0]]})").message.find("2 output blocks where 1"), std::string::npos);
  EXPECT_NE(answer_to(R"({"output": [[NaN, 2.0]]})").message.find("NaN"), std::string::npos);
  EXPECT_NE(answer_to(R"({"output": [[1e999, 2.0]]})").message.find("no JSON"), std::string::npos);
  EXPECT_NE(answer_to(R"({"output": [["a", 2.0]]})").message.find("\"a\""), std::string::npos);
  EXPECT_NE(answer_to(R"({"output": [[null, 2.0]]})").message.find("null"), std::string::npos);
  EXPECT_NE(answer_to("{}").message.find("without output"), std::string::npos);
  EXPECT_NE(answer_to("[1]").message.find("no JSON object"), std::string::npos);
  EXPECT_NE(answer_to(R"({"output": [[1.0, 2)").message.find("no JSON"), std::string::npos);
  EXPECT_NE(answer_to("<html>gateway</html>", 500).message.find("status 500"), std::string::npos);
  EXPECT_NE(answer_to(R"({"error": {"type": "InvalidOutput", "message": "overflow"}})").message.find("overflow"), std::string::npos) << "an error with status 200";
}

TEST(UmbridgeClient, ABusyServerIsAskedAgain) {
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
  EXPECT_EQ(calls, 1);
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
  for (const char* url : {"localhost:4242", "https://localhost", "http://", "http://host/path"}) EXPECT_THROW(UmbridgeClient({.url = url, .name = "m"}), InputError) << url;
}

}  // namespace
}  // namespace calomel
