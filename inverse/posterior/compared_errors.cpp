#include "inverse/posterior/compared_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/linear_algebra.hpp"

namespace calomel {

namespace {

constexpr double normal_95 = 1.959963984540054;  ///< half width of a normal's 95 % interval over its sd
constexpr double least_share = 1e-13;            ///< of the greatest eigenvalue, below which rounding is all that is left

LogPosterior without_mesh_errors(const PosteriorFit& fit) {
  std::vector<WeightedErrors> errors = fit.hypotheses;
  for (auto& h : errors) h.errors = h.errors.without(record_noise_term).without(beyond_term).without(mesh_term);
  const LogPosterior& p = *fit.posterior;
  return {
      p.box(), p.emulator(), fit.coefficients, errors, Eigen::MatrixXd::Zero(fit.noise.rows(), fit.noise.cols()), p.priors(), BeyondPrior{.mean = 0, .sd = 0}};
}

/// Samples with a band, each over its deviation: the emulator's coefficients there, (samples, coefficients), and the mean records, (samples).
struct Samples {
  Eigen::MatrixXd coefficients;
  Eigen::VectorXd records;
};
Samples samples_of(const Problem& problem, const Eigen::MatrixXd& coefficients) {
  Eigen::Index n = 0;
  for (const auto& o : problem.observations) n += Eigen::Index(o.banded_samples);
  if (n == 0)
    throw InputError(
        {.problem = "no sample of the records has a band", .key = "posterior.compare", .suggestion = std::string("leave out \"") + independent_errors + '"'});
  Samples s{Eigen::MatrixXd::Zero(n, coefficients.cols()), Eigen::VectorXd(n)};
  Eigen::Index row = 0;
  for (const auto& o : problem.observations) {
    const auto first = Eigen::Index(problem.shape.at(o.condition, o.sensor, 0));
    for (std::size_t t = 0; t < o.mean.size(); ++t) {
      if (!o.banded[t]) continue;
      const double sd = 0.5 * (o.high[t] - o.low[t]) / normal_95;
      const Stencil& at = problem.stencils[t];
      for (std::size_t j = 0; j < 4; ++j)
        if (at.weight[j] != 0) s.coefficients.row(row) += at.weight[j] / sd * coefficients.row(first + Eigen::Index(at.index[j]));
      s.records[row++] = o.mean[t] / sd;
    }
  }
  return s;
}

LogPosterior with_independent_errors(const PosteriorInputs& in, const PosteriorFit& fit, std::size_t own) {
  const LogPosterior& p = *fit.posterior;
  const Samples s = samples_of(in.problem, p.emulator().fit(fit.histories()));
  // |y - X f|^2 = |D^-1/2 V' X' y - D^1/2 V' f|^2 + const, X'X = V D V'.
  const SymmetricEigen eigen = symmetric_eigen(s.coefficients.transpose() * s.coefficients);
  const Eigen::Index size = eigen.values.size();
  Eigen::VectorXd root = Eigen::VectorXd::Zero(size), inverse_root = root;
  for (Eigen::Index i = 0; i < size; ++i)
    if (eigen.values[i] > least_share * eigen.values[size - 1]) {
      root[i] = std::sqrt(eigen.values[i]);
      inverse_root[i] = 1 / root[i];
    }
  const RecordErrors errors{.covariance = Eigen::MatrixXd::Identity(size, size),
                            .data = inverse_root.asDiagonal() * (eigen.vectors.transpose() * (s.coefficients.transpose() * s.records)),
                            .freedom = std::numeric_limits<double>::infinity()};
  const LogPosterior whole(p.box(), p.emulator(), root.asDiagonal() * eigen.vectors.transpose(), std::vector{errors}, Eigen::MatrixXd::Zero(size, size),
                           p.priors(), BeyondPrior{.mean = 0, .sd = 0});
  std::vector<std::pair<Eigen::Index, double>> held;
  for (std::size_t k = own; k < in.parameters.size(); ++k) held.emplace_back(Eigen::Index(k), *in.parameters[k].nominal);
  return whole.held(held);
}

}  // namespace

const std::vector<std::string>& compared_forms() {
  static const std::vector<std::string> forms{no_mesh_errors, independent_errors};
  return forms;
}

LogPosterior compared_posterior(const std::string& form, const PosteriorInputs& in, const PosteriorFit& fit, std::size_t own) {
  expect(own <= in.parameters.size(), "a case's own parameters come first");
  if (form == no_mesh_errors) return without_mesh_errors(fit);
  expect(form == independent_errors, "a form of errors has a name that is known");
  return with_independent_errors(in, fit, own);
}

}  // namespace calomel
