#include "uq/diagnosis/linearised_effect.hpp"

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.hpp"

namespace calomel {

namespace {

constexpr double least_move = 0.5;                   ///< root mean square of the moves of the numbers, in standard deviations, below which they have converged
constexpr double step_in_sd = 2, least_step = 0.25;  ///< step of a number over its standard deviation, and at least over its prior's

}  // namespace

void LinearisedEffect::set_estimate(const FirstOrderEstimate& estimate, const std::vector<double>& at) {
  converged = values.size() > 0 && std::sqrt(((estimate.value - values).array() / estimate.sd.array()).square().mean()) < least_move;
  values = estimate.value;
  sd = estimate.sd;
  theta = at;
}

Eigen::MatrixXd LinearisedEffect::points(const ParameterGroup& group) const {
  const auto n = Eigen::Index(candidate.numbers.size()), first = Eigen::Index(theta.size());
  Eigen::VectorXd off(first + Eigen::Index(group.added.size()));
  std::copy(theta.begin(), theta.end(), off.data());
  for (std::size_t k = 0; k < group.added.size(); ++k) off[first + Eigen::Index(k)] = *group.added[k].parameter.nominal;
  Eigen::MatrixXd thetas = off.replicate(1, n + 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Parameter& p = group.added[candidate.numbers[std::size_t(i)]].parameter;
    const Eigen::Index row = first + Eigen::Index(candidate.numbers[std::size_t(i)]);
    const double there = std::clamp(*p.nominal + values[i], p.min, p.max),
                 further = std::max(step_in_sd * sd[i], least_step * candidate.directions.prior_sd[i]);
    thetas.row(row).tail(n + 1).setConstant(there);
    thetas(row, i + 2) = there + further <= p.max ? there + further : std::max(there - further, p.min);
  }
  return thetas;
}

void LinearisedEffect::update(const Eigen::MatrixXd& thetas, const std::vector<RunRecord>& records, const Decimation& grid) {
  const auto n = Eigen::Index(candidate.numbers.size()), first = Eigen::Index(theta.size());
  const Eigen::VectorXd unmoved = records[0].history();
  for (Eigen::Index i = 1; i < thetas.cols(); ++i) {
    Eigen::VectorXd& point = run_.emplace_back(n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Index row = first + Eigen::Index(candidate.numbers[std::size_t(k)]);
      point[k] = thetas(row, i) - thetas(row, 0);
    }
    changes_.push_back(records[std::size_t(i)].history() - unmoved);
  }
  Eigen::MatrixXd x = Eigen::MatrixXd::Ones(Eigen::Index(run_.size()), n + 1), y(x.rows(), unmoved.size());
  for (Eigen::Index r = 0; r < x.rows(); ++r) {
    x.row(r).tail(n) = run_[std::size_t(r)].transpose();
    y.row(r) = changes_[std::size_t(r)].transpose();
  }
  const Eigen::MatrixXd fitted = solve_symmetric(x.transpose() * x, Eigen::MatrixXd(x.transpose() * y));
  rest = fitted.row(0).transpose();
  candidate.effects = fitted.bottomRows(n).transpose();
  candidate.directions.by_number = grid.apply(candidate.effects);
}

}  // namespace calomel
