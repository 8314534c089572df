#pragma once
/// What each group of numbers would be worth beside a fit, to first order: one question a group, a wall and a gauge.
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

/// A group, or a gauge's own part of one, at the strengths that say most.
struct Question {
  std::size_t group = 0;              ///< index into the groups
  std::optional<std::size_t> sensor;  ///< of a group that acts on each gauge alone
  std::vector<std::size_t> numbers;   ///< indices into the group's `added`, of those whose effect shows
  std::vector<double> shapes;         ///< values of the group's `shapes`
  Eigen::MatrixXd effects;            ///< changes of the model's values per unit of each number, (values of the model, n)
  AddedDirections directions;         ///< the same on the grid of the fit
  FirstOrder worth;                   ///< its log Bayes factor with `choice`
  double choice = 0;   ///< log of what of its evidence is left as its wall, stretch of a wall, gauge or scale might have been any other, each as likely
  double p_value = 1;  ///< of its score test, not corrected for their number
};

struct QuestionInputs {
  const PosteriorFit& fit;
  const Problem& problem;
  const std::vector<ParameterGroup>& groups;
  int level = 0;  ///< mesh of the runs
  RunAdded run;
  std::function<bool(const ParameterGroup&)> asked = [](const ParameterGroup&) { return true; };  ///< whether a group is asked about
};

struct Answers {
  std::vector<Question> questions;   ///< the best of each group, wall and gauge; most telling first
  std::vector<std::string> skipped;  ///< what could not be run, and why
};

/// Runs every number of every group at its first strengths at the fit's mode (one run a strength, and one of the base model), with each shape at its first
/// values. Either way from off is one question, the strengths of a log-uniform number are three, and so are the values of a shape. Errors: NumericsError where
/// the base model does not run at its own mode; those of `run`.
[[nodiscard]] Answers ask(const QuestionInputs& in);

/// Numbers that change nothing while the others of their group are off, such as the frequency of a force that is not there, as shapes of the group: they are
/// asked at values over their priors, and fitted with the others. theta: (n_parameters), where it is tried, one run a strength. A group of which no number acts
/// alone stays as it is, and so do all where the model has no answer there.
[[nodiscard]] std::vector<ParameterGroup> with_idle_numbers_as_shapes(std::vector<ParameterGroup> groups, const RunAdded& run, std::span<const double> theta);

/// The part of a group that acts on each gauge alone (`by_sensor`) which is one gauge's: numbers "mechanism.NAME.SENSOR.KEY" of the case, under the names of
/// the group's.
[[nodiscard]] ParameterGroup of_one_sensor(ParameterGroup group, const std::string& sensor);

/// "interface (top)", "sensor_response of S08".
[[nodiscard]] std::string label(const Question& q, const std::vector<ParameterGroup>& groups, const ModelShape& shape);

/// Of a number's prior; of a half-Cauchy one the strength that it is asked at, of a share how far it is from off there.
[[nodiscard]] double prior_sd(const AddedParameter& a, double strength);

/// How far a value lies from the middle of its prior, in standard deviations (a lognormal one's: of its logarithm); the range of a uniform one is taken for two
/// of them either way. Half-Cauchy: powers of ten above its scale. Infinite where the value is outside its range by more than `sd`, its own deviation.
[[nodiscard]] double implausibility(const AddedParameter& a, double value, double sd = 0);

}  // namespace calomel
