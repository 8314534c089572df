#pragma once
/// One alternative to the base model, with all that a diagnosis knows of it.
#include <map>
#include <string>
#include <vector>

#include "forward/parameter_group.hpp"
#include "inverse/posterior/posterior_fit.hpp"
#include "uq/diagnosis/screening.hpp"
#include "uq/diagnosis/verdict.hpp"

namespace calomel {

/// A number with its posterior mean and standard deviation, natural units.
struct Estimate {
  std::string name;
  double mean = 0, sd = 0;
  bool from_records = true;  ///< false: the records do not narrow it, and mean and sd are the prior's
};

/// How the fit of an alternative ended.
struct FitStatus {
  enum class Kind {
    unremarkable,           ///< nothing to report
    first_order,            ///< it was not fitted
    linearised_run_failed,  ///< a run about the estimate of its numbers failed
    on_unsettled_fit,       ///< it is added to a fit that has not settled
    numbers_moved,          ///< its numbers still moved after all its runs
    stable,                 ///< evidence and numbers were stable before its emulator settled
    emulator,               ///< as `settling` has it
    run_limit,              ///< `run_limit` ended it
    failed                  ///< with the error `message`
  };
  Kind kind = Kind::unremarkable;
  int coarse = 0, fine = 0;  ///< runs from which on it was stable
  Settling settling;         ///< of the emulator
  int run_limit = 0;         ///< diagnosis.max_runs
  std::string message;
};

/// An explanation beside the base model: a mechanism, a fault of one gauge, or two of these together.
struct Alternative {
  Explanation explanation;
  std::vector<std::string> groups;                ///< one, or the two of a pair
  std::string sensor;                             ///< gauge of a fault of one gauge
  std::vector<std::string> other_sensors;         ///< gauges whose fault explains as much: the records do not distinguish them
  std::map<std::string, std::string> places;      ///< by group: wall or stretch of a wall, gauge, or law; empty: it has none
  double first_order_log_bayes_factor = 0;        ///< about the base fit
  double selection_penalty = 0;                   ///< ScreenedCandidate's, the sum for a pair; part of both log Bayes factors
  double p_value = 1;                             ///< of its score test, not corrected for the number of candidates
  std::vector<Estimate> numbers;                  ///< its own
  std::vector<Estimate> base_parameters;          ///< the case's parameters with it
  std::vector<double> history;                    ///< (values of the model) at its mode
  std::vector<double> held_out;                   ///< misfit of each fold without it and with it, one after another
  std::vector<double> held_out_log_bayes_factor;  ///< by the records outside of each fold
  double held_out_gain = 0;                       ///< 1 - after / before
  std::vector<double> held_out_history;           ///< (values of the model): each gauge by the fit without it; empty where there is none
  int runs = 0;                                   ///< made for it alone
  bool settled = false;                           ///< more runs would not change it
  FitStatus status;
};

/// The alternative of a group before its fit: the group by itself, or added to `on_top_of`, which was fitted already.
[[nodiscard]] Alternative unfitted_alternative(const ParameterGroup& group, const ScreenedCandidate& screened, const Alternative* on_top_of);

/// Distance of an alternative's number from its off value in its standard deviations; 0 of a number without standard deviation, and of a shape.
[[nodiscard]] double deviations_from_off(const Alternative& a, const Estimate& number, std::span<const ParameterGroup> groups);

/// The number of a group, or its shape, that an alternative's estimate is of; null where no group has one.
[[nodiscard]] const AddedParameter* added_parameter_of(const Alternative& a, const Estimate& number, std::span<const ParameterGroup> groups);
[[nodiscard]] const AddedParameter* shape_of(const Alternative& a, const Estimate& number, std::span<const ParameterGroup> groups);

}  // namespace calomel
