#pragma once
/// Screening of candidates: the evidence of each group of numbers beside a fit, to first order. There is one candidate a group, a wall and a gauge.
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "forward/parameter_group.hpp"
#include "inverse/posterior/posterior_fit.hpp"
#include "uq/diagnosis/first_order.hpp"

namespace calomel {

/// Runs the columns of thetas (n_parameters + added, n), each on its level's mesh.
using RunAdded = std::function<std::vector<RunRecord>(const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> added)>;

/// A group, or one gauge's part of a group, at the strengths with the greatest evidence.
struct ScreenedCandidate {
  std::size_t group = 0;              ///< index into the groups that were screened
  std::optional<std::size_t> sensor;  ///< of a group that acts on each gauge alone
  std::vector<std::size_t> numbers;   ///< indices into the group's `added` of those numbers whose effect shows
  std::vector<double> shapes;         ///< values of the group's `shapes`
  Eigen::MatrixXd effects;            ///< changes of the model's values per unit of each number, (values of the model, n)
  AddedDirections directions;         ///< the same on the grid of the fit
  FirstOrderEstimate first_order;     ///< its log Bayes factor includes `selection_penalty`
  double selection_penalty = 0;  ///< log of the share of its evidence that remains: its wall, stretch, gauge or scale might have been any other, equally likely
  double p_value = 1;            ///< of its score test, not corrected for the number of candidates
};

/// A group for which there is no candidate.
struct NotScreened {
  std::string label;                   ///< "interface (top)"
  std::optional<std::string> failure;  ///< message of a run that failed; none: no number of the group changes the records by itself
};

struct ScreeningInputs {
  const PosteriorFit& fit;
  const Problem& problem;
  const std::vector<ParameterGroup>& groups;
  int level = 0;  ///< mesh of the runs
  RunAdded run;
  std::function<bool(const ParameterGroup&)> includes = [](const ParameterGroup&) { return true; };  ///< whether a group is screened
};

struct ScreeningResult {
  std::vector<ScreenedCandidate> candidates;  ///< the best of each group, wall and gauge; greatest log Bayes factor first
  std::vector<NotScreened> not_screened;
};

/// Runs every number of every group at its first strengths at the fit's mode (one run a strength, and one of the base model), with each shape at its first
/// values. Each side of off is a candidate of its own; a log-uniform number has three strengths, and so has a shape. Errors: NumericsError where the base model
/// does not run at its own mode; those of `run`.
[[nodiscard]] ScreeningResult screen_candidates(const ScreeningInputs& in);

/// Turns numbers that change nothing while the others of their group are off, such as the frequency of a force that is not there, into shapes of the group.
/// They are screened at values over their priors and fitted with the others. theta: the point that is tried, (n_parameters), one run a strength. A group of
/// which no number acts alone remains as it is, and so do all groups where the model does not run there.
[[nodiscard]] std::vector<ParameterGroup> with_idle_numbers_as_shapes(std::vector<ParameterGroup> groups, const RunAdded& run, std::span<const double> theta);

/// One gauge's part of a group that acts on each gauge alone (`by_sensor`): numbers "mechanism.NAME.SENSOR.KEY" of the case, under the names of the group's.
[[nodiscard]] ParameterGroup of_one_sensor(ParameterGroup group, const std::string& sensor);

/// "interface (top)", "sensor_response of S08".
[[nodiscard]] std::string label(const ScreenedCandidate& candidate, const std::vector<ParameterGroup>& groups, const ModelShape& shape);

/// Standard deviation of a number's prior; of a half-Cauchy prior the strength at which it is screened, of a share its distance from off there.
[[nodiscard]] double prior_sd(const AddedParameter& a, double strength);

/// Distance of a value from the middle of its prior, in standard deviations (of a lognormal prior: of the logarithm). The range of a uniform prior counts as
/// two of them either way; a half-Cauchy prior counts powers of ten above its scale. Infinite where the value is outside its range by more than `sd`, its own
/// deviation.
[[nodiscard]] double implausibility(const AddedParameter& a, double value, double sd = 0);

}  // namespace calomel
