/// Every trap of the protocol, by raw HTTP.
#include <gtest/gtest.h>

#include "base/json.hpp"
#include "forward/external/umbridge_server.hpp"
#include "tests/unit/external/served.hpp"

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

void expect_refused(const Served& served, const std::string& path, const std::string& body, int status, const std::string& type) {
  const auto a = post(served, path, body);
  EXPECT_EQ(a.status, status) << path << ' ' << body;
  ASSERT_TRUE(a.body.contains("error")) << a.body;
  EXPECT_EQ(a.body["error"]["type"], type) << path << ' ' << body;
  EXPECT_GT(a.body["error"]["message"].get<std::string>().size(), 5u);
}

class UmbridgeServerTest : public testing::Test {
 protected:
  Served served{{straight_line(), {.name = "plain", .input_sizes = {1, 1}, .output_sizes = {1}, .evaluate = [](const Blocks& x, const Json& c) { return Blocks{{x[0][0] / x[1][0] + c.value("add", 0.0)}}; }, .gradient = {}, .apply_jacobian = {}}},
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
  EXPECT_EQ(post(served, "/ModelInfo", R"({"name": "plain"})").body["support"], (Json{{"Evaluate", true}, {"Gradient", false}, {"ApplyJacobian", false}, {"ApplyHessian", false}}));
}

TEST_F(UmbridgeServerTest, EvaluateAnswersWhateverTheContentType) {
  for (const char* type : {"application/json", "text/plain", "application/x-www-form-urlencoded"}) {
    const auto a = post(served, "/Evaluate", R"({"name": "line", "input": [[1, 0.1]]})", type);
    EXPECT_EQ(a.status, 200) << type;
    EXPECT_EQ(a.body, (Json{{"output", {{1.0, 1.1, 1.2, 1.0 + 0.1 * 3}}}})) << type;
  }
  EXPECT_EQ(post(served, "/Evaluate", R"({"name": "plain", "input": [[1], [2]], "config": {"add": 1}})").body, (Json{{"output", {{1.5}}}}));
  EXPECT_EQ(post(served, "/Gradient", R"({"name": "line", "input": [[0, 0]], "outWrt": 0, "inWrt": 0, "sens": [1, 2, 3, 4]})").body, (Json{{"output", {10.0, 20.0}}}));
  EXPECT_EQ(post(served, "/ApplyJacobian", R"({"name": "line", "input": [[0, 0]], "outWrt": 0, "inWrt": 0, "vec": [2, -1]})").body, (Json{{"output", {2.0, 1.0, 0.0, -1.0}}}));
}

TEST_F(UmbridgeServerTest, TheModelIsLookedForBeforeTheFeatureAndTheFeatureBeforeTheInput) {
  expect_refused(served, "/Evaluate", R"({"name": "zzz", "input": 5})", 400, "ModelNotFound");
  expect_refused(served, "/Gradient", R"({"name": "zzz"})", 400, "ModelNotFound");
  expect_refused(served, "/Gradient", R"({"name": "plain", "input": 5})", 400, "UnsupportedFeature");
  expect_refused(served, "/ApplyHessian", R"({"name": "line", "input": 5})", 400, "UnsupportedFeature");
  expect_refused(served, "/ApplyHessian", R"({"name": "zzz"})", 400, "ModelNotFound");
}

TEST_F(UmbridgeServerTest, WrongInputsAreRefused) {
  for (const char* body : {R"({"name": "line"})", R"({"name": "line", "input": 5})", R"({"name": "line", "input": [[1]]})", R"({"name": "line", "input": [[1, 2], [3]]})",
                           R"({"name": "line", "input": [["a", 2]]})", R"({"name": "line", "input": [[null, 2]]})", R"({"name": "line", "input": [[NaN, 2]]})",
                           R"({"name": "line", "input": [[Infinity, 2]]})", R"({"name": "line", "input": [[1e999, 2]]})", R"({"name": "line", "input": [[true, 2]]})", "{", "", "[]",
                           R"({"input": [[1, 2]]})", R"({"name": 7, "input": [[1, 2]]})", R"({"name": "line", "input": [[1, 2]], "config": 3})", R"({"name": "line", "input": [[-200, 2]]})"})
    expect_refused(served, "/Evaluate", body, 400, "InvalidInput");
  for (const char* body : {R"({"name": "line", "input": [[0, 0]], "outWrt": 1, "inWrt": 0, "sens": [1, 2, 3, 4]})", R"({"name": "line", "input": [[0, 0]], "outWrt": 0, "inWrt": -1, "sens": [1, 2, 3, 4]})",
                           R"({"name": "line", "input": [[0, 0]], "outWrt": 0, "inWrt": 0, "sens": [1]})", R"({"name": "line", "input": [[0, 0]], "outWrt": 0, "inWrt": 0})"})
    expect_refused(served, "/Gradient", body, 400, "InvalidInput");
}

TEST_F(UmbridgeServerTest, WhatTheModelFailsAtIsItsOwn) {
  expect_refused(served, "/Evaluate", R"({"name": "line", "input": [[200, 2]]})", 500, "InvalidOutput");
  expect_refused(served, "/Evaluate", R"({"name": "plain", "input": [[1], [0]]})", 500, "InvalidOutput");  // infinity is never sent as a number
  EXPECT_EQ(post(served, "/Evaluate", R"({"name": "plain", "input": [[1], [2]]})").status, 200) << "and the server goes on";
}

TEST_F(UmbridgeServerTest, GreatBodiesAndUnknownPathsAreRefused) {
  EXPECT_EQ(post(served, "/Evaluate", std::string(10000, ' ')).status, 413);
  expect_refused(served, "/Nothing", "{}", 404, "NotFound");
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

TEST(UmbridgeServer, ATakenPortIsSaid) {
  const Served served({straight_line()});
  EXPECT_THROW(UmbridgeServer({straight_line()}, {.port = served.port()}), InputError);
}

}  // namespace
}  // namespace calomel
