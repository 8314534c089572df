#include "inverse/pair_validation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.hpp"
#include "inverse/map_lessons.hpp"
#include "inverse/mesh_pairs.hpp"

namespace calomel {

namespace {

constexpr std::size_t fewest_pairs = 6;

/// Squared distance of x from an optimum by its covariance.
double distance_squared(const Eigen::VectorXd& x, const Optimum& o) {
  const Eigen::VectorXd d = x - o.x;
  return d.dot(solve_symmetric(o.covariance, d));
}

/// Indices of the half of the pairs that lie nearest to the optimum; empty for fewer than fewest_pairs.
std::vector<std::size_t> nearest_half(const std::vector<AddedRun>& runs, const SearchSpace& space, const Optimum& optimum) {
  std::vector<std::pair<double, std::size_t>> by_distance;
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (runs[i].paired()) by_distance.emplace_back(distance_squared(space.from(runs[i].theta), optimum), i);
  if (by_distance.size() < fewest_pairs) return {};
  std::sort(by_distance.begin(), by_distance.end());
  std::vector<std::size_t> nearest;
  for (std::size_t k = 0; k < by_distance.size() / 2; ++k) nearest.push_back(by_distance[k].second);
  return nearest;
}

/// An answer to the records of a pair, and what they leave over there.
struct Found {
  Optimum optimum;
  Eigen::VectorXd residual;
};

/// The best optimum for records that pair `left_out` of `runs` would have given, found without it.
std::optional<Found> found_without(MapSearch& search, MapModels& current, const MapModels& models, const std::vector<AddedRun>& runs, std::size_t left_out,
                                     const std::vector<Optimum>& optima) {
  const SearchSpace& space = search.space();
  std::vector<AddedRun> rest = runs;
  rest.erase(rest.begin() + std::ptrdiff_t(left_out));
  teach(current, models, rest, search);
  const AddedRun& pair = runs[left_out];
  const Eigen::VectorXd working = values_of(pair.working.mean);
  const Eigen::VectorXd records = working + (1 + search.options().mesh_beyond) * (values_of(pair.fine->mean) - working);
  const Likelihood of_data = search.likelihood(space.theta(optima[0].x), true);
  const Likelihood likelihood = of_data.moved(of_data.grid().apply(records) - of_data.data());
  std::vector<Eigen::VectorXd> starts{space.from(pair.theta)}, widths;
  for (const auto& o : optima) starts.push_back(o.x);
  const Eigen::VectorXd sd = optima[0].covariance.diagonal().cwiseSqrt();
  for (const auto& x : starts) widths.push_back(space.secant_widths(x, search.secant() * sd, search.secant()));
  const auto found = search.optima(likelihood, starts, widths, {});
  if (found.empty()) return std::nullopt;
  const auto theta = space.theta(found[0].x);
  return Found{found[0], likelihood.residual(theta, search.model().evaluate(theta).mean)};
}

}  // namespace

PairValidation validate_pairs(MapSearch& search, MapModels& current, const MapModels& models, const std::vector<AddedRun>& runs, const std::vector<Optimum>& optima) {
  const SearchSpace& space = search.space();
  PairValidation v;
  const auto nearest = nearest_half(runs, space, optima[0]);
  if (nearest.empty()) return v;
  double sum = 0;
  for (const std::size_t i : nearest) {
    const auto found = found_without(search, current, models, runs, i, optima);
    if (!found) continue;
    const double squares = distance_squared(space.from(runs[i].theta), found->optimum);
    v.pairs.push_back({runs[i].theta, space.theta(found->optimum.x), squares});
    v.residuals.conservativeResize(found->residual.size(), v.residuals.cols() + 1);
    v.residuals.col(v.residuals.cols() - 1) = found->residual;
    sum += squares;
  }
  teach(current, models, runs, search);
  if (v.pairs.empty()) return v;
  const double mean = sum / double(v.pairs.size()) / double(space.size());
  v.inflation = std::max(1.0, mean);
  v.sentence = fmt::format("records that {} of the pairs would have given, each left out in turn, are explained by parameters {:.2g} of their standard deviations away (root mean square)", v.pairs.size(),
                           std::sqrt(mean));
  if (v.inflation > 1) v.sentence += fmt::format("; the reported ones are widened by {:.2g}: the mesh's error varies from place to place more than the pairs tell (map.mesh_pairs)", std::sqrt(v.inflation));
  return v;
}

}  // namespace calomel
