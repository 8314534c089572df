#pragma once
/// A campaign: the model run at every point of a design, saved run by run, resumed after any kill to the same data.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "base/options.hpp"
#include "forward/campaign/design.hpp"
#include "forward/campaign/repeatability_floor.hpp"
#include "forward/model.hpp"
#include "forward/simulation/runs.hpp"

namespace calomel {

struct Provenance;  // base/provenance.hpp

/// `[campaign]` of a case file.
struct CampaignOptions {
  int runs = 150;
  std::string design = "chebyshev";
  int pulses = 8;
  double pulse_energy_sd = 0.015;
  bool keep_pulses = true;
  double allowed_failures = 0.2;
  bool floor = true;

  template <class V>
  void visit(V& v) {
    v("runs", runs, {.range = between(1, 1e6), .doc = "points of the design, each one ensemble mean"});
    v("design", design, {.doc = "where the points lie", .choices = designs().names()});
    v("pulses", pulses,
      {.range = between(1, 64),
       .doc = "pulse energies in each ensemble mean; 1 is a single run. In a slice up to 8 cost about one single run; in three dimensions 4 to 8 cost four to "
              "five, fewer one each"});
    v("pulse_energy_sd", pulse_energy_sd, {.range = between(0, 0.5), .doc = "relative sd of the energy from pulse to pulse"});
    v("keep_pulses", keep_pulses, {.doc = "store the single pulses beside their mean (single precision)"});
    v("allowed_failures", allowed_failures, {.range = between(0, 1), .doc = "share of failed runs above which the campaign is not to be trusted"});
    v("floor", floor, {.doc = "measure the repeatability floor at the end, see [floor], and store it beside the runs"});
  }
};

/// The campaign's share of Provenance::options: all keys on which the runs depend (not allowed_failures, nor floor).
Json identity_options(const CampaignOptions& options);

struct CampaignSummary {
  ExitStatus status = ExitStatus::done;  ///< not_to_be_trusted when the share of failed runs exceeds allowed_failures
  std::string message = "the campaign was not run";
  std::size_t runs = 0;       ///< of the design
  std::size_t completed = 0;  ///< with a prediction
  std::size_t failed = 0;     ///< with a reason why there is none
  std::size_t reused = 0;     ///< completed or failed in an earlier call
  double wall_s = 0;          ///< of this call [s]
};

/// Measures the floor of the campaign's model, or reads it where it was measured; nothing: there is to be none. Errors: NumericsError when there can be none.
using FloorSource = std::function<std::optional<RepeatabilityFloor>()>;

/// Called after every run: runs finished (the reused ones included), how many of them failed, runs of the design.
using CampaignProgress = std::function<void(std::size_t finished, std::size_t failed, std::size_t runs)>;

/// Points of a design in natural units, shape (n_parameters, runs): the unit cube carried to the parameters' bounds.
/// Errors: InputError when there is no parameter, or the design is unknown or has too few dimensions.
Eigen::MatrixXd design_points(const std::string& design, std::span<const Parameter> parameters, std::size_t runs, std::uint64_t seed);

/// Makes the runs of a model of this shape at options.runs points and writes campaign.nc and campaign.json to `directory`. `runs` is called when runs are
/// needed. Runs that the store holds are taken, of another design too. The data do not depend on interruptions or on the number of threads. A run that fails is
/// recorded with its reason. A finished campaign of the same identity is reused.
/// When all runs are finished `floor` is called; its result is stored in both files, and a failure in the message. An archive that exists is not written again:
/// then campaign.json alone gets the floor, and keeps the one that it has when there is no other.
/// `provenance` is of stage "campaign", with this seed and identity_options under "campaign".
/// Errors: InputError when artefacts of other settings exist there (naming the changed keys; nothing is touched), when the disk is full, or from the model;
/// Interrupted when the runs were stopped.
[[nodiscard]] CampaignSummary run_campaign(const ModelShape& shape, const CampaignOptions& options, std::uint64_t seed, const Provenance& provenance,
                                           const std::filesystem::path& directory, const std::function<Runs&()>& runs, const CampaignProgress& progress = {},
                                           const FloorSource& floor = {});

/// --fresh: renames campaign.nc and campaign.json of `directory` to NAME.old-N. The runs remain in their store.
void set_campaign_aside(const std::filesystem::path& directory);

}  // namespace calomel
