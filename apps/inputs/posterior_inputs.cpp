#include "apps/inputs/posterior_inputs.hpp"

#include "apps/inputs/posterior_case.hpp"
#include "apps/interrupt.hpp"

namespace calomel {

std::unique_ptr<PosteriorInputs> posterior_inputs(const PosteriorParts& parts, const CommandLine& command, const RunStore::Progress& told) {
  const StudyCase& study = parts.study;
  std::unique_ptr<PosteriorInputs> out(
      new PosteriorInputs{.problem = parts.problem, .recordings = parts.recordings, .recording_options = parts.recording_options, .errors = study.errors, .emulator = study.emulator});
  PosteriorInputs& in = *out;
  LevelRuns* runs = &parts.runs;
  const int threads = command.threads;
  in.parameters = posterior_parameters(study);
  in.levels = runs->levels(), in.seed = command.seed;
  in.positions = gauge_positions(study), in.mesh = mesh_error(study), in.discrepancy = study.map.product == "physical";
  in.run = [=](const Eigen::MatrixXd& thetas, const std::vector<int>& level) { return runs->run(thetas, level, threads, told, &stop_requested()); };
  if (const double sd = study.errors.gauge_place_sd; sd > 0)
    in.gauge_places = [=](std::span<const double> theta) { return runs->gauge_places(theta, sd, threads, told, &stop_requested()); };
  return out;
}

std::unique_ptr<PosteriorInputs> posterior_inputs(StudyInputs& inputs, const RunStore::Progress& told) {
  const auto& study = inputs.study();
  return posterior_inputs({.study = study, .runs = inputs.levels(), .problem = inputs.problem(), .recordings = inputs.recordings(), .recording_options = *study.recordings}, inputs.command(), told);
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
