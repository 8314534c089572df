#include "apps/inputs/posterior_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <tuple>

#include "apps/inputs/posterior_case.hpp"
#include "apps/interrupt.hpp"
#include "forward/mesh/mesh_extent.hpp"
#include "inverse/posterior/direct_start.hpp"
#include "inverse/data/decimation.hpp"

namespace calomel {

namespace {

/// Times of the errors are no shorter than the distance of the values compared. Those of a model outside for which the case says nothing become that; of a line
/// the defaults are a target's, and a pipe's times are a thousand times longer. Errors: InputError for times that are too short.
void hold_times_to_the_records(PosteriorInputs& in, const StudyCase& study) {
  const Decimation grid(in.problem, std::size_t(in.errors.values), in.errors.band);
  const auto windows = grid.windows(0);
  const double apart =
      windows.size() > 1 ? windows[1].time - windows[0].time : in.problem.time.back() - in.problem.time.front();  // one value stands for the record
  if (study.external && !study.file.has("errors.discrepancy_times"))
    for (auto& time : in.errors.discrepancy_times) time = std::max(time, apart);
  if (study.external && !study.file.has("errors.amplitude_time")) in.errors.amplitude_time = std::max(in.errors.amplitude_time, apart);
  const auto expect_above = [&](const char* key, double time) {
    if (time < apart)
      throw InputError(
          {.problem = fmt::format("values of a record are compared {} s apart, and this is shorter", number_text(apart)),
           .key = key,
           .value = number_text(time),
           .suggestion = study.external
                             ? "give times of the records' own scale"
                             : "give times of the line's own scale, some of them near the time that a wave takes through it, or a higher errors.band"});
  };
  expect_above("errors.discrepancy_times", *std::max_element(in.errors.discrepancy_times.begin(), in.errors.discrepancy_times.end()));
  expect_above("errors.amplitude_time", in.errors.amplitude_time);
}

/// Least and greatest coordinates of the whole target, mirror images included, (2, 3) [m]; NaN across a slice.
Eigen::MatrixXd outermost(const Mesh& mesh) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  Eigen::MatrixXd planes(2, 3);
  for (int axis = 0; axis < 3; ++axis) std::tie(planes(0, axis), planes(1, axis)) = extent(mesh, std::size_t(axis));
  for (const auto& m : mesh.mirrors) planes(m.above ? 0 : 1, m.axis) = 2 * m.at - planes(m.above ? 1 : 0, m.axis);  // a gauge may sit on the mirror image
  if (mesh.plane_strain) planes.col(1).setConstant(none);
  return planes;
}

/// What does not depend on where the runs come from.
std::unique_ptr<PosteriorInputs> without_runs(const StudyCase& study, const Problem& problem, const Recordings& recordings,
                                              const RecordingOptions& recording_options, const CommandLine& command) {
  std::unique_ptr<PosteriorInputs> out(new PosteriorInputs{
      .problem = problem, .recordings = recordings, .recording_options = recording_options, .errors = study.errors, .emulator = study.emulator});
  PosteriorInputs& in = *out;
  in.parameters = posterior_parameters(study), in.seed = command.seed;
  in.places.positions = gauge_positions(study), in.discrepancy = study.map.product == "physical";
  return out;
}

}  // namespace

std::unique_ptr<PosteriorInputs> posterior_inputs(const PosteriorParts& parts, const CommandLine& command, const RunStore::Progress& told) {
  auto out = without_runs(parts.study, parts.problem, parts.recordings, parts.recording_options, command);
  PosteriorInputs& in = *out;
  LevelRuns* runs = &parts.runs;
  const int threads = command.threads;
  in.places.outermost = outermost(runs->model(0).mesh()), in.mesh = mesh_error(parts.study, runs->model(0).mesh().liquid_element_size);
  in.levels = runs->levels(), in.pulses = parts.study.campaign.pulses, in.energy_sd = parts.study.campaign.pulse_energy_sd;
  in.run = [=](const Eigen::MatrixXd& thetas, const std::vector<int>& level) { return runs->run(thetas, level, threads, told, &stop_requested()); };
  if (const double sd = parts.study.errors.gauge_place_sd; sd > 0)
    in.gauge_places = [=](std::span<const double> theta) { return runs->gauge_places(theta, sd, threads, told, &stop_requested()); };
  return out;
}

std::unique_ptr<PosteriorInputs> posterior_inputs_without_start(StudyInputs& inputs) {
  const CommandLine& command = inputs.command();
  auto out = without_runs(inputs.study(), inputs.problem(), inputs.recordings(), *inputs.study().recordings, command);
  PosteriorInputs& in = *out;
  in.mesh = mesh_error(inputs.study(), 0);
  if (in.parameters.empty())
    throw InputError({.problem = "the base model has no numbers that may move, so that whatever is off by a little looks like physics left out",
                      .key = "parameter",
                      .suggestion = "add [parameter.*] tables with priors, such as the wave speed and the clock of a station"});
  hold_times_to_the_records(in, inputs.study());
  NumberedRuns* runs = &inputs.numbered_runs();
  const int threads = command.threads;
  in.levels = 1, in.draw_in = true;
  in.errors.arrival_share = in.errors.arrival_share.value_or(0);
  in.run = [=](const Eigen::MatrixXd& thetas, const std::vector<int>&) { return runs->run(thetas, {}, threads, {}, &stop_requested()); };
  return out;
}

/// Between two runs of nearly one point, in standard errors of the records together: with more, least squares by finite differences lose their way.
constexpr double most_jitter = 1;

std::unique_ptr<PosteriorInputs> posterior_inputs_of_a_quick_model(StudyInputs& inputs) {
  auto out = posterior_inputs_without_start(inputs);
  PosteriorInputs& in = *out;
  if (inputs.study().external) {
    for (const auto& p : in.parameters)
      if (p.prior == "uniform")
        in.warnings.push_back(
            fmt::format("{} has a uniform prior: it can imitate what the model leaves out; give it the prior of what is known of it", p.name));
    const Jitter jitter = jitter_of_the_model(in).value_or(Jitter{});
    if (jitter.standard_errors < most_jitter) {
      start_directly(in);
      in.least_squares = true;
      return out;
    }
    in.warnings.push_back(
        fmt::format("the model does not repeat itself: two runs at nearly one point differ by {:.2g} standard errors of the records; it is fitted by an "
                    "emulator that takes this for noise. If it chooses its steps itself or stops an iteration early, fix the steps or tighten the tolerance",
                    jitter.standard_errors));
    in.jitter = jitter.variance;
  }
  for (const auto& p : in.parameters) in.centre.push_back(*p.nominal), in.half_width.push_back(first_half_width_of_a_line(p));
  return out;
}

std::unique_ptr<PosteriorInputs> posterior_inputs(StudyInputs& inputs, const RunStore::Progress& told) {
  const auto& study = inputs.study();
  return posterior_inputs(
      {.study = study, .runs = inputs.levels(), .problem = inputs.problem(), .recordings = inputs.recordings(), .recording_options = *study.recordings},
      inputs.command(), told);
}

std::vector<double> fine_run(const PosteriorInputs& in, std::vector<double> theta) {
  for (std::size_t k = theta.size(); k < in.parameters.size(); ++k) theta.push_back(*in.parameters[k].nominal);
  const auto record = in.run(Eigen::Map<const Eigen::MatrixXd>(theta.data(), Eigen::Index(theta.size()), 1), {0})[0];
  return {record.mean.begin(), record.mean.end()};
}

void put_first_box(PosteriorInputs& in, std::span<const double> basin) {
  in.centre.clear(), in.half_width.clear();
  for (std::size_t k = 0; k < in.parameters.size(); ++k) {
    const bool nuisance = k >= basin.size();
    in.centre.push_back(nuisance ? *in.parameters[k].nominal : basin[k]);
    in.half_width.push_back(first_half_width(in.parameters[k], nuisance));
  }
}

}  // namespace calomel
