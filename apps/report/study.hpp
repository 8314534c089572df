#pragma once
/// The artefacts of an output directory as the report reads them: what is there, and nothing where a stage has not run.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "uq/draws.hpp"

namespace calomel {

/// Time histories of a calibration (METHOD.nc) or of one simulation (simulate.nc), in the data's unit.
/// Arrays are (condition, sensor, time) or (condition, sensor, record_time), row-major; empty where the file has none.
struct Histories {
  std::vector<std::string> conditions, sensors;
  std::vector<double> time, record_time;                                   ///< [s]
  std::vector<double> calibrated, nominal;                                 ///< over `time`
  std::vector<double> record_mean, band_low, band_high;                    ///< over `record_time`
  std::vector<double> base, explained, held_out_base, held_out_explained;  ///< over `time`, of diagnosis.nc
  /// Of posterior.nc, over `record_time`: mean of the histories at its draws; what 90 % of them lie between; and, where the errors between a history and a
  /// record are told, what 90 % of the records predicted by draws and errors lie between.
  std::vector<double> predicted, draws_low, draws_high, predicted_low, predicted_high;
};

struct CalibrationArtefacts {
  std::string method;  ///< "enc", "spe", "map"
  std::string label;   ///< "ENC", ...
  Json summary;        ///< METHOD.json
  std::optional<Histories> histories;
};

/// campaign.nc without its histories.
struct CampaignRuns {
  std::vector<std::string> parameters, sensors;
  std::vector<double> theta;  ///< (run, parameter)
  std::vector<int> status;    ///< (run), 0 = done
  std::vector<std::string> status_words;
  std::vector<std::string> message;  ///< (run)
  std::vector<double> scatter;       ///< (sensor): root mean square over runs, conditions and times of the scatter between pulses [data's unit]; or empty
  [[nodiscard]] std::size_t runs() const { return status.size(); }
};

struct DiagnosisArtefacts {
  Json summary;                        ///< diagnosis.json
  std::optional<Histories> histories;  ///< diagnosis.nc, where it is of the same identity
  std::string explanation;             ///< whose histories `explained` are; empty where there are none
};

struct SensitivityArtefacts {
  Json summary;  ///< sensitivity.json
  /// sensitivity.nc, where it is of the same identity; else empty. Arrays are (condition, sensor, time), indices (condition, sensor, time, parameter).
  std::vector<std::string> conditions, sensors, parameters;
  std::vector<double> time;                      ///< [s]
  std::vector<double> sd;                        ///< of the values [data's unit]
  std::vector<double> first_order, total_order;  ///< [-], NaN where a value does not vary
};

/// A unit in which the page shows numbers, and the factor to it from the artefacts' unit.
struct DisplayUnit {
  std::string name;
  double factor;
};
/// Of times up to `end` [s]: microseconds up to 20 ms, milliseconds up to 20 s, else seconds.
DisplayUnit time_unit(double end);

struct Study {
  DisplayUnit time = time_unit(0);  ///< of all times
  std::vector<CalibrationArtefacts> calibrations;
  std::optional<Json> campaign, train, simulate;
  Json floor;                                ///< repeatability floor of campaign.json, else of floor.json; null where there is none
  std::optional<Json> optimizer_comparison;  ///< of bench_optimizers
  std::optional<CampaignRuns> runs;
  std::optional<Json> sample;           ///< posterior.json
  std::optional<Draws> posterior;       ///< posterior.nc, its group of that name
  std::optional<Draws> prior;           ///< posterior.nc, its group of that name
  std::optional<Histories> predictive;  ///< posterior.nc, of its groups posterior_predictive and observed_data
  std::optional<Histories> simulation;  ///< simulate.nc, its strain as `nominal`
  std::optional<DiagnosisArtefacts> diagnosis;
  std::optional<SensitivityArtefacts> sensitivity;

  [[nodiscard]] const CalibrationArtefacts* calibration(const std::string& method) const;
  /// No artefact of any stage was there.
  [[nodiscard]] bool empty() const {
    return calibrations.empty() && !campaign && !train && !simulate && floor.is_null() && !optimizer_comparison && !runs && !simulation && !sample &&
           !posterior && !diagnosis && !sensitivity;
  }
};

/// time_end: of the simulation [s], which decides in which unit times are shown. Errors: InputError naming a file that is there but cannot be read.
Study read_study(const std::filesystem::path& out_dir, double time_end = 0);

/// The number at `key`, when `json` is an object that has one.
std::optional<double> number_at(const Json& json, const std::string& key);
/// The text at `key`, or `otherwise`.
std::string text_at(const Json& json, const std::string& key, const std::string& otherwise = "");
/// The list at `key`, or an empty one.
const Json& list_at(const Json& json, const std::string& key);
/// The object or list at `key`, or null.
const Json& part_at(const Json& json, const std::string& key);

}  // namespace calomel
