#include "apps/report/sections/posterior.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

#include "apps/report/data/json_values.hpp"
#include "apps/report/data/quantities.hpp"
#include "apps/report/parts/elements.hpp"
#include "apps/report/parts/numbers.hpp"
#include "apps/report/sections/chains.hpp"
#include "apps/report/sections/published.hpp"

namespace calomel {

namespace {

constexpr double clearly = 1.5;  ///< ratio of the half widths before and after the records from which a quantity is listed as narrowed
constexpr double hardly = 1.1;   ///< ratio below which a quantity is listed as not narrowed

/// Whether the chains converged and the true model agrees.
Html convergence(const Json& sample) {
  const std::string message = text_at(sample, "message");
  Html s = part_at(sample, "converged") == Json(true) ? paragraph("The chains have ", message, ".")
                                                      : paragraph_of("outcome", strong("Not converged, not to be trusted:"), " ", message, ".");
  if (const auto sentence = text_at(part_at(sample, "true_model_check"), "sentence"); !sentence.empty()) s += paragraph("The true model: ", sentence, ".");
  return s;
}

/// Whether the records contradict the fit.
Html adequacy(const Study& study, const ReportInput& input) {
  const std::string sentence = text_at(*study.sample, "adequacy");
  if (sentence.empty()) return {};
  if (part_at(*study.sample, "adequate") == Json(false))
    return paragraph_of("outcome", strong("By chi-squared, ", sentence, "."),
                        " The intervals below do not include the missing effect: ", command(input, "diagnose"), " investigates which effect is omitted.");
  return paragraph("By chi-squared, ", sentence, ".");
}

/// A sentence about each set of parameters, with and without a prior, when no alarm was raised.
Html no_absorption(const Study& study, const ReportInput& input) {
  std::vector<Html> known;
  std::vector<Html> unknown;
  for (const auto& p : input.parameters) (informed(p.name, study, input) ? known : unknown).emplace_back(p.name);
  Html s;
  if (!known.empty())
    s += paragraph("Of ", joined(known, ", "), known.size() == 1 ? ", which has a prior," : ", which have priors,",
                   " none differs by more than two prior standard deviations from its prior mean.");
  if (!unknown.empty())
    s += paragraph("For ", joined(unknown, ", "), " only bounds were given. Whether ", unknown.size() == 1 ? "it has" : "they have",
                   " compensated for omitted physics cannot be known without priors of the material: give ", element("code", "prior"), ", or set ",
                   element("code", "map.product = \"physical\""), ".");
  return s;
}

/// The alarm: a parameter far from its prior compensates for physics that the model omits.
Html absorption(const Study& study, const ReportInput& input) {
  Html alarms;
  for (const auto& a : list_at(*study.sample, "absorption"))
    if (a.is_string()) alarms += paragraph_of("outcome", strong(a.get<std::string>(), "."));
  if (alarms.empty()) return no_absorption(study, input);
  return alarms + paragraph("Such a value is no property of the material. ", command(input, "diagnose"), " investigates which effect is omitted.");
}

/// The quantities whose density is cut.
Html cut_densities(const Study& study) {
  std::vector<Html> places;
  for (const auto& b : broken_off(*study.posterior)) places.push_back(fragment(b.name, " at ", number_html(b.at, 5)));
  if (places.empty()) return {};
  return paragraph(strong("The draws break off: ", joined(places, ", "), "."),
                   " A bound of the case, or the end of the box that the emulator was trained on, cuts the density there, so that the reported interval is too "
                   "narrow on that "
                   "side.");
}

/// "The records narrow the priors: density 2.9 times. Of young they contain almost no information: ..."
Html narrowing(const Study& study, const ReportInput& input) {
  std::vector<Html> narrowed;
  std::vector<Html> same;
  for (const auto& row : prior_table(study, input).rows) {
    const auto* times = std::get_if<double>(&row[5].value);
    if (!times) continue;
    const auto& label = std::get<std::string>(row[0].value);
    const std::string name = label.substr(0, label.find(" ["));
    if (*times >= clearly) narrowed.push_back(fragment(name, " ", number_html(*times, *times < 10 ? 2 : 3), " times"));
    if (*times < hardly) same.emplace_back(name);
  }
  Html s;
  if (!narrowed.empty()) s += fragment("The records narrow the priors: ", joined(narrowed, ", "), ".");
  if (!same.empty())
    s += fragment(s.empty() ? "" : " ", "Of ", joined(same, ", "), " they contain almost no information: the reported distribution is the prior.");
  return s.empty() ? s : paragraph(s);
}

Html corner_plot(const Study& study, const ReportInput& input) {
  constexpr std::size_t most = 6;  // quantities in the plot
  const auto& names = study.posterior->names;
  const auto drawn = [&](const std::string& name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  const Impedance z = impedance(input);
  const bool ridge = z.ridge() && drawn(z.density) && drawn(z.sound_speed);
  const Html caption = fragment(
      "Draws from the posterior. On the diagonal the density of each parameter, with its median and its 5 and 95 % quantiles; below it every pair, with the "
      "lines "
      "within which 50 and 90 % of the draws lie. Discs, and the marks on top of the densities, are the calibrated values; an arrow on the frame points to one "
      "that lies outside.",
      ridge ? " The dashed line is \u03c1c = const through the median of \u03c1c." : "",
      names.size() > most ? fmt::format(" The first {} of {} quantities, the case\u2019s parameters before the others.", most, names.size()) : "");
  return plot("corner-plot", caption, "Corner plot of the posterior");
}

Html predictions(const Study& study) {
  if (!study.predictive) return {};
  const bool errors = !study.predictive->predicted_low.empty();
  const Html text = paragraph(
      errors ? "Wide band: 90 % interval of the predicted mean record with all errors of the posterior: noise, gains, places of the gauges, energy, mesh, "
               "emulator and, for the physical product, omitted physics. Errors are correlated along a record, so the record may lie inside at all times. If "
               "much less than 90 % lies inside, errors or physics are missing. The errors are those below the highest compared frequency. "
             : "",
      "Narrow band: 90 % interval of the simulations at the draws, without errors. It shows the uncertainty of the parameters alone.");
  return heading("Does the posterior predict the records?") + text +
         element("div", place("predictive-controls", "controls"), "\n", place("predictive-plots", "plots")) + "\n";
}

Html chains_plot() {
  return plot("chain-plot",
              "Left: the draws of each chain in their order. Converged chains overlap and look like noise. A chain that is separate, drifts or sticks has not "
              "converged. Right: the counts of a chain\u2019s draws in each of 20 parts of the ranks of all draws, against the expected count (dashed), one "
              "strip a chain. Counts within the grey band agree with chance. A slope means that a chain is too high or too low, a hill or a bowl that it is "
              "too narrow or too wide.",
              "Traces and ranks of the chains");
}

}  // namespace

Table posterior_table(const Study& study, const ReportInput& input) {
  Table t{.id = "posterior", .caption = "Marginal posterior of every parameter, and the precision of its estimate."};
  if (!study.sample) return t;
  t.columns = {{"parameter", "Parameter", 4, true},
               {"mean", "Mean", 5},
               {"sd", "Sd", 3},
               {"q05", "5 %", 5},
               {"q50", "Median", 5},
               {"q95", "95 %", 5},
               {"r_hat", "R-hat", -3},
               {"ess_bulk", "ESS, bulk", 6},
               {"ess_tail", "ESS, tails", 6},
               {"mcse_mean", "MCSE of the mean", 2}};
  for (const auto& p : list_at(*study.sample, "parameters")) {
    std::vector<Cell> row{parameter_label(input, text_at(p, "name"))};
    for (const char* key : {"mean", "sd", "q05", "q50", "q95", "r_hat"}) row.emplace_back(number_at(p, key));
    for (const char* key : {"ess_bulk", "ess_tail"}) {
      const auto x = number_at(p, key);
      row.emplace_back(x ? std::optional(std::round(*x)) : std::nullopt);
    }
    row.emplace_back(number_at(p, "mcse_mean"));
    t.rows.push_back(std::move(row));
  }
  return t;
}

std::string posterior_draws_csv(const Study& study) {
  if (!study.posterior) return "";
  const Draws& draws = *study.posterior;
  std::string csv = "chain,draw";
  for (const auto& name : draws.names) csv += ',' + csv_field(name);
  csv += '\n';
  for (std::size_t c = 0; c < draws.chains; ++c)
    for (std::size_t i = 0; i < draws.draws; ++i) {
      csv += fmt::format("{},{}", c, i);
      for (std::size_t k = 0; k < draws.names.size(); ++k) csv += ',' + number_text(draws.at(c, i, k));
      csv += '\n';
    }
  return csv;
}

Html posterior_headline(const Study& study, const ReportInput& input) {
  if (!study.sample) return {};
  if (part_at(*study.sample, "converged") != Json(true))
    return paragraph_of("outcome", strong("The posterior is not to be trusted"), "; see ", link_to("posterior", "its section"),
                        " for the reason and the remedy.");
  std::vector<Html> intervals;
  for (const auto& p : list_at(*study.sample, "parameters")) {
    const std::string name = text_at(p, "name");
    const bool own = std::any_of(input.parameters.begin(), input.parameters.end(), [&](const Parameter& q) { return q.name == name; });
    const auto low = number_at(p, "q05");
    const auto middle = number_at(p, "q50");
    const auto high = number_at(p, "q95");
    if (!(own || input.parameters.empty()) || !low || !middle || !high) continue;
    const std::string unit = parameter_unit(input, name);
    intervals.push_back(fragment(name, " ", strong(number_html(*middle, 4), unit.empty() ? "" : "\u00a0" + unit), " (", number_html(*low, 4), " to ",
                                 number_html(*high, 4), ")"));
  }
  if (intervals.empty()) return {};
  const Html final_or_not = part_at(*study.sample, "final") == Json(false) ? fragment(" ", strong("Not final"), ": see the warnings.") : Html();
  return paragraph_of("outcome", "By the ", link_to("posterior", "posterior"), ": ", joined(intervals, "; "), ". In brackets: 90\u00a0% of the draws.",
                      final_or_not);
}

Html posterior_section(const Study& study, const ReportInput& input) {
  if (!study.sample && !study.posterior)
    return missing(fragment("No posterior has been sampled (posterior.nc, posterior.json). Sample it with ", command(input, "sample"), "."));
  Html s = study.sample ? convergence(*study.sample) + adequacy(study, input) + absorption(study, input) + shown(posterior_table(study, input))
                        : missing("posterior.json is missing, so convergence is unknown.");
  if (!study.posterior) return s + missing("posterior.nc is missing, so the corner plot is not drawn.");
  if (const Table t = prior_table(study, input); !t.empty())
    s += heading("What have the records shown?") + narrowing(study, input) +
         plot("prior-plot",
              "Before the records, grey and dashed, and after them, blue. Each curve is scaled to its own greatest value, so that both can be seen.",
              "Prior and posterior density of every parameter") +
         folded("The same in numbers", t);
  return s + heading("Which values go together?") + cut_densities(study) + corner_plot(study, input) + published_paragraph(study, input) + predictions(study) +
         heading("Have the chains converged?") + chains_plot();
}

}  // namespace calomel
