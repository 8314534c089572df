// Numbers of a run beside its record: their indices by a polynomial of the runs, and what is said where there are none.
#include <gmock/gmock.h>

#include <cmath>

#include "base/json.hpp"
#include "base/not_finite.hpp"
#include "base/provenance.hpp"
#include "uq/sensitivity/sensitivity.hpp"

namespace calomel {
namespace {

using testing::HasSubstr;

/// Three parameters on [-1, 3]; its one value is their sum.
class Sum : public ForwardModel {
 public:
  Sum() {
    for (int k = 0; k < 3; ++k) shape_.parameters.push_back({.name = "x" + std::to_string(k + 1), .key = "x" + std::to_string(k + 1), .min = -1, .max = 3});
    shape_.conditions = {"default"}, shape_.sensors = {"y"}, shape_.times = {0};
  }
  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] Prediction evaluate(std::span<const double> x) const override { return {.mean = {x[0] + x[1] + x[2]}}; }

 private:
  ModelShape shape_;
};

/// A total of `runs` runs, evenly in the box, as a function of the three parameters on [-1, 1].
TotalsOfRuns total_of(int runs, const std::function<double(double, double, double)>& f) {
  const Eigen::MatrixXd unit = sobol_rows_design(3, std::size_t(runs), 7).leftCols(runs);
  TotalsOfRuns out{.which = {{"dissipated_energy", "", "J"}}, .thetas = -1 + 4 * unit.array(), .values = Eigen::MatrixXd(1, runs)};
  for (Eigen::Index i = 0; i < runs; ++i) out.values(0, i) = f(2 * unit(0, i) - 1, 2 * unit(1, i) - 1, 2 * unit(2, i) - 1);
  return out;
}

struct Analysed {
  Sensitivity all;
  QuantitySensitivity total;
  Json json;
  std::string csv;
};

Analysed analysed(TotalsOfRuns totals, bool by_squares = false) {
  const Sum model;
  const SensitivityInputs in{
      .model = model,
      .options = {.samples = 4096, .measure = by_squares ? "prior" : "uniform", .trajectories = 40, .run_totals = true},
      .theta =
          [&](const Eigen::MatrixXd& u) { return Eigen::MatrixXd(-1 + 4 * (by_squares ? Eigen::ArrayXXd(u.array().square()) : Eigen::ArrayXXd(u.array()))); },
      .totals = std::move(totals)};
  Analysed out{.all = analyse_sensitivity(in), .total = {}, .json = {}, .csv = {}};
  SensitivityWords words{.source = "the model", .doubt = "", .sources = {}, .notes = {}};
  for (const auto& q : out.all.quantities) {
    words.sources.emplace_back(q.polynomial_order ? "a polynomial" : "");
    words.notes.emplace_back(q.finding == ShareFinding::reliable ? "" : "unreliable");
  }
  out.json = sensitivity_json(out.all, in, words, {.stage = "sensitivity"});
  out.csv = sensitivity_csv(out.all, model.shape().parameters);
  for (std::size_t q = 0; q < out.all.quantities.size(); ++q)
    if (out.all.quantities[q].name == "dissipated_energy") out.total = out.all.quantities[q], out.json = out.json["quantities"][q];
  return out;
}

double polynomial(double a, double b, double c) { return 5 + 2 * a + 3 * a * b + 0.5 * (3 * c * c - 1); }

TEST(SensitivityOfTotals, APolynomialHasTheIndicesOfItsCoefficients) {
  auto totals = total_of(200, polynomial);
  totals.values(0, 3) = totals.values(0, 17) = nan;  // runs that failed
  const auto a = analysed(totals);
  const double v = 4.0 / 3 + 1 + 0.2;
  const std::vector<double> first{4.0 / 3 / v, 0, 0.2 / v}, total{(4.0 / 3 + 1) / v, 1 / v, 0.2 / v};
  ASSERT_TRUE(a.total.chaos);
  const auto exact = indices_of(*a.total.chaos);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(exact.first_order[Eigen::Index(k)], first[k], 1e-8);
    EXPECT_NEAR(exact.total_order[Eigen::Index(k)], total[k], 1e-8);
    EXPECT_NEAR(a.total.sobol.first_order[k].value, first[k], 0.02);
    EXPECT_NEAR(a.total.sobol.total_order[k].value, total[k], 0.02);
  }
  EXPECT_NEAR(a.total.mean, 5, 0.02);
  EXPECT_NEAR(a.total.sd, std::sqrt(v), 0.02);
  EXPECT_NEAR(a.total.left_out_r2, 1, 1e-9);
  EXPECT_TRUE(a.total.polynomial_order.has_value());
  EXPECT_EQ(a.total.runs, 198u);
  EXPECT_EQ(a.total.finding, ShareFinding::reliable);
  EXPECT_EQ(a.json["source"], "a polynomial");
  EXPECT_FALSE(a.json.contains("note"));
  EXPECT_EQ(a.all.quantities.back().name, "record") << "all records together stay last";
  EXPECT_GT(a.total.morris[0].mu_star, a.total.morris[2].mu_star);
  EXPECT_THAT(a.csv, HasSubstr("\ndissipated_energy,,,J,"));
}

/// By another measure the shares are others, and the coefficients say nothing of them.
TEST(SensitivityOfTotals, FollowTheMeasure) {
  const auto a = analysed(total_of(100, [](double x, double y, double) { return x + 0.5 * y * y; }), true);
  EXPECT_FALSE(a.total.chaos);
  EXPECT_NEAR(a.total.left_out_r2, 1, 1e-9);
  // x = 2 u^2 - 1: variance 16/45; x^2 / 2 = (4 u^4 - 4 u^2 + 1) / 2: with E u^2k = 1 / (2 k + 1), variance 4 (1/9 - 2/7 + 1/5 - (1/5 - 1/3)^2).
  const double one = 16.0 / 45, other = 4 * (1.0 / 9 - 2.0 / 7 + 1.0 / 5 - std::pow(1.0 / 5 - 1.0 / 3, 2));
  EXPECT_NEAR(a.total.sobol.total_order[0].value, one / (one + other), 0.02);
  EXPECT_NEAR(a.total.sobol.total_order[1].value, other / (one + other), 0.02);
  EXPECT_EQ(a.json["left_out_r2"], a.total.left_out_r2);
}

/// As the time at the cutoff without one: zero in every run. There are no shares, rather than NaN.
TEST(SensitivityOfTotals, ATotalThatDoesNotVaryIsFound) {
  for (const double value : {0.0, 0.25}) {
    const auto a = analysed(total_of(30, [&](double, double, double) { return value; }));
    EXPECT_EQ(a.total.mean, value);
    EXPECT_EQ(a.total.sd, 0);
    EXPECT_EQ(a.total.finding, ShareFinding::same_in_all_runs);
    EXPECT_FALSE(a.total.polynomial_order.has_value());
    EXPECT_FALSE(a.total.chaos);
    EXPECT_EQ(a.total.morris[1].mu_star, 0);
    EXPECT_EQ(a.json["note"], "unreliable");
    EXPECT_FALSE(a.json.contains("source"));
    EXPECT_TRUE(a.json["total_order"][0]["value"].is_null());
    EXPECT_EQ(a.csv.find("nan"), std::string::npos);
    EXPECT_THAT(a.csv, HasSubstr("dissipated_energy,,,J," + std::string(value == 0 ? "0" : "0.25") + ",0,x1,-1,3,,,,,,,0,0,0,0,,,\n"));
  }
}

TEST(SensitivityOfTotals, APolynomialThatDoesNotFollowTheRunsSaysSo) {
  const auto a = analysed(total_of(60, [](double x, double y, double z) { return std::sin(40 * x) * std::sin(37 * y) > 0.2 * z ? 1.0 : 0.0; }));
  EXPECT_LT(a.total.left_out_r2, 0.5);
  EXPECT_EQ(a.total.finding, ShareFinding::poor_polynomial);
}

TEST(SensitivityOfTotals, TooFewRunsAreToldAndWithoutAnyThereIsNothing) {
  const auto a = analysed(total_of(11, polynomial));
  EXPECT_EQ(a.total.finding, ShareFinding::few_runs);
  EXPECT_EQ(a.total.runs, 11u);
  EXPECT_EQ(a.total.needed_runs, 12u);
  EXPECT_TRUE(std::isnan(a.total.mean));
  EXPECT_TRUE(a.json["mean"].is_null());
  EXPECT_TRUE(analysed(total_of(12, polynomial)).total.chaos);
  auto none = total_of(20, polynomial);
  none.values.setConstant(nan);
  EXPECT_EQ(analysed(none).total.finding, ShareFinding::no_run);
}

/// What was made before there were totals is not due again: the key stands in the identity only where they are asked for.
TEST(SensitivityOfTotals, AreInTheIdentityOnlyWhereTheyAreAskedFor) {
  EXPECT_FALSE(identity_options({}).contains("run_totals"));
  EXPECT_TRUE(identity_options({.run_totals = true}).contains("run_totals"));
  EXPECT_EQ(identity_options({}).size(), 3u);
}

}  // namespace
}  // namespace calomel
