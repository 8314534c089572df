#include "forward/external/external_model.hpp"

#include "forward/external/external_simulator.hpp"
#include "forward/simulation/runs.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "base/provenance.hpp"
#include "tests/scratch.hpp"
#include "tests/unit/forward/external/served.hpp"

namespace calomel {
namespace {

ExternalCase line_case(const std::string& url, const std::string& more = "", const std::string& count = "4") {
  auto file = CaseFile::from_text("[case]\nname = \"x\"\n[model]\nkind = \"umbridge\"\nurl = \"" + url +
                                  "\"\nname = \"line\"\nretries = 0\n[output]\nsensors = [\"y\"]\ntime = { step = 1.0, count = " + count +
                                  " }\n[parameter.a]\nmin = -1000.0\nmax = 1000.0\nnominal = 0.0\n" + more);
  return ExternalCase::read(file);
}

const std::string slope = "[mechanism.slope.parameter.b]\noff = 0.5\nmin = 0.0\nmax = 2.0\n";

TEST(ExternalModel, AMechanismIsAtItsOffValueUntilItIsSet) {
  const Served served({straight_line()});
  const ExternalModel model(line_case(served.url(), slope));
  const std::vector<double> a{1.0};
  EXPECT_EQ(model.evaluate(a).mean, (std::vector<double>{1.0, 1.5, 2.0, 2.5}));
  EXPECT_EQ(model.evaluate(a, {{"mechanism.slope.parameter.b", 2.0}}).mean, (std::vector<double>{1.0, 3.0, 5.0, 7.0}));
  EXPECT_THROW((void)model.evaluate(a, {{"mechanism.slope.parameter.c", 2.0}}), InputError);
  const std::vector<double> w{1, 1, 1, 1};
  EXPECT_EQ(model.vector_jacobian_product(a, w)[0], 4.0);
}

// What a gauge makes of the model's answer: no input of the model.
TEST(ExternalModel, AGaugeMayNotReadTrue) {
  const Served served({straight_line()});
  const ExternalModel model(line_case(served.url(), slope));
  const std::vector<double> a{1.0};
  EXPECT_EQ(model.evaluate(a, {{"sensor_response.gain.y", 2.0}}).mean, (std::vector<double>{2.0, 3.0, 4.0, 5.0}));
  EXPECT_EQ(model.evaluate(a, {{"sensor_response.drift.y", 3.0}}).mean, (std::vector<double>{1.0, 3.0, 6.0, 10.0}));
  EXPECT_EQ(model.evaluate(a, {{"sensor_response.gain.other", 2.0}}).mean, (std::vector<double>{1.0, 1.5, 2.0, 2.5}));
}

TEST(ExternalModel, AFailureIsAPredictionWithItsReasonAndPlace) {
  const Served served({straight_line()});
  const ExternalModel model(line_case(served.url(), slope));
  const std::vector<double> a{200.0};
  const auto p = model.evaluate(a);
  EXPECT_FALSE(p.ok);
  EXPECT_NE(p.message.find("the solver stopped"), std::string::npos) << p.message;
  EXPECT_NE(p.message.find("a = 200"), std::string::npos) << p.message;
}

TEST(ExternalModel, WhatDoesNotFitTheServerIsRefused) {
  const Served served({straight_line()});
  EXPECT_THROW(ExternalModel(line_case(served.url())), InputError) << "one parameter, two inputs";
  EXPECT_THROW(ExternalModel(line_case(served.url(), slope, "5")), InputError) << "five times, four outputs";
  auto other = line_case(served.url(), slope);
  other.server.name = "lime";
  try {
    ExternalModel{other};
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("did you mean \"line\""), std::string::npos) << e.what();
  }
}

// A run to which no answer came in time says nothing of its point: it counts as failed here, and the next call asks again.
const ThreadExecutor one(1), two(2);

std::vector<RunRequest> at(const Simulator& simulator, const Eigen::MatrixXd& thetas) {
  std::vector<RunRequest> requests;
  for (Eigen::Index i = 0; i < thetas.cols(); ++i)
    requests.push_back(request_at(simulator.shape().parameters, {thetas.col(i).data(), std::size_t(thetas.rows())}));
  return requests;
}

TEST(ExternalModel, ARunWithoutAnAnswerIsNotKept) {
  const ScratchFolder scratch;
  const Provenance provenance{.stage = "runs"};
  std::atomic<bool> slow = true;
  ServedModel line = straight_line();
  line.evaluate = [inner = line.evaluate, &slow](const Blocks& x, const Json& c) {
    for (int i = 0; i < 400 && slow; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return inner(x, c);
  };
  const Served served({line});
  auto hurried = line_case(served.url(), slope);
  hurried.server.timeout = 1;
  Eigen::MatrixXd theta(1, 1);
  theta << 3;
  {
    const ExternalSimulator model(hurried);
    RunStore store(provenance, scratch.path() / "runs.journal");
    Runs runs(model, store, one);
    EXPECT_FALSE(runs.get(at(model, theta))[0].done);
    EXPECT_FALSE(runs.get(at(model, theta))[0].done) << "nor is it requested twice by one call";
    EXPECT_EQ(runs.made(), 1u);
    EXPECT_EQ(store.lost(), 1u);
  }
  slow = false;
  const ExternalSimulator model(hurried);
  RunStore store(provenance, scratch.path() / "runs.journal");
  Runs runs(model, store, one);
  EXPECT_TRUE(runs.get(at(model, theta))[0].done);
  EXPECT_EQ(store.lost(), 0u);
}

TEST(ExternalModel, AServerThatGoesAwayLosesNoRun) {
  const ScratchFolder scratch;
  const Provenance provenance{.stage = "runs"};
  Eigen::MatrixXd thetas(1, 3);
  thetas << 1, 2, 3;
  auto served = std::make_unique<Served>(std::vector{straight_line()});
  const ExternalSimulator model(line_case(served->url(), slope));
  {
    RunStore store(provenance, scratch.path() / "runs.journal");
    Runs runs(model, store, two);
    EXPECT_TRUE(runs.get(at(model, thetas))[2].done);
    served.reset();
    Eigen::MatrixXd more(1, 1);
    more << 4;
    EXPECT_THROW((void)runs.get(at(model, more)), Unreachable) << "no run is reported as failed";
  }
  RunStore store(provenance, scratch.path() / "runs.journal");
  Runs runs(model, store, one);
  EXPECT_EQ(runs.get(at(model, thetas))[1].mean[0], 2.0f) << "what was finished is there, without a server";
  EXPECT_EQ(runs.reused(), 3u);
}

}  // namespace
}  // namespace calomel
