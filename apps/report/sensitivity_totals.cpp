#include "apps/report/sensitivity_totals.hpp"

#include <algorithm>

#include "apps/report/sensitivity.hpp"
#include "apps/report/tables.hpp"

namespace calomel {

const std::vector<std::string>& run_total_names() {
  static const std::vector<std::string> names{"dissipated_energy", "time_at_cutoff"};
  return names;
}

bool is_run_total(const std::string& quantity) { return std::find(run_total_names().begin(), run_total_names().end(), quantity) != run_total_names().end(); }

std::string plain_run_total(const std::string& quantity) { return quantity == "dissipated_energy" ? "dissipated energy" : "time at the cutoff"; }

namespace {

std::string sentence(const Json& q, const DisplayUnit& times) {
  const std::string condition = text_at(q, "condition"), source = text_at(q, "source"), note = text_at(q, "note");
  std::string s = "<p><strong>" + plain_run_total(text_at(q, "name")) + (condition.empty() ? "" : ", " + escape_html(condition)) + "</strong>: ";
  if (!source.empty()) {
    const auto mean = number_at(q, "mean"), sd = number_at(q, "sd"), r2 = number_at(q, "left_out_r2");
    const bool time = text_at(q, "unit") == "s";
    const double factor = time ? times.factor : 1;
    const std::string unit = "\u00a0" + escape_html(time ? times.name : text_at(q, "unit"));
    if (mean && sd) s += number_html(factor * *mean, 3) + unit + " in the mean, with a standard deviation of " + number_html(factor * *sd, 2) + unit + ". ";
    s += "Its shares are those of " + escape_html(source) + (r2 ? ", left-out R\u00b2 " + fixed_html(*r2, 3) : "") + ".";
    if (!note.empty()) s += " ";
  }
  if (!note.empty()) s += std::string(source.empty() ? "" : "<strong>") + escape_html(note) + (source.empty() ? "." : ".</strong>");
  return s + "</p>\n";
}

}  // namespace

std::string run_totals_part(const Study& study) {
  std::string s;
  for (const auto& name : run_total_names()) {
    bool shares = false;
    for (const auto& q : list_at(study.sensitivity->summary, "quantities"))
      if (text_at(q, "name") == name) s += sentence(q, study.time), shares = shares || !text_at(q, "source").empty();
    if (shares) s += total_order_table(study, name).html();
  }
  if (s.empty()) return "";
  return "<h3>Dissipated energy and time at the cutoff</h3>\n<p>Of whole runs: the energy that viscosity takes by the end, and how long the mercury has been "
         "at its cutoff, the mean over its "
         "volume. Each run is a single one at pulse energy 1 at a point of the campaign.</p>\n" +
         s;
}

}  // namespace calomel
