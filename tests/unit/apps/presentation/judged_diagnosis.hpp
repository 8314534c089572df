#pragma once
/// Diagnoses that were judged from given evidences, for the words about them.
#include <algorithm>
#include <string>
#include <vector>

#include "uq/diagnosis/diagnosis.hpp"

namespace calomel {

inline AddedParameter number_of(const std::string& name, const std::string& unit, double off, const std::string& doc) {
  AddedParameter a;
  a.parameter = {.name = name, .key = "mechanism." + name, .min = -1, .max = 1};
  a.parameter.nominal = off;
  a.unit = unit;
  a.doc = doc;
  return a;
}

inline std::vector<ParameterGroup> judged_groups() {
  AddedParameter filter = number_of("sensor_response.low_pass", "Hz", 0, "-3 dB frequency");
  filter.inverse = true;
  return {{.name = "beam_profile",
           .added = {number_of("beam_profile.offset_z", "m", 0, "of the axis, upwards"), number_of("beam_profile.width_ratio_z", "", 1, "of the width")},
           .plain = "the proton beam's profile",
           .check = "compare it with the beam monitors"},
          {.name = "wall_thinning",
           .place = "top",
           .added = {number_of("wall_thinning.fraction", "", 0, "of the thickness that is gone")},
           .plain = "a wall that is thinner than drawn",
           .check = "measure that wall"},
          {.name = "sensor_response",
           .added = {number_of("sensor_response.gain", "", 1, "reading per true strain"), filter},
           .by_sensor = true,
           .plain = "the response of the gauges",
           .check = "check the gauges"},
          {.name = "numerics", .added = {number_of("numerics.hourglass", "", 0, "")}, .numerical = true, .plain = "the simulation's own discretisation"},
          {.name = "novel", .added = {number_of("novel.strength", "", 0, "")}}};
}

/// An effect that passes every gate.
inline Alternative beam() {
  Alternative a;
  a.explanation = {.name = "beam_profile",
                   .log_bayes_factor = 106,
                   .by_scale = {{0, 0.5, 108}, {0.08, 0.5, 98}},
                   .chi2 = 70,
                   .misfit = 0.05,
                   .farthest = 1,
                   .base_prior_deviation = 0.3,
                   .fitted = true};
  a.groups = {"beam_profile"};
  a.numbers = {{"beam_profile.width_ratio_z", 0.99, 0.02}, {"beam_profile.offset_z", 2.312e-3, 1.61e-4}};
  a.held_out = {0.12, 0.06};
  return a;
}

/// An effect that explains little.
inline Alternative wall(double log_bayes_factor) {
  Alternative a;
  a.explanation = {.name = "wall_thinning",
                   .log_bayes_factor = log_bayes_factor,
                   .by_scale = {{0, 0.5, log_bayes_factor - 1}, {0.08, 0.5, log_bayes_factor - 0.5}},
                   .chi2 = 300,
                   .misfit = 0.08,
                   .base_prior_deviation = 1,
                   .fitted = true};
  a.groups = {"wall_thinning"};
  a.places = {{"wall_thinning", "top"}};
  a.numbers = {{"wall_thinning.fraction", 0.12, 0.04}};
  return a;
}

/// A number of the discretisation that explains as much as the beam, less this log Bayes factor.
inline Alternative numerics(double behind = 0) {
  Alternative a = beam();
  a.explanation.name = "numerics";
  a.groups = {"numerics"};
  a.explanation.numerical = true;
  a.explanation.log_bayes_factor -= behind;
  for (auto& s : a.explanation.by_scale) s.log_evidence -= behind;
  return a;
}

/// A judged diagnosis, all fits of which have settled; the base model's chi-squared is 400 for 100 values.
inline Diagnosis judged(std::vector<Alternative> candidates, double base_chi2 = 400) {
  for (auto& c : candidates) c.settled = true;
  Diagnosis d;
  d.base.fit.settled = true;
  d.base.evidence = {
      .values = 100, .chi2 = base_chi2, .misfit = 0.1, .held_out = 0.1, .by_scale = {{0, 0.5, -1}, {0.08, 0.5, -0.5}}, .base_prior_deviation = 0.5};
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.explanation.log_bayes_factor > b.explanation.log_bayes_factor; });
  d.candidates = std::move(candidates);
  std::vector<Explanation> all;
  for (const auto& c : d.candidates) all.push_back(c.explanation);
  d.verdict = judge(d.base.evidence, all);
  d.location.first_sensor = "S03";
  d.location.first_time = 120e-6;
  d.separating = SeparatingMeasurement{
      .first = "beam_profile", .second = "wall_thinning", .gauge = "S07", .time = 210e-6, .difference = 3.2, .unit = "microstrain", .standard_deviations = 4.6};
  d.misfits = {.before = 0.112, .after = 0.053, .held_out_before = 0.121, .held_out_after = 0.0604};
  return d;
}

}  // namespace calomel
