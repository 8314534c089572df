#include "uq/diagnosis/mislabelled_channels.hpp"

#include <algorithm>
#include <cmath>

#include "base/median.hpp"

namespace calomel {

namespace {

// Fits with the wrong physics have correlations of 0.95 and more with their own gauges; neighbours on one wall have up to 0.97 with each other.
constexpr double unlike = 0.7, like_it = 0.9;
constexpr double far_larger = 5;  ///< a bridge that is taken for another makes 4, a decimal point 10

Eigen::VectorXd of_observation(const Decimation& grid, const Eigen::VectorXd& v, std::size_t i) {
  return v.segment(Eigen::Index(grid.offset(i)), Eigen::Index(grid.windows(i).size()));
}

/// Correlation sum(record simulation) / |record| |simulation| of the record of one observation with the simulation of another; 0 where they have other times.
double correlation(const Decimation& grid, const Eigen::VectorXd& records, const Eigen::VectorXd& simulation, std::size_t record, std::size_t gauge) {
  const Eigen::VectorXd y = of_observation(grid, records, record), f = of_observation(grid, simulation, gauge);
  const double size = y.norm() * f.norm();
  return y.size() == f.size() && size > 0 ? y.dot(f) / size : 0.0;
}

/// Median over the gauges of |correlation| with their own simulation.
double likeness(const Decimation& grid, const Eigen::VectorXd& records, const Eigen::VectorXd& simulation) {
  std::vector<double> own;
  for (std::size_t i = 0; i < grid.observations(); ++i) own.push_back(std::abs(correlation(grid, records, simulation, i, i)));
  return upper_median(std::move(own));
}

/// |record| / |simulation| of every gauge over the median of all gauges, which is the pulse's energy. 1 where there are fewer than three gauges: it is then not
/// known which of them is right.
std::vector<double> relative_sizes(const Decimation& grid, const Eigen::VectorXd& records, const Eigen::VectorXd& simulation) {
  std::vector<double> all;
  for (std::size_t i = 0; i < grid.observations(); ++i) all.push_back(of_observation(grid, records, i).norm() / of_observation(grid, simulation, i).norm());
  if (all.size() < 3) return std::vector<double>(all.size(), 1.0);
  const double middle = upper_median(all);
  for (auto& x : all) x /= middle;
  return all;
}

}  // namespace

std::vector<MislabelledChannel> mislabelled_channels(const Problem& problem, const Decimation& grid, const Eigen::VectorXd& records,
                                                     const Eigen::VectorXd& simulation) {
  const std::size_t n = grid.observations();
  const std::vector<double> size = relative_sizes(grid, records, simulation);
  std::vector<MislabelledChannel> out;
  for (std::size_t i = 0; i < n; ++i) {
    const double own = correlation(grid, records, simulation, i, i), factor = size[i];
    const bool other_size = own >= like_it && std::max(factor, 1 / factor) > far_larger;
    if (own <= -like_it || other_size)
      out.push_back({.gauge = problem.label(problem.observations[i]), .other = {}, .own = own, .like = std::abs(own), .factor = factor});
    if (own >= unlike || own <= -like_it) continue;
    for (std::size_t j = i + 1; j < n; ++j) {
      const double like = std::min(correlation(grid, records, simulation, i, j), correlation(grid, records, simulation, j, i));
      if (problem.observations[i].condition == problem.observations[j].condition && like >= like_it && correlation(grid, records, simulation, j, j) < unlike)
        out.push_back({.gauge = problem.label(problem.observations[i]), .other = problem.label(problem.observations[j]), .own = own, .like = like});
    }
  }
  return out;
}

namespace {

/// A simulation on the grid and its likeness to the records of its gauges.
struct Likest {
  Eigen::VectorXd simulation;
  double likeness = 0;
};

/// The run of a fit, or its mode, which most gauges are like.
Likest likest(const PosteriorFit& fit) {
  const Decimation& grid = fit.errors->grid();
  const Eigen::VectorXd& records = fit.errors->data();
  Likest best{.simulation = fit.prediction(fit.modes[0].at)};
  best.likeness = likeness(grid, records, best.simulation);
  for (const auto& run : fit.runs) {
    if (!run.record.done) continue;
    Eigen::VectorXd simulation = grid.apply(run.record.history());
    if (const double like = likeness(grid, records, simulation); like > best.likeness) best = {std::move(simulation), like};
  }
  return best;
}

}  // namespace

std::vector<MislabelledChannel> mislabelled_channels(const Problem& problem, const PosteriorFit& fit) {
  return mislabelled_channels(problem, fit.errors->grid(), fit.errors->data(), likest(fit).simulation);
}

bool surely_mislabelled(const Problem& problem, const PosteriorFit& fit) {
  const Likest best = likest(fit);
  return best.likeness >= like_it && !mislabelled_channels(problem, fit.errors->grid(), fit.errors->data(), best.simulation).empty();
}

}  // namespace calomel
