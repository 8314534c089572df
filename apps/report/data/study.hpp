#pragma once
/// The artefacts of an output directory as the report reads them. A stage that has not run leaves its member empty.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/report/data/quantities.hpp"
#include "apps/report/data/report_input.hpp"
#include "base/json.hpp"
#include "uq/draws.hpp"

namespace calomel {

/// Time histories of a calibration (METHOD.nc), of one simulation (simulate.nc), of a diagnosis or of a posterior, in the unit of the data.
/// Arrays are (condition, sensor, time) or (condition, sensor, record_time), row-major; an array that the file lacks is empty.
struct Histories {
  std::vector<std::string> conditions;
  std::vector<std::string> sensors;
  std::vector<double> time;         ///< [s]
  std::vector<double> record_time;  ///< [s]

  // Over `time`: simulations of a calibration, then those of diagnosis.nc.
  std::vector<double> calibrated;
  std::vector<double> nominal;
  std::vector<double> base;
  std::vector<double> explained;
  std::vector<double> held_out_base;
  std::vector<double> held_out_explained;

  // Over `record_time`: the records.
  std::vector<double> record_mean;
  std::vector<double> band_low;
  std::vector<double> band_high;

  // Over `record_time`, from posterior.nc: the mean of the histories at its draws and their central 90 %. Where the file has the errors between a history and a
  // record, also the central 90 % of the records that draws and errors together predict.
  std::vector<double> predicted;
  std::vector<double> draws_low;
  std::vector<double> draws_high;
  std::vector<double> predicted_low;
  std::vector<double> predicted_high;
};

/// The artefacts of one calibration.
struct CalibrationArtefacts {
  std::string method;  ///< "enc", "spe", "map"
  std::string label;   ///< "ENC", ...
  Json summary;        ///< METHOD.json
  std::optional<Histories> histories;
};

/// campaign.nc without its histories.
struct CampaignRuns {
  std::vector<std::string> parameters;
  std::vector<std::string> sensors;
  std::vector<double> theta;  ///< (run, parameter)
  std::vector<int> status;    ///< (run), 0 = done
  std::vector<std::string> status_words;
  std::vector<std::string> message;  ///< (run)
  /// (sensor): root mean square over runs, conditions and times of the scatter between pulses [unit of the data]; or empty.
  std::vector<double> scatter;
  [[nodiscard]] std::size_t runs() const { return status.size(); }
};

/// The artefacts of a diagnosis.
struct DiagnosisArtefacts {
  Json summary;                        ///< diagnosis.json
  std::optional<Histories> histories;  ///< diagnosis.nc, when its identity is that of diagnosis.json
  std::string explanation;             ///< name of the explanation that gave the histories `explained`; empty when there are none
};

/// The artefacts of a sensitivity analysis. The arrays come from sensitivity.nc and are empty when its identity is not that of sensitivity.json.
/// Arrays are (condition, sensor, time), indices (condition, sensor, time, parameter).
struct SensitivityArtefacts {
  Json summary;  ///< sensitivity.json
  std::vector<std::string> conditions;
  std::vector<std::string> sensors;
  std::vector<std::string> parameters;
  std::vector<double> time;         ///< [s]
  std::vector<double> sd;           ///< standard deviation of the values [unit of the data]
  std::vector<double> first_order;  ///< [-], NaN where a value does not vary
  std::vector<double> total_order;  ///< [-], the same
};

/// All artefacts of an output directory.
struct Study {
  DisplayUnit time = time_unit(0);  ///< unit of all times on the page
  std::vector<CalibrationArtefacts> calibrations;
  std::optional<Json> campaign;              ///< campaign.json
  std::optional<Json> train;                 ///< train.json
  std::optional<Json> simulate;              ///< simulate.json
  Json floor;                                ///< repeatability floor of campaign.json, else of floor.json; null when neither has one
  std::optional<Json> optimizer_comparison;  ///< optimizer_comparison.json, written by bench_optimizers
  std::optional<CampaignRuns> runs;          ///< campaign.nc
  std::optional<Json> sample;                ///< posterior.json
  std::optional<Draws> posterior;            ///< group "posterior" of posterior.nc
  std::optional<Draws> prior;                ///< group "prior" of posterior.nc
  std::optional<Histories> predictive;       ///< groups "posterior_predictive" and "observed_data" of posterior.nc
  std::optional<Histories> simulation;       ///< simulate.nc, its strain as `nominal`
  std::optional<DiagnosisArtefacts> diagnosis;
  std::optional<SensitivityArtefacts> sensitivity;

  /// The calibration by `method`; null when it has not run.
  [[nodiscard]] const CalibrationArtefacts* calibration(const std::string& method) const;
  /// Whether the directory holds no artefact of any stage.
  [[nodiscard]] bool empty() const;
};

/// Reads the artefacts in `out_dir`. `time_end` is the end of the simulation [s], which decides the unit of times.
/// Errors: InputError that names a file which exists but cannot be read.
Study read_study(const std::filesystem::path& out_dir, double time_end = 0);

/// Names of the parameters: those of the case, else those of the calibrations.
std::vector<std::string> parameter_names(const Study& study, const ReportInput& input);

}  // namespace calomel
