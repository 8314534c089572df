#pragma once
/// Four gauges whose records have a gain, an energy and a clock that their model does not know.
#include <algorithm>
#include <cmath>
#include <vector>

#include "inverse/posterior/posterior_fit.hpp"
#include "tests/unit/inverse/lines.hpp"

namespace calomel {

/// Errors of the records.
struct Spoilt {
  std::size_t gauge = 0;
  double gain = 1;    ///< gain of that gauge
  double energy = 1;  ///< of all pulses
  double late = 0;    ///< of all records [s]
};

/// The model with one parameter, its records, and its fit to them.
struct FourGauges {
  std::vector<Parameter> parameters{normal_parameter("rate", 1, 0.02)};
  AnalyticModel known{model(parameters, {})};
  Recordings recordings;
  RecordingOptions recording_options;
  Problem problem{make_problem(known.shape(), recordings, recording_options)};
  PosteriorInputs inputs{.problem = problem,
                         .recordings = recordings,
                         .recording_options = recording_options,
                         .errors = {.values = 160, .band = 2e5, .young_sd = 0, .beyond_sd = 0},
                         .emulator = {}};
  PosteriorFit fit;

  explicit FourGauges(const Spoilt& spoilt) : recordings(pulses_of(model(parameters, spoilt), {1.01}, {.pulses = 10, .noise = 2, .noise_time = 3e-6}, 5)) {
    inputs.parameters = parameters;
    inputs.levels = 1;
    inputs.centre = {1};
    inputs.half_width = {0.06};
    inputs.run = [this](const Eigen::MatrixXd& thetas, const std::vector<int>& level) {
      std::vector<RunRecord> all;
      for (std::size_t i = 0; i < level.size(); ++i) {
        const auto mean = known.evaluate(std::vector<double>{thetas(0, Eigen::Index(i))}).mean;
        all.push_back({.done = true, .mean = {mean.begin(), mean.end()}});
      }
      return all;
    };
    fit = fit_posterior(inputs);
  }
  FourGauges(const FourGauges&) = delete;
  FourGauges& operator=(const FourGauges&) = delete;

  static AnalyticModel model(const std::vector<Parameter>& parameters, const Spoilt& spoilt) {
    std::vector<AnalyticModel::Function> all;
    for (std::size_t g = 0; g < 4; ++g)
      all.emplace_back([=](auto p, double t) {
        const double since = std::max(0.0, t - spoilt.late);
        return spoilt.energy * (g == spoilt.gauge ? spoilt.gain : 1) * 100 * std::sin(p[0] * 6e4 * since + 0.4 * double(g)) * std::exp(-since / 1e-4);
      });
    return {parameters, all, 200, 1e-6};
  }
};

}  // namespace calomel
