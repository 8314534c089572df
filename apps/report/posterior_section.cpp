#include <fmt/format.h>

#include <algorithm>

#include "apps/report/chains.hpp"
#include "apps/report/html.hpp"
#include "apps/report/posterior.hpp"
#include "apps/report/published.hpp"
#include "apps/report/tables.hpp"
#include "base/json.hpp"

namespace calomel {

namespace {

constexpr double clearly = 1.5, hardly = 1.1;  ///< times narrower than before the records

/// Whether the chains, the emulator and the true model agree.
std::string verdict(const Json& sample) {
  const bool converged = part_at(sample, "converged") == Json(true);
  const std::string message = escape_html(text_at(sample, "message"));
  std::string s = converged ? "<p>The chains have " + message + ".</p>\n"
                            : "<p class=\"outcome\"><strong>Not converged, not to be trusted:</strong> " + message + ".</p>\n";
  if (const auto sentence = text_at(part_at(sample, "true_model_check"), "sentence"); !sentence.empty())
    s += "<p>The true model: " + escape_html(sentence) + ".</p>\n";
  return s;
}

/// Whether the records contradict the fit.
std::string adequacy(const Study& study, const ReportInput& input) {
  const std::string told = escape_html(text_at(*study.sample, "adequacy"));
  if (told.empty()) return "";
  if (part_at(*study.sample, "adequate") == Json(false))
    return "<p class=\"outcome\"><strong>By chi-squared, " + told +
           ".</strong> The intervals below do not cover what is missing: " + command(input, "diagnose") + " asks what was left out.</p>\n";
  return "<p>By chi-squared, " + told + ".</p>\n";
}

/// The alarm: a parameter that sits far from what was known of it has taken the place of something else.
std::string absorbed(const Study& study, const ReportInput& input) {
  const Json& alarms = list_at(*study.sample, "absorption");
  std::string s;
  for (const auto& a : alarms)
    if (a.is_string()) s += "<p class=\"outcome\"><strong>" + escape_html(a.get<std::string>()) + ".</strong></p>\n";
  if (!s.empty()) return s + "<p>Such a value is no property of the material. " + command(input, "diagnose") + " asks what was left out.</p>\n";
  std::string known, unknown;
  for (const auto& p : input.parameters)
    (informed(p.name, study, input) ? known : unknown) += ((informed(p.name, study, input) ? known : unknown).empty() ? "" : ", ") + escape_html(p.name);
  if (!known.empty())
    s += "<p>Of " + known + (known.find(',') == std::string::npos ? ", which has a prior," : ", which have priors,") +
         " none sits more than two prior standard deviations from what was known of it.</p>\n";
  if (!unknown.empty())
    s += "<p>Of " + unknown + " nothing but bounds was given. Whether " + (unknown.find(',') == std::string::npos ? "it has" : "they have") +
         " taken the place of physics that the model leaves out cannot be told without what is known of the material: give <code>prior</code>, or set "
         "<code>map.product = \"physical\"</code>.</p>\n";
  return s;
}

/// Where a density is cut.
std::string cut(const Study& study) {
  std::string where;
  for (const auto& b : broken_off(*study.posterior)) where += (where.empty() ? "" : ", ") + escape_html(b.name) + " at " + number_html(b.at, 5);
  return where.empty() ? ""
                       : "<p><strong>The draws break off: " + where +
                             ".</strong> A bound of the case, or the end of the box that the emulator was taught on, cuts the density there, so that what is "
                             "told is too narrow on that side.</p>\n";
}

/// "The records narrow density 2.9 times, ...; of young they say next to nothing."
std::string learnt(const Study& study, const ReportInput& input) {
  std::string narrowed, same;
  for (const auto& row : prior_table(study, input).rows) {
    const auto* times = std::get_if<double>(&row[5].value);
    if (!times) continue;
    const std::string name = escape_html(std::get<std::string>(row[0].value).substr(0, std::get<std::string>(row[0].value).find(" [")));
    if (*times >= clearly) narrowed += (narrowed.empty() ? "" : ", ") + name + " " + number_html(*times, *times < 10 ? 2 : 3) + " times";
    if (*times < hardly) same += (same.empty() ? "" : ", ") + name;
  }
  std::string s;
  if (!narrowed.empty()) s += "The records narrow what was known: " + narrowed + ".";
  if (!same.empty()) s += (s.empty() ? "" : " ") + std::string("Of ") + same + " they say next to nothing: what is told of it is the prior.";
  return s.empty() ? "" : "<p>" + s + "</p>\n";
}

std::string corner(const Study& study, const ReportInput& input) {
  const auto& names = study.posterior->names;
  const auto drawn = [&](const std::string& name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  const Impedance z = impedance(input);
  const bool ridge = z.ridge() && drawn(z.density) && drawn(z.sound_speed);
  return plot("corner-plot",
              std::string("Draws from the posterior. On the diagonal the density of each parameter, with its median and its 5 and 95 % quantiles; below it "
                          "every pair, with the lines within which 50 and 90 % of the "
                          "draws lie. Discs, and the marks on top of the densities, are the answers of the calibrations; an arrow on the frame points to one "
                          "that lies outside of it.") +
                  (ridge ? " The dashed line is \u03c1c = const through the median of \u03c1c." : "") +
                  (names.size() > 6 ? fmt::format(" The first 6 of {} quantities, the case\u2019s parameters before the others.", names.size()) : ""),
              "Corner plot of the posterior");
}

std::string predicted(const Study& study) {
  if (!study.predictive) return "";
  const bool errors = !study.predictive->predicted_low.empty();
  std::string s =
      "<h3>Does it follow the records?</h3>\n<p>" +
      std::string(
          errors ? "Wide band: what 90 % of the mean records lie between that the posterior predicts, with all errors that it counts: noise, gains, places of "
                   "the gauges, energy, mesh, emulator and, of the physical product, what the model leaves out. Errors go together along a "
                   "record, so that it may well lie inside all the time; much less than 90 % says that errors, or physics, are missing. The errors are those "
                   "below "
                   "the frequency up to which records are compared. "
                 : "") +
      "Narrow band: the simulations at 90 % of the draws, without any errors: what is uncertain because the parameters are." + "</p>\n";
  return s + "<div><div id=\"predictive-controls\" class=\"controls\"></div>\n<div id=\"predictive-plots\" class=\"plots\"></div></div>\n";
}

}  // namespace

std::string posterior_headline(const Study& study, const ReportInput& input) {
  if (!study.sample) return "";
  if (part_at(*study.sample, "converged") != Json(true))
    return "<p class=\"outcome\"><strong>The posterior is not to be trusted</strong>; <a href=\"#posterior\">its section</a> says why and what to do.</p>\n";
  std::string s;
  for (const auto& p : list_at(*study.sample, "parameters")) {
    const std::string name = text_at(p, "name");
    const bool own = std::any_of(input.parameters.begin(), input.parameters.end(), [&](const Parameter& q) { return q.name == name; });
    const auto low = number_at(p, "q05"), middle = number_at(p, "q50"), high = number_at(p, "q95");
    if (!(own || input.parameters.empty()) || !low || !middle || !high) continue;
    const std::string unit = parameter_unit(input, name).empty() ? "" : "\u00a0" + escape_html(parameter_unit(input, name));
    s += (s.empty() ? "" : "; ") + escape_html(name) + " <strong>" + number_html(*middle, 4) + unit + "</strong> (" + number_html(*low, 4) + " to " +
         number_html(*high, 4) + ")";
  }
  return s.empty() ? ""
                   : "<p class=\"outcome\">By the <a href=\"#posterior\">posterior</a>: " + s + ". In brackets: 90\u00a0% of the draws." +
                         (part_at(*study.sample, "final") == Json(false) ? " <strong>Not final</strong>: the warnings say why." : "") + "</p>\n";
}

std::string posterior_section(const Study& study, const ReportInput& input) {
  if (!study.sample && !study.posterior)
    return missing("No posterior has been sampled (posterior.nc, posterior.json). Sample it with " + command(input, "sample") + ".");
  std::string s;
  if (study.sample) {
    s += verdict(*study.sample) + adequacy(study, input) + absorbed(study, input);
    if (const Table t = posterior_table(study, input); !t.empty()) s += t.html();
  } else {
    s += missing("posterior.json is missing, so nothing is said of convergence.");
  }
  if (!study.posterior) return s + missing("posterior.nc is missing, so the corner plot is not drawn.");
  if (const Table t = prior_table(study, input); !t.empty()) {
    s += "<h3>What have the records taught?</h3>\n" + learnt(study, input);
    s += plot("prior-plot",
              "Before the records, grey and dashed, and after them, blue. Each curve is scaled to its own greatest value, so that both can be seen.",
              "Prior and posterior density of every parameter");
    s += folded("The same in numbers", t);
  }
  s += "<h3>Which values go together?</h3>\n" + cut(study) + corner(study, input) + published_paragraph(study, input) + predicted(study);
  s += "<h3>Have the chains converged?</h3>\n";
  s += plot("chain-plot",
            "Left: each chain\u2019s draws one after another. Chains that have converged lie upon one another and look like noise; one that stays apart, "
            "drifts or sticks has not. Right: how much more or less often than expected (dashed) the draws of a chain fall in each of 20 parts of the "
            "ranks of all draws, a strip a chain. Within the grey band of chance: the chains agree. A slope: a chain lies too high or too low. A hill or a "
            "bowl: it is too narrow or too wide.",
            "Traces and ranks of the chains");
  return s;
}

}  // namespace calomel
