// What the steel's modulus and the gauges' places do to the records, against differences of cases written out with other numbers.
#include "apps/unknowns.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/forward/small_case.hpp"

namespace calomel {
namespace {

using testing::small_case_text;

constexpr double young = 193e9;
const std::string steel = "[material.steel]\nyoung = 193e9\n";
const EnsembleOptions one_pulse{.pulses = 1};

/// The mean of the small case with one text replaced by another, at its own numbers.
Eigen::VectorXd mean_with(const std::string& old_text, const std::string& new_text, const std::string& more = steel) {
  std::string text = small_case_text(more);
  const auto at = text.find(old_text);
  EXPECT_NE(at, std::string::npos) << old_text;
  CaseFile file = CaseFile::from_text(text.replace(at, old_text.size(), new_text));
  const auto p = BuiltInModel(ForwardCase::read(file), one_pulse).evaluate({});
  EXPECT_TRUE(p.ok) << p.message;
  return Eigen::Map<const Eigen::VectorXd>(p.mean.data(), Eigen::Index(p.mean.size()));
}

Eigen::MatrixXd directions(const UnknownOptions& options, const std::string& more = steel, std::vector<double> theta = {}) {
  CaseFile file = CaseFile::from_text(small_case_text(more));
  return unknown_directions(BuiltInModel(ForwardCase::read(file), one_pulse), theta, options, 2);
}

double off(const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return (a - b).norm() / b.norm(); }

constexpr Eigen::Index times = 41;

TEST(Unknowns, TheModulusColumnIsTheDerivativeTimesItsDeviation) {
  const auto d = directions({.young_sd = 0.015, .gauge_place_sd = 0.0004});
  ASSERT_EQ(d.rows(), 2 * times);
  ASSERT_EQ(d.cols(), 3);
  // The same secant by cases that say another modulus, 2 % to either side: a narrower one differs by what fast waves bend within it (7 % for 1 %).
  const Eigen::VectorXd slope = (mean_with("young = 193e9", "young = 196.86e9") - mean_with("young = 193e9", "young = 189.14e9")) / 0.04;
  ASSERT_GT(slope.norm(), 0);
  EXPECT_LT(off(d.col(0), 0.015 * slope), 1e-3);
  // It grows with the deviation, and a wrong sign or a forgotten factor would be seen.
  EXPECT_LT(off(directions({.young_sd = 0.03}).col(0), 0.03 * slope), 1e-3);
  EXPECT_GT(off(d.col(0), 0.03 * slope), 0.4);
  EXPECT_GT(off(d.col(0), -0.015 * slope), 1.9);
}

TEST(Unknowns, APlaceColumnMovesItsOwnGaugeAlongItsDirectionAndNoOther) {
  const double sd = 0.0004;
  const auto d = directions({.young_sd = 0.015, .gauge_place_sd = sd});
  // Gauge by gauge, half an element (1.5 mm) to either side, written into the case.
  const Eigen::VectorXd top = (mean_with("[0.02, 0.0, 0.03]", "[0.0215, 0.0, 0.03]") - mean_with("[0.02, 0.0, 0.03]", "[0.0185, 0.0, 0.03]")) / 0.003;
  const Eigen::VectorXd front = (mean_with("[0.0, 0.0, 0.015]", "[0.0, 0.0, 0.0165]") - mean_with("[0.0, 0.0, 0.015]", "[0.0, 0.0, 0.0135]")) / 0.003;
  ASSERT_GT(top.norm(), 0);
  ASSERT_GT(front.norm(), 0);
  EXPECT_LT(off(d.col(1), sd * top), 1e-6);
  EXPECT_LT(off(d.col(2), sd * front), 1e-6);
  EXPECT_EQ(d.col(1).tail(times).norm(), 0);
  EXPECT_EQ(d.col(2).head(times).norm(), 0);
  EXPECT_GT(d.col(1).head(times).norm(), 0);
  EXPECT_GT(d.col(2).tail(times).norm(), 0);
}

TEST(Unknowns, AModulusThatIsSoughtIsNoUnknown) {
  const std::string sought = steel + "[parameter.stiffness]\nkey = \"material.steel.young\"\nmin = 150e9\nmax = 250e9\n";
  const auto d = directions({.young_sd = 0.015, .gauge_place_sd = 0.0004}, sought, {young});
  EXPECT_EQ(d.col(0).norm(), 0);
  EXPECT_GT(d.col(1).norm(), 0);
  // Another parameter does not take its place.
  const std::string other = steel + "[parameter.tensile_cutoff]\nmin = 0\nmax = 1e6\n";
  EXPECT_GT(directions({.young_sd = 0.015}, other, {1.5e5}).col(0).norm(), 0);
}

TEST(Unknowns, AGaugeThatCannotBeMovedLeavesItsColumnEmpty) {
  // 25 mm past the front edge: off the target, which is no gauge's fault.
  const auto d = directions({.young_sd = 0.015, .gauge_place_sd = 0.025});
  EXPECT_EQ(d.rightCols(2).norm(), 0);
  EXPECT_GT(d.col(0).norm(), 0);
}

}  // namespace
}  // namespace calomel
