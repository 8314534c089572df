#include "apps/report/sections/sensitivity_totals.hpp"

#include <string>

#include "apps/report/data/json_values.hpp"
#include "apps/report/parts/elements.hpp"
#include "apps/report/parts/numbers.hpp"
#include "apps/report/sections/sensitivity_tables.hpp"

namespace calomel {

namespace {

/// The mean, the standard deviation and the source of the shares, for a quantity with shares.
Html shares_text(const Json& q, const DisplayUnit& times) {
  const auto mean = number_at(q, "mean");
  const auto sd = number_at(q, "sd");
  const auto r2 = number_at(q, "left_out_r2");
  const DisplayUnit unit = effect_unit(q, times, times);
  Html s;
  if (mean && sd)
    s += fragment(number_html(unit.factor * *mean, 3), "\u00a0", unit.name, " in the mean, with a standard deviation of ", number_html(unit.factor * *sd, 2),
                  "\u00a0", unit.name, ". ");
  return s + fragment("Its shares are those of ", text_at(q, "source"), r2 ? fragment(", left-out R\u00b2 ", fixed_html(*r2, 3)) : Html(), ".");
}

Html total_paragraph(const Json& q, const DisplayUnit& times) {
  const std::string condition = text_at(q, "condition");
  const std::string note = text_at(q, "note");
  const Html title = strong(plain_quantity(text_at(q, "name")), condition.empty() ? "" : ", " + condition);
  if (text_at(q, "source").empty()) return paragraph(title, ": ", note, note.empty() ? "" : ".");
  return paragraph(title, ": ", shares_text(q, times), note.empty() ? Html() : " " + strong(note, "."));
}

}  // namespace

Html run_totals_part(const Study& study) {
  Html s;
  for (const auto& name : run_total_names()) {
    bool shares = false;
    for (const auto& q : list_at(sensitivity_summary(study), "quantities")) {
      if (text_at(q, "name") != name) continue;
      s += total_paragraph(q, study.time);
      shares = shares || !text_at(q, "source").empty();
    }
    if (shares) s += total_order_table(study, name).html();
  }
  if (s.empty()) return {};
  return heading("Dissipated energy and time at the cutoff") +
         paragraph(
             "Of whole runs: the energy that viscosity takes by the end, and how long the mercury has been at its cutoff, the mean over its volume. Each run "
             "is "
             "a single one at pulse energy 1 at a point of the campaign.") +
         s;
}

}  // namespace calomel
