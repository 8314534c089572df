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

/// A calibration as its METHOD.json describes it.
struct MethodSummary {
  std::string method;  ///< "enc", "spe", "map"
  Json json;
};

/// One row of a table; nothing where an artefact does not say.
struct ComparedRow {
  std::string name;  ///< a parameter, "impedance" (rho c), a sensor, or "mean"
  std::optional<double> nominal;
  std::vector<std::optional<double>> values;  ///< (n_methods)
  std::optional<double> map_sd{};             ///< MAP's standard deviation; of parameters and impedance only
};

/// Difference of two methods' answers in one row.
struct ComparedDifference {
  std::string name;
  std::optional<double> absolute;   ///< second less first
  std::optional<double> percent;    ///< of the first
  std::optional<double> in_map_sd;  ///< in units of MAP's standard deviation
};

struct ComparedPair {
  std::string first, second;
  std::vector<ComparedDifference> differences;  ///< as Comparison::parameters
  std::optional<double> largest_in_map_sd;      ///< of them, by absolute value
};

/// Where the answer of a method lies in the posterior, by MAP's mode and covariance over the case's parameters (Laplace).
struct PlaceInPosterior {
  std::string method;
  std::optional<double> distance;      ///< Mahalanobis distance d = sqrt((theta - mode)^T C^-1 (theta - mode)) [-]; nothing where a parameter is missing
  std::optional<double> share_nearer;  ///< share of the posterior that lies nearer to the mode: P(chi-squared of n parameters < d^2)
  /// Whether it lies outside the posterior.
  [[nodiscard]] bool outside() const;
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
  std::string scores_on;  ///< mesh of accuracy and mae as artefacts name it, artefact_name(ScoredMesh); empty where all are on the case's own mesh
  std::vector<ComparedPair> pairs;
  std::vector<PlaceInPosterior> in_posterior;  ///< of every method but MAP; empty without MAP's covariance
  std::vector<ComparedEffort> effort;
  bool agree = false;  ///< every answer lies within the posterior; also false without MAP

  /// A difference of one parameter beyond so many of MAP's standard deviations is pointed out.
  static constexpr double notable_sds = 2;
  /// An answer is called outside the posterior when a greater share of it lies nearer to the mode.
  static constexpr double outside_share = 0.99;
};

/// Rows appear in the order of the first summary that has them; nominal values are those of the first summary that has them.
[[nodiscard]] Comparison compare_calibrations(std::span<const MethodSummary> summaries);

/// The contents of comparison.json. sentence: which answers lie within the posterior, for people.
[[nodiscard]] Json comparison_json(const Comparison& comparison, const std::string& sentence, const Provenance& provenance);

/// "ENC" for "enc".
[[nodiscard]] std::string method_label(const std::string& method);

}  // namespace calomel
