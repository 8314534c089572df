#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iostream>

#include "apps/interrupt.hpp"
#include "apps/progress.hpp"
#include "apps/pipeline/stages.hpp"
#include "apps/verbs.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"
#include "forward/mesh/write_mesh.hpp"
#include "forward/repeatability.hpp"

namespace calomel {

namespace {


}  // namespace

std::vector<std::string> Stages::plan() {
  const ForwardCase& c = study_.forward;
  const auto& shape = model().shape();
  const auto d = model().describe();
  std::vector<std::string> lines;
  lines.push_back(fmt::format("case: {}, {}{}{}", c.name, c.geometry.kind, model().mesh().plane_strain ? " in plane strain" : "", model().mesh().mirrors.empty() ? "" : ", symmetric"));
  lines.push_back(fmt::format("model: {} elements, {} nodes, {} steps of {:.3g} s, {} sensors at {} times, about {:.0f} MB", d.elements, d.nodes, d.steps, d.time_step,
                              shape.sensors.size(), shape.times.size(), d.estimated_bytes / 1e6));
  if (shape.conditions.size() > 1) lines.push_back("conditions: " + join(shape.conditions));
  if (d.subcycles > 1) lines.push_back(fmt::format("sub-cycling: mercury away from the steel takes one step in {}", d.subcycles));
  for (auto& line : physics()) lines.push_back(std::move(line));
  if (!c.mechanisms.empty()) {
    const auto active = c.active_mechanisms();
    std::vector<std::string> names;
    for (const auto& m : c.mechanisms) names.push_back(m.name + (std::any_of(active.begin(), active.end(), [&](const auto& a) { return a.name == m.name; }) ? "" : " (at its off values)"));
    lines.push_back("mechanisms: " + join(names));
  }
  const auto& q = model().mesh().quality;
  lines.push_back(
      fmt::format("mesh: scaled Jacobian at least {:.3f}, aspect ratio at most {:.2f}, shortest edge {:.3g} mm, {} elements through the thinnest wall, wetted faces {}",
                  q.least_scaled_jacobian, q.greatest_aspect_ratio, 1e3 * q.shortest_edge, q.least_wall_elements, c.geometry.wetted));
  if (!c.parameters.empty()) {
    std::vector<std::string> names;
    for (const auto& p : c.parameters) names.push_back(fmt::format("{} {:.4g} to {:.4g}", p.name, p.min, p.max));
    lines.push_back("parameters: " + join(names));
  }
  if (study_.recordings) lines.push_back(fmt::format("recordings: {} records, compared at {} times", problem().observations.size(), problem().time.size()));
  for (auto& line : cost(d)) lines.push_back(std::move(line));
  return lines;
}

std::vector<std::string> Stages::cost(const ModelDescription& d) {
  const auto& campaign = study_.campaign;
  std::vector<std::string> stages;
  for (const auto& stage : study_.study.stages)
    stages.push_back(stage == "campaign"    ? fmt::format("campaign of {} ensemble means of {} ({})", campaign.runs, campaign.pulses, campaign.design)
                     : stage == "train"     ? "train " + study_.surrogate.kind
                     : stage == "calibrate" ? "calibrate by " + join(study_.study.methods)
                                            : stage);
  const double conditions = double(model().shape().conditions.size());
  const double means = double(campaign.runs) * conditions, mean_seconds = d.estimated_mean_seconds / command_.threads;
  const bool finer = study_.floor.finer_mesh && finer_is_small_enough(study_.floor, model().mesh());
  const double floor = conditions * floor_cost(study_.floor, model().mesh().plane_strain, finer, d.estimated_seconds / d.estimated_mean_seconds);
  std::vector<std::string> lines{"study: " + join(stages)};
  lines.push_back(fmt::format("cost on {} threads: one run about {}; the campaign of {} ensemble means over {} parameters about {}, {} repeatability floor {}", command_.threads,
                              duration_text(conditions * d.estimated_seconds / d.run_gain), campaign.runs, model().shape().parameters.size(), duration_text(means * mean_seconds),
                              campaign.floor ? "its" : "a", duration_text(floor * mean_seconds)));
  if (d.run_threads < command_.threads) lines.push_back(fmt::format("a single run is too small to gain by more than {} thread{}", d.run_threads, d.run_threads > 1 ? "s" : ""));
  return lines;
}

/// Reads every table, builds the mesh, places the sensors and holds the recordings against them. Tells on stdout what will be run and
/// its cost, a screenful; with --resolved stdout is the case with all defaults as JSON and the rest goes to stderr, where warnings always are.
/// Runs nothing and writes nothing, but with --floor the ensemble mean on jittered meshes and what stands beside it, which goes to
/// floor.json, and with --write-mesh the mesh.
ExitStatus Stages::check() {
  const auto d = model().describe();
  const auto lines = plan();  // what is wrong with the recordings comes before any word of success
  if (command_.resolved) std::cout << study_.echo().dump(2) << '\n';
  for (const auto& line : lines) command_.resolved ? say(line) : void(std::cout << line << '\n');
  std::cout.flush();
  for (const auto& w : d.warnings) say("warning: " + w);
  for (const auto& n : d.notes) say("note: " + n);
  if (!command_.write_mesh.empty()) {
    calomel::write_mesh(model().mesh(), command_.write_mesh);
    say("mesh written to " + command_.write_mesh.string());
  }
  if (command_.floor) measure_floor();
  return ExitStatus::done;
}

Provenance Stages::floor_provenance() const {
  Json options = study_.model_options();
  options["campaign"] = {{"pulses", study_.campaign.pulses}, {"pulse_energy_sd", study_.campaign.pulse_energy_sd}};
  options["floor"] = echo(study_.floor);
  return {.stage = "floor", .options = std::move(options), .seed = command_.seed, .inputs = study_.model_inputs()};
}

void Stages::need_floor() {
  if (!due(floor_provenance(), {"floor.json"}, Asked::upstream)) return;
  say("no repeatability floor in " + command_.out.string() + ": measuring it first");
  measure_floor();
}

void Stages::measure_floor() {
  const auto provenance = floor_provenance();
  const auto journal = command_.out / "floor.journal";
  if (RunStore::identity(journal) != provenance.identity()) set_aside(journal);
  RunStore store(provenance, journal);
  const auto began = std::chrono::steady_clock::now();
  RepeatabilityFloor floor;
  {
    ProgressDisplay display("floor", "runs", progress_style(command_.quiet), std::cerr);
    floor = calomel::measure_floor(
        model().forward_case(), model().ensemble(), study_.floor, command_.seed, command_.threads,
        {.store = &store, .progress = [&](std::size_t done, std::size_t total) { display.update(done, total); }, .stop = &stop_requested()});
  }
  Json json = floor_json(floor);
  json["wall_s"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  json["provenance"] = provenance.json();
  write_json(command_.out / "floor.json", json);
  store.remove();
  say_floor(floor);
}

void Stages::say_floor(const RepeatabilityFloor& floor) const {
  say(fmt::format(
      "repeatability floor of the ensemble mean over {} jitters of mesh, viscosity and energies: {:.2f} % of the signal (mean over sensors), {:.2f} % at worst",
      floor.members.size(), 100 * floor.mean, 100 * floor.worst));
  for (std::size_t row = 0; row < floor.relative.size(); ++row)
    say(fmt::format("  {}{}: {:.2f} %", floor.conditions.size() > 1 ? floor.conditions[row / floor.sensors.size()] + ' ' : "",
                    floor.sensors[row % floor.sensors.size()], 100 * floor.relative[row]));
  for (const auto& c : floor.comparisons)
    say(fmt::format("{}: {}", c.what, c.message.empty() ? fmt::format("{:.2g} % (mean over sensors), {:.2g} % at worst", 100 * c.mean, 100 * c.worst) : c.message));
}

ExitStatus run_check(const CommandLine& command) { return Stages(command).check(); }

}  // namespace calomel
