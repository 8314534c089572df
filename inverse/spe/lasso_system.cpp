#include "inverse/spe/lasso_system.hpp"

#include <algorithm>
#include <cmath>

#include "base/random.hpp"

namespace calomel {

namespace {

constexpr std::size_t path_points = 33;
constexpr double path_end = 1e-4;  // of lambda_max
constexpr double path_gap = 1e-4;  // to choose a lambda needs no more

}  // namespace

LassoSystem::LassoSystem(const Eigen::MatrixXi& degrees, const ScatteredData& data, bool penalise_constant)
    : basis_(basis_matrix(degrees, data.units)), data_(data), free_(penalise_constant ? -1 : 0) {}

Lasso LassoSystem::lasso(const std::vector<std::size_t>& rows) const {
  Eigen::MatrixXd a(Eigen::Index(rows.size()), basis_.cols());
  Eigen::VectorXd b(a.rows());
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    const auto row = Eigen::Index(rows[std::size_t(i)]);
    a.row(i) = data_.weights[row] * basis_.row(row);
    b[i] = data_.weights[row] * data_.values[row];
  }
  return {std::move(a), std::move(b), free_};
}

/// Sum of squared errors over `rows`.
double LassoSystem::squares(const Eigen::VectorXd& z, const std::vector<std::size_t>& rows) const {
  double sum = 0;
  for (const auto row : rows) {
    const auto i = Eigen::Index(row);
    sum += std::pow(data_.weights[i] * (basis_.row(i).dot(z) - data_.values[i]), 2);
  }
  return sum;
}

/// Adds the mean squared errors over `test` along the path that `train` gives.
void LassoSystem::add_curve(const std::vector<std::size_t>& train, const std::vector<std::size_t>& test, std::vector<double>& curve) const {
  const Lasso problem = lasso(train);
  const auto fits = problem.path(descending(problem.lambda_max(), path_end * problem.lambda_max(), path_points), path_gap);
  for (std::size_t i = 0; i < path_points; ++i) curve[i] += squares(fits[i].z, test) / double(test.size());
}

LambdaChoice LassoSystem::best_of(const std::vector<double>& curve, int parts) const {
  const auto i = std::size_t(std::min_element(curve.begin(), curve.end()) - curve.begin());
  const double most = lasso(data_.train).lambda_max();
  return {descending(most, path_end * most, path_points)[i], curve[i] / parts};
}

LambdaChoice LassoSystem::by_validation() const {
  expect(!data_.validation.empty(), "runs are held out");
  std::vector<double> curve(path_points, 0.0);
  add_curve(data_.train, data_.validation, curve);
  return best_of(curve, 1);
}

LambdaChoice LassoSystem::by_cross_validation(int folds, std::uint64_t seed) const {
  std::vector<double> curve(path_points, 0.0);
  const auto shuffled = RandomStream(seed, 0).permutation(data_.train.size());
  const int parts = std::min(folds, int(data_.train.size()) / 2);
  for (int k = 0; k < parts; ++k) {
    std::vector<std::size_t> train, test;
    for (std::size_t i = 0; i < shuffled.size(); ++i) (int(i % std::size_t(parts)) == k ? test : train).push_back(data_.train[shuffled[i]]);
    add_curve(train, test, curve);
  }
  return best_of(curve, parts);
}

}  // namespace calomel
