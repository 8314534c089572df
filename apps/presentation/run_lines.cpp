#include "apps/presentation/run_lines.hpp"

#include <fmt/format.h>

namespace calomel {

namespace {

/// "2.1 % (mean over sensors), 4 % at worst", or why there are no numbers.
std::string numbers_of(const FloorComparison& c) {
  return c.message.empty() ? fmt::format("{:.2g} % (mean over sensors), {:.2g} % at worst", 100 * c.mean, 100 * c.worst) : c.message;
}

}  // namespace

std::string stage_line(const std::string& stage, const std::string& sentence) { return stage + ": " + sentence; }

std::string reused_line(const std::string& stage) { return stage + ": reused"; }

std::string made_first_line(const std::string& what, const std::filesystem::path& out, const std::string& doing) {
  return "no " + what + " in " + out.string() + ": " + doing + " it first";
}

std::vector<std::string> floor_lines(const RepeatabilityFloor& floor) {
  std::vector<std::string> lines{fmt::format(
      "repeatability floor of the ensemble mean over {} jitters of mesh, viscosity and energies: {:.2f} % of the signal (mean over sensors), {:.2f} % at worst",
      floor.members.size(), 100 * floor.mean, 100 * floor.worst)};
  const std::size_t sensors = floor.sensors.size();
  for (std::size_t row = 0; row < floor.relative.size(); ++row)
    lines.push_back(fmt::format("  {}{}: {:.2f} %", floor.conditions.size() > 1 ? floor.conditions[row / sensors] + ' ' : "", floor.sensors[row % sensors],
                                100 * floor.relative[row]));
  for (const auto& c : floor.comparisons) lines.push_back(c.what + ": " + numbers_of(c));
  return lines;
}

std::string failed_note(std::size_t failed) { return failed ? fmt::format("{} failed", failed) : ""; }

std::string campaign_line(const CampaignSummary& summary) {
  return fmt::format("campaign: {}{}", summary.message, summary.reused ? fmt::format(" ({} reused)", summary.reused) : "");
}

std::vector<std::string> failure_lines(const Archive& archive, const Feasibility& feasibility) {
  if (!feasibility.any_failed()) return {};
  std::vector<std::string> lines{
      fmt::format("{} of {} runs of the campaign failed and are left out; searches keep off where runs are likely to fail ({:.0f} % of the runs are predicted "
                  "rightly from the others)",
                  feasibility.failures(), archive.runs(), 100 * feasibility.leave_one_out_accuracy())};
  for (const auto& [reason, count] : failure_reasons(archive)) lines.push_back(fmt::format("  {} x {}", count, reason));
  return lines;
}

std::vector<std::string> train_lines(const TrainSummary& summary) {
  std::vector<std::string> lines;
  for (const auto& s : summary.surrogates)
    lines.push_back(
        fmt::format("train: {} on {} runs, held out {}: R2 {:.3f}, mean absolute error {:.3g}", s.name, s.n_train, s.n_test, s.test.r2, s.test.mae));
  return lines;
}

std::string resumed_line(const std::string& which, std::int64_t step, bool finished) {
  return "simulate: " + (which.empty() ? "" : "condition " + which + ' ') + (finished ? "is finished and kept" : fmt::format("resumes from step {}", step));
}

std::string simulate_line(const Simulated& s, std::size_t values) {
  if (s.elements == 0) return fmt::format("simulate: {} values in {:.3g} s", values, s.wall_s);
  return fmt::format("simulate: {} elements, {} steps, {:.3g} s, {:.3g} million element-steps a second", s.elements, s.steps, s.wall_s,
                     s.element_steps_per_s / 1e6);
}

std::string report_line(const std::filesystem::path& page) { return "report: " + page.string(); }

std::string report_tables_line(std::size_t tables, const std::filesystem::path& folder) {
  return fmt::format("report: {} tables in {}", tables, folder.string());
}

std::string import_line(const ImportSummary& summary) {
  const auto& r = summary.recordings;
  return fmt::format("import: {} sensors, {} pulses, {} samples in {}", r.sensors.size(), r.pulses.size(), r.time.size(), summary.path.string());
}

}  // namespace calomel
