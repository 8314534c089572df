#include "apps/report/sections/campaign.hpp"

#include <cstddef>
#include <string>
#include <vector>

#include "apps/report/data/json_values.hpp"
#include "apps/report/data/series.hpp"
#include "apps/report/parts/elements.hpp"
#include "apps/report/parts/numbers.hpp"

namespace calomel {

Table failure_table(const Study& study, std::size_t most) {
  Table t{.id = "failed_runs", .caption = "Runs that failed, and why."};
  if (!study.runs) return t;
  t.columns = {{"run", "Run", 6}};
  for (const auto& p : study.runs->parameters) t.columns.push_back({p, p, 5});
  t.columns.push_back({"message", "Reason", 4, true});
  std::size_t failed = 0;
  for (std::size_t i = 0; i < study.runs->runs(); ++i) {
    if (study.runs->status[i] == 0 || ++failed > most) continue;
    std::vector<Cell> row{double(i)};
    for (std::size_t p = 0; p < study.runs->parameters.size(); ++p) row.emplace_back(study.runs->theta[i * study.runs->parameters.size() + p]);
    row.emplace_back(study.runs->message[i]);
    t.rows.push_back(std::move(row));
  }
  if (failed > most) t.note = "The first " + std::to_string(most) + " of " + std::to_string(failed) + " are listed; campaign.nc holds all.";
  return t;
}

Table design_table(const Study& study) {
  Table t{.id = "design", .caption = "Design of the campaign."};
  if (!study.runs) return t;
  t.columns = {{"run", "Run", 6}};
  for (const auto& p : study.runs->parameters) t.columns.push_back({p, p, 5});
  t.columns.push_back({"status", "Status", 4, true});
  t.columns.push_back({"message", "Message", 4, true});
  for (std::size_t i = 0; i < study.runs->runs(); ++i) {
    std::vector<Cell> row{double(i)};
    for (std::size_t p = 0; p < study.runs->parameters.size(); ++p) row.emplace_back(study.runs->theta[i * study.runs->parameters.size() + p]);
    const auto status = std::size_t(study.runs->status[i]);
    row.emplace_back(status < study.runs->status_words.size() ? study.runs->status_words[status] : std::to_string(status));
    row.emplace_back(study.runs->message[i]);
    t.rows.push_back(std::move(row));
  }
  return t;
}

Table scatter_table(const Study& study, const ReportInput& input) {
  const auto unit = display_unit(input);
  Table t{.id = "scatter", .caption = "Scatter between simulated pulses at equal parameters and energy (root mean square over runs and time)."};
  t.columns = {{"sensor", "Sensor", 4, true}, {"scatter", "Scatter [" + unit.name + "]", 4}};
  if (study.runs)
    for (std::size_t s = 0; s < study.runs->scatter.size(); ++s) t.rows.push_back({study.runs->sensors[s], study.runs->scatter[s] * unit.factor});
  if (!t.rows.empty()) t.note = "No calibration can be expected to come nearer to a single pulse than this.";
  return t;
}

namespace {

Html counts(const Json& campaign) {
  Html s = fragment(count_at(campaign, "runs"), " runs were planned: ", count_at(campaign, "completed"), " completed, ", count_at(campaign, "failed"),
                    " failed, ", count_at(campaign, "reused"), " were taken from an earlier call.");
  if (const auto wall = number_at(campaign, "wall_s")) s += fragment(" The last call took ", number_html(*wall, 3), " s.");
  return paragraph(s);
}

}  // namespace

Html campaign_section(const Study& study, const ReportInput& input) {
  if (!study.campaign && !study.runs)
    return missing("No campaign has been run (campaign.json, campaign.nc).", fragment("Run it with ", command(input, "campaign"), "."));
  const Html s = study.campaign ? counts(*study.campaign) : missing("campaign.json is missing.");
  if (!study.runs) return s + missing("campaign.nc is missing, so the design is not drawn.", fragment("Make it with ", command(input, "campaign"), "."));
  constexpr std::size_t most_failures = 50;
  return s + plot("design-plot", "Design: the parameters of every run, each pair of them. Failed runs are crosses.", "Scatter of the campaign's design") +
         shown(failure_table(study, most_failures)) + shown(scatter_table(study, input));
}

Json design_json(const Study& study, const ReportInput& input, std::size_t points) {
  if (!study.runs || study.runs->runs() == 0) return nullptr;
  const auto& r = *study.runs;
  Json names = Json::array();
  Json done = Json::array();
  Json failed = Json::array();
  for (const auto& p : r.parameters) names.push_back(parameter_label(input, p));
  const auto step = stride(r.runs(), points);
  for (std::size_t i = 0; i < r.runs(); ++i) {
    if (r.status[i] == 0 && i % step != 0) continue;  // a failed run is always shown
    Json row = Json::array();
    for (std::size_t p = 0; p < r.parameters.size(); ++p) row.push_back(rounded(r.theta[i * r.parameters.size() + p], 4));
    (r.status[i] == 0 ? done : failed).push_back(std::move(row));
  }
  return {{"parameters", std::move(names)}, {"done", std::move(done)}, {"failed", std::move(failed)}};
}
}  // namespace calomel
