#include "uq/diagnosis/mixed_up.hpp"

#include <algorithm>

#include "base/median.hpp"
#include "uq/diagnosis/verdict.hpp"

namespace calomel {

namespace {

constexpr double clock_share = 0.01;  ///< of the record's length: prior standard deviation of a delay of all records

// Fits with the wrong physics have correlations of 0.95 and more with their own gauges, neighbours on one wall up to 0.97 with each other.
constexpr double unlike = 0.7, alike = 0.9;
constexpr double far_larger = 5;  ///< a bridge that is taken for another makes 4, a decimal point 10

Eigen::VectorXd part(const Decimation& grid, const Eigen::VectorXd& v, std::size_t i) {
  return v.segment(Eigen::Index(grid.offset(i)), Eigen::Index(grid.windows(i).size()));
}

/// Correlation sum(record simulation) / |record| |simulation| of the record of one observation with the simulation of another; 0 where they have other times.
double correlation(const Decimation& grid, const Eigen::VectorXd& records, const Eigen::VectorXd& simulation, std::size_t record, std::size_t gauge) {
  const Eigen::VectorXd y = part(grid, records, record), f = part(grid, simulation, gauge);
  const double size = y.norm() * f.norm();
  return y.size() == f.size() && size > 0 ? y.dot(f) / size : 0.0;
}

/// Median over the gauges of |correlation| with their own simulation.
double likeness(const Decimation& grid, const Eigen::VectorXd& records, const Eigen::VectorXd& simulation) {
  std::vector<double> own;
  for (std::size_t i = 0; i < grid.observations(); ++i) own.push_back(std::abs(correlation(grid, records, simulation, i, i)));
  return upper_median(std::move(own));
}

/// |record| / |simulation| of every gauge over the middle one of that of all, which the pulse's energy has; 1 where fewer than three leave it open which of
/// them is right.
std::vector<double> sizes(const Decimation& grid, const Eigen::VectorXd& records, const Eigen::VectorXd& simulation) {
  std::vector<double> all;
  for (std::size_t i = 0; i < grid.observations(); ++i) all.push_back(part(grid, records, i).norm() / part(grid, simulation, i).norm());
  if (all.size() < 3) return std::vector<double>(all.size(), 1.0);
  const double middle = upper_median(all);
  for (auto& x : all) x /= middle;
  return all;
}

}  // namespace

std::vector<MixedUp> mixed_up(const Problem& problem, const Decimation& grid, const Eigen::VectorXd& records, const Eigen::VectorXd& simulation) {
  const std::size_t n = grid.observations();
  const std::vector<double> size = sizes(grid, records, simulation);
  std::vector<MixedUp> out;
  for (std::size_t i = 0; i < n; ++i) {
    const double own = correlation(grid, records, simulation, i, i), factor = size[i];
    const bool other_size = own >= alike && std::max(factor, 1 / factor) > far_larger;
    if (own <= -alike || other_size)
      out.push_back({.gauge = problem.label(problem.observations[i]), .other = {}, .own = own, .like = std::abs(own), .factor = factor});
    if (own >= unlike || own <= -alike) continue;
    for (std::size_t j = i + 1; j < n; ++j) {
      const double like = std::min(correlation(grid, records, simulation, i, j), correlation(grid, records, simulation, j, i));
      if (problem.observations[i].condition == problem.observations[j].condition && like >= alike && correlation(grid, records, simulation, j, j) < unlike)
        out.push_back({.gauge = problem.label(problem.observations[i]), .other = problem.label(problem.observations[j]), .own = own, .like = like});
    }
  }
  return out;
}

namespace {

/// A simulation on the grid and how like its gauges' records it is.
struct Likest {
  Eigen::VectorXd simulation;
  double likeness = 0;
};

/// That of a fit's runs and its mode which most gauges are like.
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

std::vector<MixedUp> mixed_up(const Problem& problem, const PosteriorFit& fit) {
  return mixed_up(problem, fit.errors->grid(), fit.errors->data(), likest(fit).simulation);
}

bool surely_mixed_up(const Problem& problem, const PosteriorFit& fit) {
  const Likest best = likest(fit);
  return best.likeness >= alike && !mixed_up(problem, fit.errors->grid(), fit.errors->data(), best.simulation).empty();
}

AddedDirections lateness(const Problem& problem, const Decimation& grid, const Eigen::VectorXd& history) {
  const auto& t = problem.shape.times;
  Eigen::VectorXd late(history.size());
  for (Eigen::Index first = 0; first < history.size(); first += Eigen::Index(t.size()))
    std::ranges::copy(change_when_late({history.data() + first, t.size()}, t), late.data() + first);
  return {.by_number = grid.apply(Eigen::MatrixXd(late)),
          .prior_sd = Eigen::VectorXd::Constant(1, clock_share * (grid.record_time().back() - grid.record_time().front()))};
}

std::optional<LateRecords> late_records(const Problem& problem, const PosteriorFit& fit) {
  const FirstOrder worth = FirstOrderModel(*fit.posterior, fit.modes[0]).worth(lateness(problem, fit.errors->grid(), fit.history_at_mode()));
  if (worth.log_bayes_factor < Gates{}.log_bayes_factor) return {};
  return LateRecords{.late = worth.value[0], .sd = worth.sd[0], .log_bayes_factor = worth.log_bayes_factor};
}

}  // namespace calomel
