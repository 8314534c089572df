#include "apps/pipeline/check_stage.hpp"

#include <cmath>
#include <iostream>

#include "apps/inputs/posterior_case.hpp"
#include "apps/pipeline/external_stages.hpp"
#include "apps/pipeline/floor_stage.hpp"
#include "apps/pipeline/line_stages.hpp"
#include "apps/pipeline/stage_call.hpp"
#include "apps/presentation/case_lines.hpp"
#include "base/json.hpp"
#include "forward/mesh/write_mesh.hpp"
#include "forward/repeatability.hpp"

namespace calomel {

namespace {

constexpr double on_the_finer = 1.0 / 6;  ///< of a diagnosis' runs, as the suites of docs/proof/challenge.md made them

/// Of one ensemble mean on elements of this size, over that on the case's own: as many more elements and steps.
double work_ratio(double size, double own, bool plane_strain) { return std::pow(own / size, plane_strain ? 3 : 4); }

/// Runs of an emulator to begin with, in ensemble means of the case's own mesh.
double posterior_work(const StudyCase& study, const std::vector<double>& sizes, double own, bool plane_strain) {
  const auto d = Eigen::Index(posterior_parameters(study).size());
  double work = study.emulator.finest_to_begin(d, int(sizes.size())) * work_ratio(sizes.back(), own, plane_strain);
  for (std::size_t l = 0; l + 1 < sizes.size(); ++l) work += study.emulator.coarser_to_begin(d) * work_ratio(sizes[l], own, plane_strain);
  return work;
}

/// At most that many of a diagnosis.
double diagnosis_work(const StudyCase& study, const std::vector<double>& sizes, double own, bool plane_strain) {
  const double finest = work_ratio(sizes.back(), own, plane_strain), coarser = work_ratio(sizes.front(), own, plane_strain);
  return study.diagnosis.max_runs * (sizes.size() > 1 ? on_the_finer * finest + (1 - on_the_finer) * coarser : finest);
}

/// On `threads` threads.
StudyCost cost_of(const StudyCase& study, const BuiltInModel& model, const ModelDescription& d, int threads) {
  const double conditions = double(model.shape().conditions.size()), mean = d.estimated_mean_seconds / threads;
  const bool finer = study.floor.finer_mesh && finer_is_small_enough(study.floor, model.mesh());
  const auto own = study.forward.geometry.resolved().element_size;
  const bool compared = study.recordings && own, plane = model.mesh().plane_strain;
  return {.run = conditions * d.estimated_seconds / d.run_gain,
          .campaign = double(study.campaign.runs) * conditions * mean,
          .floor = conditions * floor_cost(study.floor, model.mesh().plane_strain, finer, d.estimated_seconds / d.estimated_mean_seconds) * mean,
          .posterior = compared ? conditions * mean * posterior_work(study, element_sizes(study), *own, plane) : 0,
          .diagnosis = compared ? conditions * mean * diagnosis_work(study, diagnosis_element_sizes(study), *own, plane) : 0};
}

}  // namespace

ExitStatus check_stage(StageCall& call) {
  auto& inputs = call.inputs;
  if (inputs.study().line) return check_line_stage(call);
  if (inputs.study().external) return check_external_stage(call);
  const auto& command = inputs.command();
  const auto& study = inputs.study();
  const auto& model = inputs.model();
  const auto description = model.describe();
  const Problem* problem = study.recordings ? &inputs.problem() : nullptr;  // what is wrong with the recordings comes before any word of success
  const auto lines = plan_lines({.study = study,
                                 .model = description,
                                 .shape = model.shape(),
                                 .mesh = model.mesh(),
                                 .problem = problem,
                                 .cost = cost_of(study, model, description, command.threads),
                                 .threads = command.threads});
  if (command.resolved) std::cout << study.echo().dump(2) << '\n';
  command.resolved ? inputs.notes().say(lines) : Notes(std::cout, false).say(lines);
  std::cout.flush();
  inputs.notes().warn(description.warnings);
  for (const auto& n : description.notes) inputs.notes().say("note: " + n);
  if (!command.write_mesh.empty()) {
    write_mesh(model.mesh(), command.write_mesh);
    inputs.notes().say(mesh_written_line(command.write_mesh));
  }
  if (command.floor) floor_stage(call);
  return ExitStatus::done;
}

}  // namespace calomel
