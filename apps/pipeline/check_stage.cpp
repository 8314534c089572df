#include "apps/pipeline/check_stage.hpp"

#include <cmath>
#include <iostream>

#include "apps/pipeline/floor_stage.hpp"
#include "apps/pipeline/stage_call.hpp"
#include "apps/presentation/case_lines.hpp"
#include "base/json.hpp"
#include "forward/campaign/repeatability.hpp"
#include "inverse/posterior/emulator_meshes.hpp"

namespace calomel {

namespace {

constexpr double on_the_finer = 1.0 / 6;  ///< of a diagnosis' runs, as the suites of docs/proof/challenge.md made them

/// The work of a mean on elements of this size, over one on the case's own: as many more elements and steps.
double work_ratio(double size, double own, const RunCost& cost) { return std::pow(own / size, cost.refinement_exponent); }

/// The runs that the emulator begins with, in means of the case's own mesh.
double posterior_work(const StudyCase& study, const std::vector<double>& sizes, double own, const RunCost& cost) {
  const auto d = Eigen::Index(posterior_parameters(*study.simulator, study.posterior_settings()).size());
  double work = study.emulator.finest_to_begin(d, int(sizes.size())) * work_ratio(sizes.back(), own, cost);
  for (std::size_t l = 0; l + 1 < sizes.size(); ++l) work += study.emulator.coarser_to_begin(d) * work_ratio(sizes[l], own, cost);
  return work;
}

/// The most work of a diagnosis.
double diagnosis_work(const StudyCase& study, const std::vector<double>& sizes, double own, const RunCost& cost) {
  const double finest = work_ratio(sizes.back(), own, cost), coarser = work_ratio(sizes.front(), own, cost);
  return study.diagnosis.max_runs * (sizes.size() > 1 ? on_the_finer * finest + (1 - on_the_finer) * coarser : finest);
}

/// On `threads` threads.
StudyCost cost_of(const StudyCase& study, const RunCost& cost, int threads) {
  const Simulator& simulator = *study.simulator;
  const double mean = cost.mean_s / threads;
  const bool finer = study.floor.finer_mesh && finer_is_small_enough(study.floor, cost);
  const auto own = simulator.hints().element_size;
  const bool compared = study.recordings && own;
  return {.run = cost.run_s / cost.run_gain,
          .campaign = double(study.campaign.runs) * mean,
          .floor = floor_cost(study.floor, cost.refinement_exponent, finer, cost.run_s / cost.mean_s) * mean,
          .posterior = compared ? mean * posterior_work(study, element_sizes(simulator, study.emulator), *own, cost) : 0,
          .diagnosis = compared ? mean * diagnosis_work(study, diagnosis_element_sizes(simulator, study.emulator), *own, cost) : 0};
}

}  // namespace

ExitStatus check_stage(StageCall& call) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  const auto& study = inputs.study();
  const Simulator& simulator = inputs.simulator();
  refuse(command.floor && !study.capabilities().numerics, "--floor", "the repeatability floor is that of a model on a mesh");
  const Description description = study.file.locating([&] { return simulator.describe(command.threads); });
  const Problem* problem = study.recordings ? &inputs.problem() : nullptr;  // what is wrong with the recordings comes before any word of success
  std::optional<StudyCost> cost;
  if (description.cost) cost = cost_of(study, *description.cost, command.threads);
  const auto lines = plan_lines({.study = study, .model = description, .problem = problem, .cost = cost, .threads = command.threads});
  if (command.resolved) std::cout << study.echo().dump(2) << '\n';
  command.resolved ? inputs.notes().say(lines) : Notes(std::cout, false).say(lines);
  std::cout.flush();
  inputs.notes().warn(description.warnings);
  for (const auto& n : description.notes) inputs.notes().say("note: " + n);
  if (!command.write_mesh.empty()) {
    simulator.write_mesh(command.write_mesh);
    inputs.notes().say(mesh_written_line(command.write_mesh));
  }
  if (command.floor) floor_stage(call);
  return ExitStatus::done;
}

}  // namespace calomel
