#pragma once
#include <memory>

#include "forward/campaign/campaign.hpp"
#include "inverse/map/map.hpp"
#include "tests/unit/inverse/lines.hpp"

namespace calomel {

/// A fit of records by an analytic model on one mesh, with its inputs.
struct Fitted {
  const ForwardModel& model;
  Recordings recordings;
  RecordingOptions recording;
  Problem problem = make_problem(model.shape(), recordings, recording);
  PosteriorInputs in{.problem = problem, .recordings = recordings, .recording_options = recording};
  PosteriorFit fit{};

  Fitted(const ForwardModel& m, Recordings r, RecordingOptions options = {}) : model(m), recordings(std::move(r)), recording(std::move(options)) {
    in.errors = {.values = 120, .band = 1e9, .energy_scale_sd = 0, .gain_sd = 0, .baseline = 0, .coherent_noise = 0, .record_noise = 0};
    in.parameters = problem.shape.parameters;
    in.run = [this](const Eigen::MatrixXd& thetas, const std::vector<int>& level) {
      std::vector<RunRecord> records;
      for (std::size_t i = 0; i < level.size(); ++i)
        records.push_back(evaluate_run(model, {thetas.col(Eigen::Index(i)).data(), std::size_t(thetas.rows())}, false));
      return records;
    };
  }
  Fitted(const Fitted&) = delete;  // `in` refers to the other members

  /// A box about `centre`, half as wide as given, in the logarithm where the lower bound is positive.
  MapSummary map(std::vector<double> centre, std::vector<double> half_width, const std::vector<MechanismDirections>& left_out = {},
                 const NestedModel* nested = nullptr) {
    in.centre = std::move(centre);
    in.half_width = std::move(half_width);
    fit = fit_posterior(in);
    std::function<std::vector<MechanismDirections>(std::span<const double>)> directions;
    if (!left_out.empty()) directions = [&](std::span<const double>) { return left_out; };
    return run_map(in, fit, in.discrepancy ? "physical" : "tuned", directions, nested);
  }
};

}  // namespace calomel
