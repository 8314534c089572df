#pragma once
/// The first step of a diagnosis: the fit of the base model, and all that is known from it alone.
#include <string>
#include <vector>

#include "uq/diagnosis/alternative.hpp"
#include "uq/diagnosis/diagnosis_inputs.hpp"
#include "uq/diagnosis/mislabelled_channels.hpp"
#include "uq/diagnosis/run_budget.hpp"
#include "uq/diagnosis/verdict.hpp"

namespace calomel {

struct BaseFit {
  PosteriorFit fit;
  BaseEvidence evidence;                        ///< `held_out` is set by the hold-out step
  std::vector<std::string> likeliest_place;     ///< gauges, one or two, of the place with the greatest evidence; empty: the gauges have no places
  std::vector<Estimate> parameters;             ///< the case's own
  std::vector<double> prior_deviations;         ///< of these at the mode, in prior standard deviations
  std::vector<double> history;                  ///< (values of the model) at the mode
  std::vector<MislabelledChannel> mislabelled;  ///< mixed-up channels: no mechanism is screened then
  Eigen::MatrixXd place_changes;                ///< changes by one sd of each gauge's place at the mode, (values, gauges); empty: none

  [[nodiscard]] const LocalMode& mode() const { return fit.modes[0]; }
  [[nodiscard]] const Decimation& grid() const { return fit.errors->grid(); }
  /// Whether the base model does not explain the records within their errors.
  [[nodiscard]] bool inadequate() const { return evidence.chi2 > greatest_plausible(evidence); }
};

/// Fits the base model; ends early where channels are surely mixed up, for such records lead a fit astray. Errors: those of fit_posterior and of the runs.
[[nodiscard]] BaseFit fit_base(const DiagnosisInputs& in, RunBudget& budget);

}  // namespace calomel
