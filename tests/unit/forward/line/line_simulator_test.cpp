// The line as a simulator: the mechanisms that it offers, and runs with them.
#include "forward/line/line_simulator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>

#include "base/provenance.hpp"
#include "forward/simulation/meshed_runs.hpp"
#include "tests/unit/forward/line/line_cases.hpp"

namespace calomel {
namespace {

using namespace testing;
using ::testing::ElementsAre;

std::vector<ParameterGroup> offered(const LineSimulator& simulator) { return simulator.offered(); }

std::vector<std::string> names_of(const std::vector<ParameterGroup>& groups) {
  std::vector<std::string> names;
  for (const auto& g : groups) names.push_back(g.name);
  return names;
}

const AddedParameter& number_of(const std::vector<ParameterGroup>& groups, const std::string& name) {
  for (const auto& g : groups)
    for (const auto& a : g.added)
      if (a.parameter.name == name) return a;
  throw std::out_of_range(name);
}

constexpr const char* with_speed = "[parameter.wave_speed]\nmin = 1000\nmax = 1500\n";

TEST(LineGroups, AreTheMechanismsThatTheCaseLeavesOut) {
  EXPECT_THAT(names_of(offered(LineSimulator(line_case(bar_text())))), ElementsAre("lateral_inertia", "viscous_attenuation", "sensor_response"));
  const std::string enabled = "[mechanism.lateral_inertia]\nenabled = true\npoisson = 0.3\n";
  EXPECT_THAT(names_of(offered(LineSimulator(line_case(bar_text(enabled))))), ElementsAre("viscous_attenuation", "sensor_response"));
  EXPECT_THAT(names_of(offered(LineSimulator(line_case(bar_text(enabled + "[mechanism.viscous_attenuation]\n"))))), ElementsAre("viscous_attenuation"));
  EXPECT_EQ(names_of(offered(LineSimulator(line_case(bar_text("", ""))))).front(), "viscous_attenuation");  // without a radius
}

TEST(LineGroups, HaveThePriorsOfTheRegistryAndTheirOffValues) {
  const auto bar = offered(LineSimulator(line_case(bar_text())));
  const Parameter& poisson = number_of(bar, "lateral_inertia.poisson").parameter;
  EXPECT_EQ(poisson.key, "mechanism.lateral_inertia.poisson");
  EXPECT_EQ(poisson.min, 0);
  EXPECT_EQ(*poisson.nominal, 0);
  EXPECT_EQ(poisson.max, 0.49);  // where the law ends: below twice the range of the registry, 0.4
  EXPECT_EQ(poisson.prior, "truncated_normal");
  EXPECT_EQ(*poisson.mean, 0);
  EXPECT_EQ(*poisson.sd, 0.2);
  const Parameter& time = number_of(bar, "viscous_attenuation.time").parameter;
  EXPECT_EQ(time.prior, "half_cauchy");
  EXPECT_DOUBLE_EQ(*time.scale, std::sqrt(1e-9 * 1e-6));
  const auto pipe = offered(LineSimulator(line_case(pipe_text())));
  const AddedParameter& cutoff = number_of(pipe, "vapour_cutoff.pressure");  // off at minus infinity: counted by its inverse
  EXPECT_TRUE(cutoff.inverse);
  EXPECT_EQ(*cutoff.parameter.nominal, 0);
  EXPECT_DOUBLE_EQ(cutoff.parameter.min, -1 / 80e3);
  ASSERT_EQ(cutoff.strengths.size(), 1u);
  EXPECT_NEAR(1 / cutoff.strengths[0], -90.5e3, 1);
}

TEST(LineGroups, HavePlainNamesAndSomethingToCheck) {
  for (const auto& text : {bar_text(), pipe_text()})
    for (const auto& g : offered(LineSimulator(line_case(text))))
      for (const std::string& words : {g.plain, g.check}) {
        ASSERT_FALSE(words.empty()) << g.name;
        EXPECT_TRUE(std::islower(static_cast<unsigned char>(words.front()))) << words;
        EXPECT_NE(words.back(), '.') << words;
        EXPECT_EQ(words.find_first_of("_=*"), std::string::npos) << words;
      }
}

TEST(LineGroups, ActOnEachStationWhereThereAreSeveral) {
  for (const auto& g : offered(LineSimulator(line_case(bar_text())))) EXPECT_EQ(g.by_sensor, g.name == "sensor_response");
  std::string one = bar_text();
  one.erase(one.find("[[station]]\nname = \"far\""));
  for (const auto& g : offered(LineSimulator(line_case(one)))) EXPECT_FALSE(g.by_sensor);
}

TEST(LineSimulator, RunsTheModelWithFurtherNumbersAndEachOnce) {
  const LineSimulator simulator(line_case(pipe_text("[parameter.wave_speed]\nmin = 1000\nmax = 1500\n")));
  const auto groups = simulator.offered();
  std::vector<AddedParameter> added;
  for (const auto& g : groups) added.insert(added.end(), g.added.begin(), g.added.end());
  const auto path = scratch("line_runs") / "runs.journal";
  const Provenance of_test{.stage = "runs", .seed = 3};
  Eigen::MatrixXd thetas(Eigen::Index(1 + added.size()), 3);
  for (Eigen::Index i = 0; i < 3; ++i) {
    thetas(0, i) = 1250;
    for (std::size_t k = 0; k < added.size(); ++k) thetas(Eigen::Index(1 + k), i) = *added[k].parameter.nominal;
  }
  for (std::size_t k = 0; k < added.size(); ++k)
    if (added[k].parameter.name == "vapour_cutoff.pressure") thetas(Eigen::Index(1 + k), 1) = thetas(Eigen::Index(1 + k), 2) = -1e-5;
  thetas(0, 2) = 5000;  // out of its bounds, which is the caller's affair
  const ThreadExecutor two(2);
  const std::vector<int> level(3, 0);
  std::vector<RunRecord> first;
  {
    RunStore store(of_test, path);
    Runs runs(simulator, store, two);
    first = MeshedRuns(runs, simulator.shape().parameters, meshes_of({}, {})).get(thetas, level, added);
    EXPECT_EQ(runs.made(), 3u);
  }
  ASSERT_TRUE(first[0].done && first[1].done && first[2].done);
  const std::vector<double> theta{1250};
  const LineModel& model = simulator.model();
  const auto plain = model.evaluate(theta), cut = model.evaluate(theta, {{"mechanism.vapour_cutoff.pressure", 1 / -1e-5}});
  EXPECT_EQ(first[0].mean, std::vector<float>(plain.mean.begin(), plain.mean.end()));
  EXPECT_EQ(first[1].mean, std::vector<float>(cut.mean.begin(), cut.mean.end()));
  EXPECT_NE(first[0].mean, first[1].mean);
  RunStore again(of_test, path);
  Runs runs(simulator, again, two);
  EXPECT_EQ(MeshedRuns(runs, simulator.shape().parameters, meshes_of({}, {})).get(thetas, level, added), first);
  EXPECT_EQ(runs.made(), 0u);
}

TEST(LineSimulator, ReportsWhyARunFailed) {
  const LineSimulator simulator(line_case(pipe_text("[parameter.velocity]\nmin = 0\nmax = 100\n", "viscosity = 0\nfriction_factor = 0.9")));
  const RunRecord r = simulator.run(request_at(simulator.shape().parameters, std::vector{50.0}));
  EXPECT_FALSE(r.done);
  EXPECT_FALSE(r.message.empty());
}

}  // namespace
}  // namespace calomel
