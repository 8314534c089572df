#pragma once
/// A single record of an exact model, for the diagnosis and for hold-out predictions.
#include <cmath>

#include "tests/unit/uq/experiment.hpp"

namespace calomel {

/// One record of a pulse that runs far. The model is exact and costs nothing, and its parameters shift the record by many standard deviations. The pulse has
/// late oscillations where the dispersion is not 0; a lag competes with it.
struct Traveller {
  std::vector<Parameter> parameters{handbook("speed", 1, 0.02), handbook("gain", 1, 0.02)};
  static double signal(double t, double speed, double gain, double dispersion, double lag) {
    const double s = 1e6 * t - 60 / speed, w = 8 + lag;
    const double front = 0.5 * (1 + std::tanh(s / w)), tail = s > -20 ? std::sin(0.9 * s / (1 + 3 * dispersion)) * std::exp(-std::pow((s - 12) / 14, 2)) : 0;
    return gain * (front + dispersion * tail);
  }
  AnalyticModel model;
  Recordings recordings;
  RecordingOptions options;
  Problem problem;
  explicit Traveller(double dispersion)
      : model(parameters, {[=](auto p, double t) { return signal(t, p[0], p[1], dispersion, 0); }}, 120, 1e-6, "V"),
        recordings(pulses_of(model, {1.013, 0.99}, {.pulses = 1, .noise = 1e-3}, 3)),
        options(noise()),
        problem(make_problem(model.shape(), recordings, options)) {}
  static RecordingOptions noise() {
    RecordingOptions o;
    o.unit = "V";
    o.noise = 1e-3;
    return o;
  }
  [[nodiscard]] Diagnosis diagnosed() const {
    PosteriorInputs base{.problem = problem, .recordings = recordings, .recording_options = options, .errors = {.values = 120, .band = 5e5}, .emulator = {}};
    base.parameters = parameters;
    base.levels = 1;
    base.discrepancy = true;
    base.box.kind = BoxStrategy::Kind::shrink;
    base.centre = {1, 1};
    base.half_width = {0.04, 0.04};
    AddedParameter dispersion = added("dispersion", "strength", 0, 0.4, {0.1}), lag = added("lag", "time", 0, 8, {2});
    const DiagnosisInputs in{.base = base,
                             .groups = {{.name = "dispersion", .added = {dispersion}}, {.name = "lag", .added = {lag}}},
                             .run =
                                 [](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> a) {
                                   std::vector<RunRecord> all(level.size());
                                   for (std::size_t i = 0; i < level.size(); ++i) {
                                     const auto theta = thetas.col(Eigen::Index(i));
                                     double by_dispersion = 0, by_lag = 0;
                                     for (std::size_t k = 0; k < a.size(); ++k)
                                       (a[k].parameter.name == "lag.time" ? by_lag : by_dispersion) = theta[Eigen::Index(2 + k)];
                                     all[i].done = true;
                                     for (int t = 0; t < 120; ++t) all[i].mean.push_back(float(signal(1e-6 * t, theta[0], theta[1], by_dispersion, by_lag)));
                                   }
                                   return all;
                                 },
                             .options = {},
                             .report = {}};
    return diagnose(in);
  }
};

}  // namespace calomel
