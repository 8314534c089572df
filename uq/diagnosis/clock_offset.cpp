#include "uq/diagnosis/clock_offset.hpp"

#include <algorithm>

#include "uq/diagnosis/verdict.hpp"

namespace calomel {

namespace {

constexpr double clock_share = 0.01;  ///< prior standard deviation of a delay of all records, over the record's length

}  // namespace

AddedDirections clock_directions(const Problem& problem, const Decimation& grid, const Eigen::VectorXd& history) {
  const auto& t = problem.shape.times;
  Eigen::VectorXd late(history.size());
  for (Eigen::Index first = 0; first < history.size(); first += Eigen::Index(t.size()))
    std::ranges::copy(change_when_late({history.data() + first, t.size()}, t), late.data() + first);
  return {.by_number = grid.apply(Eigen::MatrixXd(late)),
          .prior_sd = Eigen::VectorXd::Constant(1, clock_share * (grid.record_time().back() - grid.record_time().front()))};
}

std::optional<ClockOffset> clock_offset(const Problem& problem, const PosteriorFit& fit) {
  const FirstOrderModel model(*fit.posterior, fit.modes[0]);
  const FirstOrderEstimate estimate = model.estimate(clock_directions(problem, fit.errors->grid(), fit.history_at_mode()));
  if (estimate.log_bayes_factor < Gates{}.log_bayes_factor) return {};
  return ClockOffset{.delay = estimate.value[0], .sd = estimate.sd[0], .log_bayes_factor = estimate.log_bayes_factor};
}

}  // namespace calomel
