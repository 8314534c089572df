#include "uq/sensitivity/sensitivity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

namespace calomel {
namespace {

constexpr double pi = std::numbers::pi;

/// A function of parameters on [low, high] each, with `times` values.
class Function : public ForwardModel {
 public:
  Function(std::size_t parameters, double low, double high, std::size_t times, std::function<std::vector<double>(std::span<const double>)> of)
      : of_(std::move(of)) {
    for (std::size_t k = 0; k < parameters; ++k) {
      Parameter p{.name = "x" + std::to_string(k + 1), .key = "x", .min = low, .max = high};
      p.nominal = 0.5 * (low + high);
      shape_.parameters.push_back(p);
    }
    shape_.conditions = {"default"}, shape_.sensors = {"y"};
    for (std::size_t i = 0; i < times; ++i) shape_.times.push_back(double(i));
  }
  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] Prediction evaluate(std::span<const double> x) const override {
    auto y = of_(x);
    if (y.empty()) return {.ok = false, .message = "no answer"};
    return {.mean = std::move(y)};
  }

 private:
  ModelShape shape_;
  std::function<std::vector<double>(std::span<const double>)> of_;
};

Sensitivity analysed(const Function& f, int samples, std::uint64_t seed = 1) {
  return analyse_sensitivity({.model = f,
                              .options = {.samples = samples, .measure = "uniform", .trajectories = 40},
                              .seed = seed,
                              .threads = 1,
                              .theta =
                                  [&](const Eigen::MatrixXd& u) {
                                    const auto& p = f.shape().parameters[0];
                                    return Eigen::MatrixXd(p.min + (p.max - p.min) * u.array());
                                  },
                              .runs = {},
                              .progress = {},
                              .stop = nullptr});
}

Function ishigami() {
  return {3, -pi, pi, 1,
          [](std::span<const double> x) { return std::vector{std::sin(x[0]) + 7 * std::pow(std::sin(x[1]), 2) + 0.1 * std::pow(x[2], 4) * std::sin(x[0])}; }};
}

void expect_indices(const SobolIndices& s, const std::vector<double>& first, const std::vector<double>& total, double within) {
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_NEAR(s.first_order[k].value, first[k], within) << "first " << k;
    EXPECT_NEAR(s.total_order[k].value, total[k], within) << "total " << k;
    EXPECT_LE(s.first_order[k].low, s.first_order[k].value);
    EXPECT_GE(s.first_order[k].high, s.first_order[k].value);
  }
}

/// Closed forms: V = a^2/8 + b pi^4/5 + b^2 pi^8/18 + 1/2, V1 = (1 + b pi^4/5)^2/2, V2 = a^2/8, V13 = 8 b^2 pi^8/225 (Ishigami and Homma 1990; a = 7, b = 0.1).
TEST(Sensitivity, Ishigami) {
  const auto s = analysed(ishigami(), 4096);
  ASSERT_EQ(s.quantities.size(), 2u);
  expect_indices(s.quantities[0].sobol, {0.3139, 0.4424, 0.0}, {0.5576, 0.4424, 0.2437}, 0.02);
  EXPECT_NEAR(s.quantities[0].sobol.variance, 13.8446, 0.3);
  EXPECT_NEAR(s.quantities[0].mean, 3.5, 0.1);
  EXPECT_EQ(s.quantities.back().sobol.total_order[1].value, s.quantities[0].sobol.total_order[1].value) << "of one value the generalised indices are its own";
  EXPECT_EQ(s.evaluations, 4096u * 5 + 40 * 4);
  EXPECT_NEAR(s.total_order(0, 0), s.quantities[0].sobol.total_order[0].value, 1e-9);
  // The sine needs more than order 8: the polynomial says how far it is to be believed.
  ASSERT_TRUE(s.quantities[0].chaos);
  EXPECT_GT(s.quantities[0].chaos->left_out_r2, 0.95);
  EXPECT_NEAR(indices_of(*s.quantities[0].chaos).first_order[1], 0.4424, 0.03);
}

/// prod (|4 x - 2| + a) / (1 + a) on [0, 1]: V_k = 1 / (3 (1 + a_k)^2), T_k V = V_k prod_{j != k} (1 + V_j).
TEST(Sensitivity, GFunction) {
  const std::vector<double> a{0, 1, 4.5, 9};
  const Function g(4, 0, 1, 1, [&](std::span<const double> x) {
    double y = 1;
    for (std::size_t k = 0; k < 4; ++k) y *= (std::abs(4 * x[k] - 2) + a[k]) / (1 + a[k]);
    return std::vector{y};
  });
  double all = 1;
  for (const double k : a) all *= 1 + 1 / (3 * (1 + k) * (1 + k));
  std::vector<double> first, total;
  for (const double k : a) {
    const double v = 1 / (3 * (1 + k) * (1 + k));
    first.push_back(v / (all - 1)), total.push_back(v * all / (1 + v) / (all - 1));
  }
  expect_indices(analysed(g, 8192).quantities[0].sobol, first, total, 0.02);
}

/// A linear record: shares c_k^2 / sum c^2 at every time and over the record, no interactions, elementary effects without spread.
TEST(Sensitivity, LinearRecord) {
  const Function f(3, -1, 1, 5, [](std::span<const double> x) {
    std::vector<double> y;
    for (int i = 0; i < 5; ++i) y.push_back(10 + x[0] + i * x[1]);
    return y;
  });
  const auto s = analysed(f, 1024);
  for (Eigen::Index i = 0; i < 5; ++i) {
    EXPECT_NEAR(s.first_order(i, 1), double(i * i) / (1 + i * i), 0.02);
    EXPECT_NEAR(s.total_order(i, 2), 0, 1e-12);
  }
  const auto& record = s.quantities.back();
  expect_indices(record.sobol, {5.0 / 35, 30.0 / 35, 0}, {5.0 / 35, 30.0 / 35, 0}, 0.02);
  const auto& rms = s.quantities[2];
  EXPECT_EQ(rms.name, "rms");
  const auto& peak = s.quantities[0];
  ASSERT_EQ(peak.name, "peak");
  // Over the box the peak is at the last or the first time; where x2 > 0 it is 10 + x1 + 4 x2.
  EXPECT_GT(peak.morris[1].mu_star, peak.morris[0].mu_star);
  EXPECT_EQ(peak.morris[2].mu_star, 0);
}

TEST(Chaos, APolynomialIsFoundAndItsIndicesAreExact) {
  // y = 1 + 2 P1(x1) + 3 P1(x1) P1(x2) + P2(x3): variances 4/3, 9/9, 1/5.
  const Eigen::MatrixXd x = 2 * sobol_rows_design(3, 60, 5).leftCols(200).array() - 1;
  Eigen::VectorXd y(200);
  for (Eigen::Index i = 0; i < 200; ++i) y[i] = 1 + 2 * x(0, i) + 3 * x(0, i) * x(1, i) + 0.5 * (3 * x(2, i) * x(2, i) - 1);
  const auto chaos = fit_chaos(x, y);
  EXPECT_NEAR(chaos.left_out_r2, 1, 1e-10);
  const auto indices = indices_of(chaos);
  const double v = 4.0 / 3 + 1 + 0.2;
  EXPECT_NEAR(indices.first_order[0], 4.0 / 3 / v, 1e-8);
  EXPECT_NEAR(indices.first_order[1], 0, 1e-8);
  EXPECT_NEAR(indices.total_order[0], (4.0 / 3 + 1) / v, 1e-8);
  EXPECT_NEAR(indices.total_order[1], 1 / v, 1e-8);
  EXPECT_NEAR(indices.total_order[2], 0.2 / v, 1e-8);
}

TEST(Morris, EffectsOfALinearFunctionAreItsSlopesAndStepsStayInTheCube) {
  const auto design = morris_design(3, 20, 8, 3);
  EXPECT_GE(design.minCoeff(), 0);
  EXPECT_LE(design.maxCoeff(), 1 + 1e-12);
  const Eigen::MatrixXd y = 2 * design.row(0) - 5 * design.row(2);
  const auto e = morris_effects(design, y)[0];
  EXPECT_NEAR(e[0].mu, 2, 1e-12);
  EXPECT_NEAR(e[1].mu_star, 0, 1e-12);
  EXPECT_NEAR(e[2].mu, -5, 1e-12);
  EXPECT_NEAR(e[2].mu_star, 5, 1e-12);
  EXPECT_NEAR(e[2].sigma, 0, 1e-12);
  // A parameter none of whose steps came through is not one without effect.
  Eigen::MatrixXd failed = y;
  for (Eigen::Index i = 0; i + 1 < design.cols(); ++i)
    if (design(0, i) != design(0, i + 1)) failed(0, i) = std::nan("");
  const auto without = morris_effects(design, failed)[0];
  EXPECT_TRUE(std::isnan(without[0].mu_star));
  EXPECT_NEAR(without[2].mu, -5, 1e-12);
}

// Trajectories of one parameter or two have neighbours that differ in one parameter, too; these are no steps.
TEST(Morris, CountsNoStepFromOneTrajectoryToTheNext) {
  for (const std::size_t d : {1, 2}) {
    const auto design = morris_design(d, 50, 8, 3);
    const Eigen::MatrixXd y = (10 * design.row(0).array()).sin().matrix();
    double absolute = 0, count = 0;
    for (Eigen::Index i = 0; i + 1 < design.cols(); ++i)
      if ((i + 1) % Eigen::Index(d + 1) != 0 && design(0, i) != design(0, i + 1)) {
        EXPECT_EQ(std::abs(design(0, i + 1) - design(0, i)) > 0.5, true);
        absolute += std::abs(y(0, i + 1) - y(0, i)) * 7 / 4, ++count;
      }
    EXPECT_EQ(count, 50);
    EXPECT_NEAR(morris_effects(design, y)[0][0].mu_star, absolute / count, 1e-9) << d;
    EXPECT_LT(morris_effects(design, design.row(0))[0][0].sigma, 1e-9) << d;
  }
}

/// The intervals hold the truth about as often as they say: 40 seeds, 5 indices that are not zero.
TEST(Sensitivity, IntervalsCover) {
  const std::vector<double> first{0.3139, 0.4424}, total{0.5576, 0.4424, 0.2437};
  const auto f = ishigami();
  int held = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto s = analysed(f, 256, seed).quantities[0].sobol;
    const auto count = [&](const SensitivityIndex& i, double truth) { held += i.low <= truth && truth <= i.high, ++all; };
    for (std::size_t k = 0; k < first.size(); ++k) count(s.first_order[k], first[k]);
    for (std::size_t k = 0; k < total.size(); ++k) count(s.total_order[k], total[k]);
  }
  EXPECT_GT(held, 0.9 * all) << held << " of " << all;  // Sobol' points are better than random ones: the intervals err on the wide side
}

/// The table to hand in: every line has every column, bounds stand beside the parameter, a gauge's name cannot break a line.
TEST(Sensitivity, CsvHasEveryColumnInEveryLine) {
  const Function f(2, 0, 2, 3, [](std::span<const double> x) { return std::vector{x[0], x[0] + x[1], 2 * x[1]}; });
  Sensitivity s = analysed(f, 64);
  for (auto& q : s.quantities)
    if (!q.sensor.empty()) q.sensor = "left, \"low\"";
  std::istringstream lines(sensitivity_csv(s, f.shape().parameters));
  const auto fields = [](const std::string& line) {
    std::vector<std::string> out{""};
    bool quoted = false;
    for (const char c : line)
      if (c == '"')
        quoted = !quoted;
      else if (c == ',' && !quoted)
        out.emplace_back();
      else
        out.back() += c;
    return out;
  };
  std::string line;
  std::getline(lines, line);
  const auto header = fields(line);
  const auto column = [&](const char* name) { return std::size_t(std::find(header.begin(), header.end(), name) - header.begin()); };
  ASSERT_LT(column("total_order"), header.size());
  std::size_t rows = 0;
  for (; std::getline(lines, line); ++rows) {
    const auto row = fields(line);
    ASSERT_EQ(row.size(), header.size()) << line;
    EXPECT_EQ(row[column("parameter_min")], "0");
    EXPECT_EQ(row[column("parameter_max")], "2");
    EXPECT_EQ(row[column("morris_mu_star")].empty(), row[column("quantity")] == "record") << line;
  }
  EXPECT_EQ(rows, 2 * s.quantities.size());
}

// Failures leave rows out; where they are many the shares, of the part that has answers, are told and not to be trusted.
TEST(Sensitivity, AModelThatMostlyFailsIsToldSo) {
  const auto up_to = [](double share) {
    return Function(2, 0, 1, 1, [share](std::span<const double> x) { return x[0] > share ? std::vector<double>{} : std::vector{x[1]}; });
  };
  const auto never = up_to(-1), half = up_to(0.5), nearly = up_to(0.95), always = up_to(1);
  EXPECT_THROW((void)analysed(never, 64), NumericsError);
  const auto some = analysed(half, 64);
  EXPECT_TRUE(some.many_failed);
  EXPECT_EQ(some.design_rows, 64u);
  EXPECT_LT(some.rows, 20u);  // A, B and the step in x1 all lie in the half: an eighth
  EXPECT_GT(some.rows, 4u);
  EXPECT_NEAR(some.quantities[0].sobol.first_order[1].value, 1, 1e-9);
  const auto few = analysed(nearly, 64);
  EXPECT_FALSE(few.many_failed);
  EXPECT_LT(few.rows, 64u);
  EXPECT_EQ(analysed(always, 64).rows, 64u);
}

// Too few rows for a bootstrap have no interval, rather than one without width.
TEST(Sensitivity, AFewRowsHaveNoInterval) {
  const SobolRows rows{Eigen::VectorXd::LinSpaced(4, 1, 2), Eigen::MatrixXd::Constant(4, 3, 0.5), Eigen::MatrixXd::Constant(4, 3, 0.7)};
  const auto s = sobol_indices(rows, 1);
  EXPECT_NEAR(s.first_order[0].value, 1 - 0.5 / 1.5, 1e-12);
  EXPECT_TRUE(std::isnan(s.first_order[0].low));
}

// A time of the peak that is the same in all runs has no shares; rounding is no variance.
TEST(Sensitivity, WhatDoesNotVaryHasNoPolynomial) {
  const Function f(2, 0, 1, 3, [](std::span<const double> x) { return std::vector{x[0], 5 + x[1], x[0]}; });
  const auto s = analysed(f, 64);
  const auto& time = s.quantities[1];
  ASSERT_EQ(time.name, "time_of_peak");
  EXPECT_FALSE(time.chaos.has_value());
  EXPECT_EQ(time.sd, 0);
  EXPECT_EQ(time.mean, 1);
  EXPECT_EQ(time.finding, ShareFinding::constant);
  EXPECT_TRUE(s.quantities[0].chaos.has_value());
}

TEST(Sensitivity, ManyParametersTakeALatinHypercube) {
  const auto design = sobol_rows_design(25, 16, 1);
  EXPECT_EQ(design.rows(), 25);
  EXPECT_EQ(design.cols(), 16 * 27);
  const Function f(25, 0, 1, 1, [](std::span<const double> x) { return std::vector{3 * x[0] + x[24]}; });
  const auto s = analysed(f, 512).quantities[0].sobol;
  EXPECT_NEAR(s.total_order[0].value, 0.9, 0.05);
  EXPECT_NEAR(s.total_order[24].value, 0.1, 0.05);
  EXPECT_NEAR(s.total_order[12].value, 0, 1e-12);
}

}  // namespace
}  // namespace calomel
