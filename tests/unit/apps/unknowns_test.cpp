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
/// The step hangs on the modulus too; small ones keep that out of the differences.
const std::string small_steps = steel + "[solver]\ntime_step_safety = 0.1\n";
const std::string loud = "peak_pressure = 25e6", quiet = "peak_pressure = 1e4";  ///< the second far below the cutoff: no roughness, so that secants of any width agree
const EnsembleOptions one_pulse{.pulses = 1};

/// The mean of the small case with one text replaced by another, at its own numbers.
Eigen::VectorXd mean_with(const std::string& old_text, const std::string& new_text, const std::string& more = steel, const std::string& load = loud) {
  std::string text = small_case_text(more, load);
  const auto at = text.find(old_text);
  EXPECT_NE(at, std::string::npos) << old_text;
  CaseFile file = CaseFile::from_text(text.replace(at, old_text.size(), new_text));
  const auto p = BuiltInModel(ForwardCase::read(file), one_pulse).evaluate({});
  EXPECT_TRUE(p.ok) << p.message;
  return Eigen::Map<const Eigen::VectorXd>(p.mean.data(), Eigen::Index(p.mean.size()));
}

Eigen::MatrixXd directions(const UnknownOptions& options, const std::string& more = steel, std::vector<double> theta = {}, const std::string& load = loud) {
  CaseFile file = CaseFile::from_text(small_case_text(more, load));
  return unknown_directions(BuiltInModel(ForwardCase::read(file), one_pulse), theta, options, 2);
}

double off(const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return (a - b).norm() / b.norm(); }

constexpr Eigen::Index times = 41;

TEST(Unknowns, TheModulusColumnIsTheDerivativeTimesItsDeviation) {
  const auto d = directions({.young_sd = 0.015, .gauge_place_sd = 0.0004}, small_steps, {}, quiet);
  ASSERT_EQ(d.rows(), 2 * times);
  ASSERT_EQ(d.cols(), 3);
  // Narrower secants, by cases that say another modulus. Waves that arrive earlier make each miss the derivative by the square of its width, s(h) = s(0) + a h^2:
  // those of 1 and 0.5 % foretell that of 2 %.
  const auto secant = [](const std::string& more, const std::string& less, double width) {
    return Eigen::VectorXd((mean_with("young = 193e9", "young = " + more, small_steps, quiet) - mean_with("young = 193e9", "young = " + less, small_steps, quiet)) / (2 * width));
  };
  const Eigen::VectorXd one = secant("194.93e9", "191.07e9", 0.01), half = secant("193.965e9", "192.035e9", 0.005);
  ASSERT_GT(one.norm(), 0);
  const Eigen::VectorXd slope = one + 4 * (one - half);
  EXPECT_LT(off(d.col(0), 0.015 * slope), 0.02);
  // It grows with the deviation, and a wrong sign or a forgotten factor would be seen.
  EXPECT_LT(off(directions({.young_sd = 0.03}, small_steps, {}, quiet).col(0), 0.03 * slope), 0.02);
  EXPECT_GT(off(d.col(0), 0.03 * slope), 0.4);
  EXPECT_GT(off(d.col(0), -0.015 * slope), 1.9);
}

TEST(Unknowns, InACavitatingLiquidItIsTheSecantOfTwoPercent) {
  const Eigen::VectorXd slope = (mean_with("young = 193e9", "young = 196.86e9") - mean_with("young = 193e9", "young = 189.14e9")) / 0.04;
  EXPECT_LT(off(directions({.young_sd = 0.015}).col(0), 0.015 * slope), 1e-6);
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
