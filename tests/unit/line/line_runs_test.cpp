// What a diagnosis asks of a line: groups of numbers, and runs with them.
#include "forward/line/line_runs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>

#include "base/provenance.hpp"
#include "tests/unit/line/line_cases.hpp"

namespace calomel {
namespace {

using namespace testing;
using ::testing::ElementsAre;

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
  EXPECT_THAT(names_of(offered_groups(LineModel(line_case(bar_text())))), ElementsAre("lateral_inertia", "viscous_attenuation", "sensor_response"));
  const std::string enabled = "[mechanism.lateral_inertia]\nenabled = true\npoisson = 0.3\n";
  EXPECT_THAT(names_of(offered_groups(LineModel(line_case(bar_text(enabled))))), ElementsAre("viscous_attenuation", "sensor_response"));
  EXPECT_THAT(names_of(offered_groups(LineModel(line_case(bar_text(enabled + "[mechanism.viscous_attenuation]\n"))))), ElementsAre("viscous_attenuation"));
  EXPECT_EQ(names_of(offered_groups(LineModel(line_case(bar_text("", ""))))).front(), "viscous_attenuation");  // without a radius
}

TEST(LineGroups, HaveThePriorsOfTheRegistryAndTheirOffValues) {
  const auto bar = offered_groups(LineModel(line_case(bar_text())));
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
  const auto pipe = offered_groups(LineModel(line_case(pipe_text())));
  const AddedParameter& cutoff = number_of(pipe, "vapour_cutoff.pressure");  // off at minus infinity: counted by its inverse
  EXPECT_TRUE(cutoff.inverse);
  EXPECT_EQ(*cutoff.parameter.nominal, 0);
  EXPECT_DOUBLE_EQ(cutoff.parameter.min, -1 / 80e3);
  ASSERT_EQ(cutoff.strengths.size(), 1u);
  EXPECT_NEAR(1 / cutoff.strengths[0], -90.5e3, 1);
}

TEST(LineGroups, HavePlainNamesAndSomethingToCheck) {
  for (const auto& text : {bar_text(), pipe_text()})
    for (const auto& g : offered_groups(LineModel(line_case(text))))
      for (const std::string& words : {g.plain, g.check}) {
        ASSERT_FALSE(words.empty()) << g.name;
        EXPECT_TRUE(std::islower(static_cast<unsigned char>(words.front()))) << words;
        EXPECT_NE(words.back(), '.') << words;
        EXPECT_EQ(words.find_first_of("_=*"), std::string::npos) << words;
      }
}

TEST(LineGroups, ActOnEachStationWhereThereAreSeveral) {
  for (const auto& g : offered_groups(LineModel(line_case(bar_text())))) EXPECT_EQ(g.by_sensor, g.name == "sensor_response");
  std::string one = bar_text();
  one.erase(one.find("[[station]]\nname = \"far\""));
  for (const auto& g : offered_groups(LineModel(line_case(one)))) EXPECT_FALSE(g.by_sensor);
}

TEST(NumberedRuns, AreTheModelWithWhatIsAddedAndAreMadeOnce) {
  const LineModel model(line_case(pipe_text("[parameter.wave_speed]\nmin = 1000\nmax = 1500\n")));
  const auto groups = offered_groups(model);
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
  std::vector<RunRecord> first;
  {
    RunStore store(of_test, path);
    first = NumberedRuns(model, store).run(thetas, added, 2);
    EXPECT_EQ(store.made(), 3u);
  }
  ASSERT_TRUE(first[0].done && first[1].done && first[2].done);
  const std::vector<double> theta{1250};
  const auto plain = model.evaluate(theta), cut = model.evaluate(theta, {{"mechanism.vapour_cutoff.pressure", 1 / -1e-5}});
  EXPECT_EQ(first[0].mean, std::vector<float>(plain.mean.begin(), plain.mean.end()));
  EXPECT_EQ(first[1].mean, std::vector<float>(cut.mean.begin(), cut.mean.end()));
  EXPECT_NE(first[0].mean, first[1].mean);
  RunStore again(of_test, path);
  EXPECT_EQ(NumberedRuns(model, again).run(thetas, added, 1), first);
  EXPECT_EQ(again.made(), 0u);
}

TEST(NumberedRuns, TellWhyOneFailed) {
  const LineModel model(line_case(pipe_text("[parameter.velocity]\nmin = 0\nmax = 100\n", "viscosity = 0\nfriction_factor = 0.9")));
  RunStore store({.stage = "runs", .seed = 3}, scratch("line_runs_failed") / "runs.journal");
  Eigen::MatrixXd theta(1, 1);
  theta << 50;
  const auto r = NumberedRuns(model, store).run(theta, {}, 1);
  EXPECT_FALSE(r[0].done);
  EXPECT_FALSE(r[0].message.empty());
}

}  // namespace
}  // namespace calomel
