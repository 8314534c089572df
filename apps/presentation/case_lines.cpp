#include "apps/presentation/case_lines.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/presentation/progress.hpp"

namespace calomel {

namespace {

std::vector<std::string> model_lines(const StudyPlan& plan) {
  const ForwardCase& c = plan.study.forward;
  const auto& d = plan.model;
  const auto& shape = plan.shape;
  std::vector<std::string> lines;
  lines.push_back(fmt::format("case: {}, {}{}{}", c.name, c.geometry.kind, plan.mesh.plane_strain ? " in plane strain" : "",
                              plan.mesh.mirrors.empty() ? "" : ", symmetric"));
  lines.push_back(fmt::format("model: {} elements, {} nodes, {} steps of {:.3g} s, {} sensors at {} times, about {:.0f} MB", d.elements, d.nodes, d.steps,
                              d.time_step, shape.sensors.size(), shape.times.size(), d.estimated_bytes / 1e6));
  if (shape.conditions.size() > 1) lines.push_back("conditions: " + join(shape.conditions));
  if (d.subcycles > 1) lines.push_back(fmt::format("sub-cycling: mercury away from the steel takes one step in {}", d.subcycles));
  return lines;
}

std::string mechanisms_line(const ForwardCase& c) {
  const auto active = c.active_mechanisms();
  std::vector<std::string> names;
  for (const auto& m : c.mechanisms) {
    const bool off = std::none_of(active.begin(), active.end(), [&](const auto& a) { return a.name == m.name; });
    names.push_back(m.name + (off ? " (at its off values)" : ""));
  }
  return "mechanisms: " + join(names);
}

std::string mesh_line(const MeshQuality& q, const std::string& wetted) {
  return fmt::format(
      "mesh: scaled Jacobian at least {:.3f}, aspect ratio at most {:.2f}, shortest edge {:.3g} mm, {} elements through the thinnest wall, wetted faces {}",
      q.least_scaled_jacobian, q.greatest_aspect_ratio, 1e3 * q.shortest_edge, q.least_wall_elements, wetted);
}

std::string parameters_line(const std::vector<Parameter>& parameters) {
  std::vector<std::string> names;
  for (const auto& p : parameters) names.push_back(fmt::format("{} {:.4g} to {:.4g}", p.name, p.min, p.max));
  return "parameters: " + join(names);
}

std::string study_line(const StudyCase& study) {
  const auto& campaign = study.campaign;
  std::vector<std::string> stages;
  for (const auto& stage : study.study.stages)
    stages.push_back(stage == "campaign"    ? fmt::format("campaign of {} ensemble means of {} ({})", campaign.runs, campaign.pulses, campaign.design)
                     : stage == "train"     ? "train " + study.surrogate.kind
                     : stage == "calibrate" ? "calibrate by " + join(study.study.methods)
                                            : stage);
  return "study: " + join(stages);
}

std::vector<std::string> cost_lines(const StudyPlan& plan) {
  const auto& d = plan.model;
  const auto& campaign = plan.study.campaign;
  std::vector<std::string> lines;
  lines.push_back(fmt::format("cost on {} threads: one run about {}; the campaign of {} ensemble means over {} parameters about {}, {} repeatability floor {}",
                              plan.threads, duration_text(plan.cost.run), campaign.runs, plan.shape.parameters.size(), duration_text(plan.cost.campaign),
                              campaign.floor ? "its" : "a", duration_text(plan.cost.floor)));
  if (plan.cost.posterior > 0)
    lines.push_back(fmt::format("with the records: the emulator of a posterior begins with runs of about {}; a diagnosis makes at most {} runs, about {}",
                                duration_text(plan.cost.posterior), plan.study.diagnosis.max_runs, duration_text(plan.cost.diagnosis)));
  if (d.run_threads < plan.threads)
    lines.push_back(fmt::format("a single run is too small to gain by more than {} thread{}", d.run_threads, d.run_threads > 1 ? "s" : ""));
  return lines;
}

}  // namespace

std::vector<std::string> plan_lines(const StudyPlan& plan) {
  const ForwardCase& c = plan.study.forward;
  std::vector<std::string> lines = model_lines(plan);
  const auto add = [&](std::vector<std::string> more) { std::move(more.begin(), more.end(), std::back_inserter(lines)); };
  add(physics_lines(c.load, plan.model, plan.mesh.plane_strain));
  if (!c.mechanisms.empty()) lines.push_back(mechanisms_line(c));
  lines.push_back(mesh_line(plan.mesh.quality, c.geometry.wetted));
  if (!c.parameters.empty()) lines.push_back(parameters_line(c.parameters));
  if (plan.problem) lines.push_back(fmt::format("recordings: {} records, compared at {} times", plan.problem->observations.size(), plan.problem->time.size()));
  lines.push_back(study_line(plan.study));
  add(cost_lines(plan));
  return lines;
}

std::vector<std::string> physics_lines(const LoadOptions& load, const ModelDescription& model, bool plane_strain) {
  std::vector<std::string> lines{"load: " + policy_text(load)};
  if (model.deposited_energy > 0)
    lines.push_back(fmt::format("pulse: {:.4g} J deposited{}; regularising viscosity {:.4g} Pa s{}", model.deposited_energy,
                                plane_strain ? fmt::format(" in a slice {:.3g} mm thick", 1e3 * model.slice_thickness) : "", model.viscosity,
                                model.mesh_decides_viscosity ? " (decided by the mesh)" : ""));
  return lines;
}

std::string mesh_written_line(const std::filesystem::path& file) { return "mesh written to " + file.string(); }

std::vector<InputError> nominals_left_out(const StudyCase& study) {
  std::vector<InputError> out;
  for (const auto& p : study.forward.parameters) {
    const double table = study.forward.number(p.key);
    if (!p.nominal || *p.nominal == table) continue;
    out.push_back(study.file.located(
        InputError({.problem = "simulate takes the numbers of the tables, so this has no effect on it",
                    .key = "parameter." + p.name + ".nominal",
                    .value = number_text(*p.nominal),
                    .suggestion = fmt::format("set {} itself, which is {}: --set {}={}", p.key, number_text(table), p.key, number_text(*p.nominal))})));
  }
  return out;
}

std::string unbuilt_mechanisms_sentence(std::size_t mechanisms) {
  return fmt::format("{} of the listed mechanisms are not built yet in this version and take no part", mechanisms);
}

}  // namespace calomel
