#include "inverse/spe/surrogates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>

#include "base/parallel.hpp"
#include "base/random.hpp"
#include "inverse/spe/adaptive_space.hpp"
#include "inverse/spe/lasso_system.hpp"

namespace calomel {

namespace {

constexpr int folds = 5;  ///< of the cross-validation over the training runs, the usual number

PolynomialFit fit_over(const Eigen::VectorXd& predicted, const ScatteredData& data, const std::vector<std::size_t>& rows, const std::string& transform) {
  double errors = 0, norm = 0, mean = 0, total = 0;
  for (const auto i : rows) mean += restored(transform, data.values[Eigen::Index(i)]) / double(rows.size());
  for (const auto i : rows) {
    const double actual = restored(transform, data.values[Eigen::Index(i)]), error = restored(transform, predicted[Eigen::Index(i)]) - actual;
    errors += error * error;
    norm += actual * actual;
    total += (actual - mean) * (actual - mean);
  }
  return {std::sqrt(errors / norm), total > 0 ? 1 - errors / total : std::numeric_limits<double>::quiet_NaN()};
}

Eigen::MatrixXi degrees_of(const PolynomialSpace& space, const ScatteredData& data, const SpeOptions& options, std::uint64_t seed) {
  return space.kind == adaptive_kind ? adaptive_degrees(data, space.order, std::size_t(options.most_terms), options.penalise_constant, folds, seed)
                                     : space.degrees(std::size_t(data.units.rows()));
}

/// Everything about one space.
std::vector<SparsePolynomial> fit_space(SpaceChoice& choice, const ScatteredData& data, const SpeOptions& options, std::uint64_t seed) {
  const auto degrees = degrees_of(choice.space, data, options, seed);
  choice.terms = std::size_t(degrees.cols());
  const LassoSystem system(degrees, data, options.penalise_constant);
  const Lasso problem = system.lasso(data.train);
  choice.lambda_max = problem.lambda_max();

  // 1. Which lambda the held-out runs and the folds of the training runs prefer.
  choice.validation = system.by_validation();
  choice.cross_validation = system.by_cross_validation(folds, seed);

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
    const Eigen::VectorXd predicted = system.basis() * fits[i].z;
    p.train = fit_over(predicted, data, data.train, options.transform);
    p.validation = fit_over(predicted, data, data.validation, options.transform);
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
  if (total_degree.empty() && tensor_product.empty() && hyperbolic_cross.empty() && sparse_grid.empty() && adaptive.empty())
    throw InputError({.problem = "no polynomial space is listed",
                      .key = "total_degree",
                      .suggestion = "list orders of total_degree, tensor_product or hyperbolic_cross, levels of sparse_grid or rounds of adaptive"});
}

SparsePolynomials fit_sparse_polynomials(const ScatteredData& data, const SpeOptions& options, std::uint64_t seed, int threads,
                                         const std::function<void(std::size_t done, std::size_t total)>& done) {
  const auto d = std::size_t(data.units.rows());
  SparsePolynomials out;
  const auto list = [&](const char* kind, const std::vector<int>& orders) {
    for (const int order : orders) {
      PolynomialSpace space{kind, order};
      if (space.terms(d, std::size_t(options.most_terms) + 1) > std::size_t(options.most_terms))
        out.too_large.push_back(space.name());
      else
        out.spaces.push_back({.space = std::move(space)});
    }
  };
  list("total_degree", options.total_degree);
  list("tensor_product", options.tensor_product);
  list("hyperbolic_cross", options.hyperbolic_cross);
  list("sparse_grid", options.sparse_grid);
  for (const int rounds : options.adaptive) out.spaces.push_back({.space = {adaptive_kind, rounds}});
  if (out.spaces.empty())
    throw InputError({.problem = fmt::format("every listed space has more than {} terms in {} parameters", options.most_terms, d),
                      .key = "spe.total_degree",
                      .suggestion = "list lower orders, or spe.hyperbolic_cross or spe.sparse_grid"});
  std::vector<std::vector<SparsePolynomial>> fits(out.spaces.size());
  std::mutex lock;
  std::size_t finished = 0;
  parallel_for(out.spaces.size(), threads, [&](std::size_t i) {
    const std::size_t s = out.spaces.size() - 1 - i;  // the largest tend to be last: begin with them
    fits[s] = fit_space(out.spaces[s], data, options, seed);
    const std::lock_guard guard(lock);
    if (done) done(++finished, out.spaces.size());
  });
  for (auto& f : fits) std::move(f.begin(), f.end(), std::back_inserter(out.surrogates));
  return out;
}

}  // namespace calomel
