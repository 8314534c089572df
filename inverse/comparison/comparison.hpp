#pragma once
/// Calibrations of one case side by side, as the seed paper's three tables have them, and how far their answers lie apart.
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "base/options.hpp"

namespace calomel {

struct Provenance;  // base/provenance.hpp

/// A calibration as its METHOD.json tells it.
struct MethodSummary {
  std::string method;  ///< "enc", "spe", "map"
  Json json;
};

/// One row of a table; nothing where an artefact does not tell.
struct ComparedRow {
  std::string name;  ///< a parameter, "impedance" (rho c), a sensor, or "mean"
  std::optional<double> nominal;
  std::vector<std::optional<double>> values;  ///< (n_methods)
  std::vector<std::optional<double>> sds{};    ///< (n_methods) what each reports; of parameters and impedance only
  std::optional<double> map_sd{};              ///< MAP's
};

/// Difference of two methods' answers in one row.
struct ComparedDifference {
  std::string name;
  std::optional<double> absolute;   ///< second less first
  std::optional<double> percent;    ///< of the first
  std::optional<double> in_map_sd;  ///< in units of MAP's standard deviation
  std::optional<double> in_own_sds{};  ///< in units of those that the two report, added in squares
};

struct ComparedPair {
  std::string first, second;
  std::vector<ComparedDifference> differences;  ///< as Comparison::parameters
  std::optional<double> largest_in_map_sd;      ///< of them, by absolute value
};

struct ComparedEffort {
  std::string method;
  std::optional<double> evaluations;        ///< of the surrogate
  std::optional<double> model_runs;         ///< of the true model, beside the campaign
  std::optional<double> search_s, model_s;  ///< [s]
  [[nodiscard]] std::optional<double> evaluations_per_second() const;
};

struct Comparison {
  std::vector<std::string> methods;
  std::vector<ComparedRow> parameters;  ///< in declared order, the impedance last where density and sound speed are both calibrated
  std::vector<ComparedRow> accuracy;    ///< [%] by sensor, the mean last
  std::vector<ComparedRow> mae;         ///< by sensor, the mean last
  std::string mae_unit;
  std::string scores_on;                ///< what accuracy and mae belong to: "the case's own mesh", another one where all methods tell of the same, or ""
  std::vector<ComparedPair> pairs;
  std::vector<ComparedEffort> effort;
  bool agree = false;    ///< every difference lies within `agreement_sds`; false, too, where there is no MAP to tell
  std::string sentence;  ///< which answers agree, and by what the others miss

  /// Differences beyond so many of MAP's standard deviations are called disagreement.
  static constexpr double agreement_sds = 2;
};

/// Rows appear in the order of the first summary that has them; nominal values are those of the first summary that tells them.
[[nodiscard]] Comparison compare_calibrations(std::span<const MethodSummary> summaries);

/// The contents of comparison.json.
[[nodiscard]] Json comparison_json(const Comparison& comparison, const Provenance& provenance);
/// The tables in plain text, numbers aligned, for a terminal.
[[nodiscard]] std::string comparison_text(const Comparison& comparison);

/// "ENC" for "enc".
[[nodiscard]] std::string method_label(const std::string& method);

}  // namespace calomel
