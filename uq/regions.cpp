#include "uq/regions.hpp"

#include <algorithm>

#include "base/errors.hpp"
#include "base/linear_algebra.hpp"
#include "uq/convergence/diagnostics.hpp"

namespace calomel {

Regions regions(const Draws& draws, const std::vector<std::string>& names) {
  Regions out;
  std::vector<std::vector<double>> values;
  for (const auto& name : names) {
    const auto at = std::find(draws.names.begin(), draws.names.end(), name);
    if (at == draws.names.end()) continue;
    out.names.push_back(name);
    values.push_back(draws.of(std::size_t(at - draws.names.begin())));
  }
  const auto d = Eigen::Index(out.names.size());
  const auto n = Eigen::Index(draws.chains * draws.draws);
  expect(d > 0 && n > 0, "regions need draws of some quantity");
  Eigen::MatrixXd x(d, n);
  for (Eigen::Index k = 0; k < d; ++k) x.row(k) = Eigen::Map<const Eigen::RowVectorXd>(values[std::size_t(k)].data(), n);
  out.mean = x.rowwise().mean();
  if (n < 2) return out;
  const Eigen::MatrixXd centred = x.colwise() - out.mean;
  out.covariance = centred * centred.transpose() / double(n - 1);
  // Distances are in units of each quantity's own standard deviation, because the quantities differ by ten orders of magnitude.
  const Eigen::VectorXd sd = out.covariance.diagonal().cwiseSqrt().cwiseMax(1e-300);
  const Eigen::MatrixXd unit = sd.cwiseInverse().asDiagonal() * centred;
  const Eigen::RowVectorXd square = unit.cwiseProduct(solve_symmetric(Eigen::MatrixXd(unit * unit.transpose() / double(n - 1)), unit)).colwise().sum();
  const std::vector<double> distances(square.begin(), square.end());
  for (const double share : {0.5, 0.9}) {
    Regions::Share s{.share = share, .low = {}, .high = {}, .square_radius = quantile(distances, share)};
    for (const auto& v : values) {
      s.low.push_back(quantile(v, (1 - share) / 2));
      s.high.push_back(quantile(v, (1 + share) / 2));
    }
    out.shares.push_back(std::move(s));
  }
  return out;
}

}  // namespace calomel
