#include "uq/sensitivity/totals.hpp"

#include <algorithm>

#include "base/not_finite.hpp"

namespace calomel {

namespace {

constexpr double followed = 0.9;             ///< left-out R2 above which a polynomial represents the runs
constexpr Eigen::Index block_points = 4096;  ///< points that are evaluated together

/// The values (n) of f at points of the unit cube, block by block.
template <class F>
Eigen::VectorXd at_points(const Eigen::MatrixXd& unit, F&& f) {
  Eigen::VectorXd out(unit.cols());
  for (Eigen::Index begin = 0; begin < unit.cols(); begin += block_points) {
    const Eigen::Index count = std::min(block_points, unit.cols() - begin);
    out.segment(begin, count) = f(Eigen::MatrixXd(unit.middleCols(begin, count)));
  }
  return out;
}

/// The rows of one number from its values at the design, of which each row has A, B and the d points between them.
SobolRows rows_of(const Eigen::VectorXd& values, Eigen::Index d) {
  const Eigen::Index n = values.size() / (d + 2);
  SobolRows rows{Eigen::VectorXd(n), Eigen::MatrixXd(n, d), Eigen::MatrixXd(n, d)};
  const auto half_square = [](double x) { return 0.5 * x * x; };
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto f = values.segment(i * (d + 2), d + 2);
    rows.variance[i] = half_square(f[0] - f[1]);
    for (Eigen::Index k = 0; k < d; ++k) {
      rows.alone(i, k) = half_square(f[1] - f[2 + k]);
      rows.total(i, k) = half_square(f[0] - f[2 + k]);
    }
  }
  return rows;
}

/// Analyses one total from its values at x (d, n) in [-1, 1].
void analyse(QuantitySensitivity& one, const Eigen::MatrixXd& x, const Eigen::VectorXd& values, const SensitivityInputs& in, const Eigen::MatrixXd& design,
             const Eigen::MatrixXd& steps) {
  const Eigen::Index d = x.rows();
  const Eigen::Index n = values.size();
  const bool varies = n > 0 && values.maxCoeff() > values.minCoeff();
  LegendreChaos chaos;
  if (n >= 3 * (d + 1)) chaos = fit_chaos(x, values);
  const bool fitted = chaos.coefficients.size() > 0;
  const auto f = [&](const Eigen::MatrixXd& unit) -> Eigen::VectorXd {
    if (!varies) return Eigen::VectorXd::Constant(unit.cols(), n > 0 ? values[0] : nan);
    if (!fitted) return Eigen::VectorXd::Constant(unit.cols(), nan);
    return values_of(chaos, 2 * unit_of(in.theta(unit), in.model.shape().parameters).array() - 1);
  };
  const Eigen::VectorXd at_design = at_points(design, f);
  const auto at_a = Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<>>(at_design.data(), at_design.size() / (d + 2), Eigen::InnerStride<>(d + 2));
  one.mean = at_a.mean();
  one.sd = std::sqrt((at_a.array() - one.mean).square().mean());
  one.sobol = sobol_indices(rows_of(at_design, d), in.seed);
  one.morris = morris_effects(steps, at_points(steps, f).transpose()).front();
  one.runs = std::size_t(n);
  one.needed_runs = std::size_t(3 * (d + 1));
  if (n == 0) {
    one.finding = ShareFinding::no_run;
  } else if (!varies) {
    one.mean = values[0];
    one.sd = 0;
    one.finding = ShareFinding::same_in_all_runs;
  } else if (!fitted) {
    one.finding = ShareFinding::few_runs;
  } else {
    one.polynomial_order = chaos.order;
    one.left_out_r2 = chaos.left_out_r2;
    if (!(chaos.left_out_r2 >= followed)) one.finding = ShareFinding::poor_polynomial;
    if (in.options.measure == "uniform") one.chaos = std::move(chaos);
  }
}

}  // namespace

Eigen::MatrixXd unit_of(const Eigen::MatrixXd& thetas, const std::vector<Parameter>& parameters) {
  Eigen::MatrixXd out = thetas;
  for (Eigen::Index k = 0; k < out.rows(); ++k) {
    const auto& p = parameters[std::size_t(k)];
    out.row(k) = (out.row(k).array() - p.min) / (p.max - p.min);
  }
  return out;
}

std::vector<QuantitySensitivity> analyse_totals(const SensitivityInputs& in, const Eigen::MatrixXd& design, const Eigen::MatrixXd& steps) {
  const TotalsOfRuns& totals = *in.totals;
  const Eigen::MatrixXd x = 2 * unit_of(totals.thetas, in.model.shape().parameters).array() - 1;
  std::vector<QuantitySensitivity> out;
  for (std::size_t q = 0; q < totals.which.size(); ++q) {
    const Eigen::VectorXd values = totals.values.row(Eigen::Index(q)).transpose();
    std::vector<Eigen::Index> whole;
    for (Eigen::Index i = 0; i < values.size(); ++i)
      if (std::isfinite(values[i])) whole.push_back(i);
    QuantitySensitivity one;
    one.name = totals.which[q].name;
    one.condition = totals.which[q].condition;
    one.unit = totals.which[q].unit;
    analyse(one, x(Eigen::all, whole), values(whole), in, design, steps);
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace calomel
