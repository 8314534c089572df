#include "uq/sampler/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.hpp"
#include "base/options.hpp"

namespace calomel {

std::string place_text(const LogDensity& density, const Eigen::VectorXd& x) {
  std::string s;
  for (Eigen::Index k = 0; k < x.size(); ++k) s.append(k ? ", " : "").append(density.coordinates()[std::size_t(k)]).append(" = ").append(number_text(x[k]));
  return s;
}

double checked_log_density(const LogDensity& density, const Eigen::VectorXd& x) {
  const double value = density.log_density({x.data(), std::size_t(x.size())});
  if (std::isnan(value) || value == INFINITY)
    throw NumericsError(fmt::format("the log density is {} at {}", std::isnan(value) ? "NaN" : "infinite", place_text(density, x)));
  return value;
}

Beginning drawn_beginning(const std::function<double(const Eigen::VectorXd&)>& log_density, const Eigen::VectorXd& mean, const Eigen::MatrixXd& factor,
                          double width, RandomStream& random, const std::string& whose) {
  for (int attempt = 0; attempt < 200; ++attempt, width *= 0.95) {
    Eigen::VectorXd z(mean.size());
    for (double& v : z) v = random.normal();
    Beginning b{mean + width * (factor * z), 0};
    b.log_density = log_density(b.x);
    if (std::isfinite(b.log_density)) return b;
  }
  throw NumericsError(fmt::format("no start of {} has a positive density: 200 points about the given mean were tried, ever nearer to it", whose));
}

Eigen::MatrixXd covariance_factor(const Eigen::MatrixXd& covariance, std::size_t dimension) {
  expect(covariance.rows() == Eigen::Index(dimension) && covariance.cols() == Eigen::Index(dimension), "the covariance has the dimension of the density");
  if (covariance.allFinite())
    if (const Cholesky cholesky(covariance); cholesky.positive_definite())
      if (Eigen::MatrixXd lower = cholesky.lower(); lower.allFinite()) return lower;
  throw InputError({.problem = "the covariance that the chains start from is not positive definite", .suggestion = "give one that is, or none"});
}

void save_matrix(ByteWriter& out, const Eigen::Ref<const Eigen::MatrixXd>& m) {
  const Eigen::MatrixXd whole = m;
  out.values(std::span<const double>(whole.data(), std::size_t(whole.size())));
}

void restore_matrix(ByteReader& in, Eigen::Ref<Eigen::MatrixXd> m) {
  const auto values = in.values<double>();
  expect(Eigen::Index(values.size()) == m.size(), "a saved chain has the dimension of its density");
  m = Eigen::Map<const Eigen::MatrixXd>(values.data(), m.rows(), m.cols());
}

}  // namespace calomel
