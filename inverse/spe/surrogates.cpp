#include "inverse/spe/surrogates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>

#include "base/parallel.hpp"
#include "base/random.hpp"
#include "forward/surrogate/lasso.hpp"

namespace calomel {

namespace {

constexpr std::size_t path_points = 33;
constexpr double path_end = 1e-4;  // of lambda_max
constexpr double path_gap = 1e-4;  // to choose a lambda needs no more

/// The basis at all runs and the rows' factors.
struct System {
  Eigen::MatrixXd basis;  ///< (n, terms), without the factors
  const ScatteredData& data;
  Eigen::Index free;  ///< the unpenalised column, or -1

  [[nodiscard]] Lasso lasso(const std::vector<std::size_t>& rows) const {
    Eigen::MatrixXd a(Eigen::Index(rows.size()), basis.cols());
    Eigen::VectorXd b(a.rows());
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      const auto row = Eigen::Index(rows[std::size_t(i)]);
      a.row(i) = data.weights[row] * basis.row(row), b[i] = data.weights[row] * data.values[row];
    }
    return {std::move(a), std::move(b), free};
  }
  /// Sum of squared errors, weighted as the fit is, over `rows`.
  [[nodiscard]] double squares(const Eigen::VectorXd& z, const std::vector<std::size_t>& rows) const {
    double sum = 0;
    for (const auto row : rows) {
      const auto i = Eigen::Index(row);
      sum += std::pow(data.weights[i] * (basis.row(i).dot(z) - data.values[i]), 2);
    }
    return sum;
  }
  /// Mean squared error over `test` along the path that `train` gives; lambdas as shares of its own lambda_max.
  void add_curve(const std::vector<std::size_t>& train, const std::vector<std::size_t>& test, std::vector<double>& curve) const {
    const Lasso problem = lasso(train);
    const auto fits = problem.path(descending(problem.lambda_max(), path_end * problem.lambda_max(), path_points), path_gap);
    for (std::size_t i = 0; i < path_points; ++i) curve[i] += squares(fits[i].z, test) / double(test.size());
  }
};

LambdaChoice best_of(const std::vector<double>& curve, double lambda_max, int parts) {
  const auto i = std::size_t(std::min_element(curve.begin(), curve.end()) - curve.begin());
  return {descending(lambda_max, path_end * lambda_max, path_points)[i], curve[i] / parts};
}

PolynomialFit fit_over(const Eigen::VectorXd& predicted, const ScatteredData& data, const std::vector<std::size_t>& rows, const std::string& transform) {
  double errors = 0, norm = 0, mean = 0, spread = 0;
  for (const auto i : rows) mean += restored(transform, data.values[Eigen::Index(i)]) / double(rows.size());
  for (const auto i : rows) {
    const double actual = restored(transform, data.values[Eigen::Index(i)]), error = restored(transform, predicted[Eigen::Index(i)]) - actual;
    errors += error * error, norm += actual * actual, spread += (actual - mean) * (actual - mean);
  }
  return {std::sqrt(errors / norm), spread > 0 ? 1 - errors / spread : std::numeric_limits<double>::quiet_NaN()};
}

/// Everything about one space.
std::vector<SparsePolynomial> fit_space(SpaceChoice& choice, const ScatteredData& data, const SpeOptions& options, std::uint64_t seed) {
  const auto degrees = choice.space.degrees(std::size_t(data.units.rows()));
  choice.terms = std::size_t(degrees.cols());
  const System system{basis_matrix(degrees, data.units), data, options.penalise_constant ? -1 : 0};
  const Lasso problem = system.lasso(data.train);
  choice.lambda_max = problem.lambda_max();

  // 1. Which lambda the held-out runs and the folds of the training runs prefer.
  std::vector<double> curve(path_points, 0.0);
  system.add_curve(data.train, data.validation, curve);
  choice.validation = best_of(curve, choice.lambda_max, 1);
  curve.assign(path_points, 0.0);
  const auto shuffled = RandomStream(seed, 0).permutation(data.train.size());
  const int folds = std::min(options.folds, int(data.train.size()) / 2);
  for (int k = 0; k < folds; ++k) {
    std::vector<std::size_t> train, test;
    for (std::size_t i = 0; i < shuffled.size(); ++i) (int(i % std::size_t(folds)) == k ? test : train).push_back(data.train[shuffled[i]]);
    system.add_curve(train, test, curve);
  }
  choice.cross_validation = best_of(curve, choice.lambda_max, folds);

  // 2. The surrogates, from the largest lambda down.
  const auto& scale = options.lambda_scale;
  const double unit = scale == "absolute"     ? 1
                      : scale == "lambda_max" ? choice.lambda_max
                      : scale == "validation" ? choice.validation.lambda
                                              : choice.cross_validation.lambda;
  std::vector<double> lambdas = options.lambdas;
  for (auto& l : lambdas) l *= unit;
  std::sort(lambdas.rbegin(), lambdas.rend());
  const auto fits = problem.path(lambdas);
  std::vector<LassoFit> final_fits = fits;
  if (options.refit) {
    std::vector<std::size_t> all = data.train;
    all.insert(all.end(), data.validation.begin(), data.validation.end());
    std::sort(all.begin(), all.end());
    // The squared error grows with the number of rows; a lambda that was chosen grows with it.
    const double more = scale == "absolute" ? 1 : double(all.size()) / double(data.train.size());
    auto raised = lambdas;
    for (auto& l : raised) l *= more;
    final_fits = system.lasso(all).path(raised);
  }
  std::vector<SparsePolynomial> out;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    SparsePolynomial p{
        .space = choice.space, .terms = choice.terms, .nonzero = fits[i].nonzero, .lambda = lambdas[i], .lambda_max = choice.lambda_max, .gap = fits[i].gap};
    const Eigen::VectorXd predicted = system.basis * fits[i].z;
    p.train = fit_over(predicted, data, data.train, options.transform), p.validation = fit_over(predicted, data, data.validation, options.transform);
    if (fits[i].all_zero() || final_fits[i].all_zero())
      p.failure = fmt::format("every coefficient vanishes: lambda = {:.4g} against lambda_max = {:.4g}", lambdas[i], choice.lambda_max);
    else
      p.expansion = Expansion(degrees, final_fits[i].z);
    out.push_back(std::move(p));
  }
  return out;
}

}  // namespace

double transformed(const std::string& transform, double cost) { return transform == "log" ? std::log(cost) : cost; }
double restored(const std::string& transform, double value) { return transform == "log" ? std::exp(value) : value; }

void SpeOptions::validate() const {
  if (total_degree.empty() && tensor_product.empty() && hyperbolic_cross.empty())
    throw InputError(
        {.problem = "no polynomial space is listed", .key = "total_degree", .suggestion = "list orders of total_degree, tensor_product or hyperbolic_cross"});
}

SparsePolynomials fit_sparse_polynomials(const ScatteredData& data, const SpeOptions& options, std::uint64_t seed, int threads,
                                         const std::function<void(std::size_t done, std::size_t total)>& done) {
  const auto d = std::size_t(data.units.rows());
  SparsePolynomials out;
  std::vector<std::string> too_large;
  const auto list = [&](const char* kind, const std::vector<int>& orders) {
    for (const int order : orders) {
      PolynomialSpace space{kind, order};
      if (space.terms(d, std::size_t(options.most_terms) + 1) > std::size_t(options.most_terms))
        too_large.push_back(space.name());
      else
        out.spaces.push_back({.space = std::move(space)});
    }
  };
  list("total_degree", options.total_degree), list("tensor_product", options.tensor_product), list("hyperbolic_cross", options.hyperbolic_cross);
  if (out.spaces.empty())
    throw InputError({.problem = fmt::format("every listed space has more than {} terms in {} parameters", options.most_terms, d),
                      .key = "spe.total_degree",
                      .suggestion = "list lower orders, or spe.hyperbolic_cross"});
  if (!too_large.empty()) out.warnings.push_back(fmt::format("polynomial spaces of more than {} terms are left out: {}", options.most_terms, join(too_large)));
  std::vector<std::vector<SparsePolynomial>> fits(out.spaces.size());
  std::mutex lock;
  std::size_t finished = 0;
  parallel_for(out.spaces.size(), threads, [&](std::size_t i) {
    const std::size_t s = out.spaces.size() - 1 - i;  // the largest tend to stand last: begin with them
    fits[s] = fit_space(out.spaces[s], data, options, seed);
    const std::lock_guard guard(lock);
    if (done) done(++finished, out.spaces.size());
  });
  for (auto& f : fits) std::move(f.begin(), f.end(), std::back_inserter(out.surrogates));
  return out;
}

}  // namespace calomel
