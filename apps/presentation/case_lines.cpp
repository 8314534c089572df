#include "apps/presentation/case_lines.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/presentation/progress.hpp"

namespace calomel {

namespace {

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
  const auto& campaign = plan.study.campaign;
  const RunCost& run = *plan.model.cost;
  std::vector<std::string> lines;
  lines.push_back(fmt::format("cost on {} threads: one run about {}; the campaign of {} ensemble means over {} parameters about {}, {} repeatability floor {}",
                              plan.threads, duration_text(plan.cost->run), campaign.runs, plan.study.parameters().size(), duration_text(plan.cost->campaign),
                              campaign.floor ? "its" : "a", duration_text(plan.cost->floor)));
  if (plan.cost->posterior > 0)
    lines.push_back(fmt::format("with the records: the emulator of a posterior begins with runs of about {}; a diagnosis makes at most {} runs, about {}",
                                duration_text(plan.cost->posterior), plan.study.diagnosis.max_runs, duration_text(plan.cost->diagnosis)));
  if (run.run_threads < plan.threads)
    lines.push_back(fmt::format("a single run is too small to gain by more than {} thread{}", run.run_threads, run.run_threads > 1 ? "s" : ""));
  return lines;
}

}  // namespace

std::vector<std::string> fact_lines(const std::vector<Fact>& facts) {
  std::vector<std::string> lines;
  for (const auto& f : facts) lines.push_back(f.label + ": " + f.text);
  return lines;
}

std::vector<std::string> plan_lines(const StudyPlan& plan) {
  std::vector<std::string> lines = fact_lines(plan.model.facts);
  if (plan.problem) lines.push_back(fmt::format("recordings: {} records, compared at {} times", plan.problem->observations.size(), plan.problem->time.size()));
  if (!plan.cost) return lines;
  lines.push_back(study_line(plan.study));
  const auto costs = cost_lines(plan);
  lines.insert(lines.end(), costs.begin(), costs.end());
  return lines;
}

std::string mesh_written_line(const std::filesystem::path& file) { return "mesh written to " + file.string(); }

std::vector<InputError> nominals_left_out(const StudyCase& study) {
  std::vector<InputError> out;
  for (const auto& p : study.parameters()) {
    const auto value = study.simulator->table_value(p);
    if (!p.nominal || !value || *p.nominal == *value) continue;
    const double table = *value;
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
