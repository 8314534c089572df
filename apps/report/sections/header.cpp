#include "apps/report/sections/header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "apps/report/data/json_values.hpp"
#include "apps/report/data/quantities.hpp"
#include "apps/report/parts/elements.hpp"
#include "apps/report/parts/numbers.hpp"
#include "apps/report/sections/diagnosis.hpp"
#include "apps/report/sections/posterior.hpp"
#include "apps/report/sections/scores.hpp"

namespace calomel {

namespace {

/// "a, b and c"
Html enumeration(const std::vector<Html>& items) {
  Html s;
  for (std::size_t i = 0; i < items.size(); ++i) s += fragment(i == 0 ? "" : i + 1 == items.size() ? " and " : ", ", items[i]);
  return s;
}

/// The scores on the case's own mesh, of a calibration whose scores are corrected for the mesh; else empty.
Html own_mesh(const CalibrationArtefacts& c, const std::string& unit) {
  const Json& working = part_at(part_at(c.summary, "mesh"), "working_mesh");
  const auto mae = number_at(working, "mae");
  const auto accuracy = number_at(working, "accuracy");
  if (!mae) return {};
  return fragment(" These scores are corrected for the mesh by runs on finer meshes; on the case\u2019s own mesh it is ",
                  accuracy ? fixed_html(*accuracy, 1) + "\u00a0% and " : Html(), fixed_html(*mae, 1), "\u00a0", unit, ".");
}

/// "(nominal 18.8 unit)"
Html nominal_html(const std::optional<double>& x, const std::string& unit) {
  return x ? fragment(" (nominal ", fixed_html(*x, 1), "\u00a0", unit, ")") : Html();
}

/// The result of a calibration without an accuracy.
Html error_outcome(const CalibrationArtefacts& c, double mae, const std::string& unit) {
  const auto nominal = number_at(c.summary, "nominal_mae");
  const Html than_nominal = !nominal         ? Html()
                            : mae < *nominal ? " It is nearer to the mean record than with the nominal values."
                                             : " " + strong("It is no nearer than with the nominal values.");
  return paragraph_of("outcome", "With the parameters found by ", c.label, ", the mean absolute error of the calibrated simulation is ",
                      strong(fixed_html(mae, 1), "\u00a0", unit), nominal_html(nominal, unit), ", averaged over ",
                      std::to_string(list_at(c.summary, "sensors").size()), " sensors.", than_nominal,
                      " No sample has a band wide enough to say how often the simulation lies inside it.", own_mesh(c, unit));
}

/// The comparison of a calibration's accuracy and error with the nominal ones.
Html than_nominal(bool more, bool nearer) {
  if (more && nearer) return " Both are better than with the nominal values.";
  if (more) return " It is inside the band more often than with the nominal values, but further from the mean record.";
  if (nearer) return " It is nearer to the mean record than with the nominal values, but not more often inside the band.";
  return " " + strong("Neither is better than with the nominal values.");
}

/// The result of a calibration.
Html outcome(const CalibrationArtefacts& c, const ReportInput& input) {
  const auto accuracy = number_at(c.summary, "accuracy");
  const auto nominal_accuracy = number_at(c.summary, "nominal_accuracy");
  const auto mae = number_at(c.summary, "mae");
  const auto nominal_mae = number_at(c.summary, "nominal_mae");
  if (!mae) return paragraph(c.method, ".json holds no scores, so the quality of the fit is unknown.");
  const std::string unit = display_unit(input).name;
  if (!accuracy) return error_outcome(c, *mae, unit);
  return paragraph_of("outcome", "With the parameters found by ", c.label, ", the calibrated simulation lies inside the measured band ",
                      strong(fixed_html(*accuracy, 1), "\u00a0%"), " of the time", nominal_html(nominal_accuracy, "%"), ", and its mean absolute error is ",
                      strong(fixed_html(*mae, 1), "\u00a0", unit), nominal_html(nominal_mae, unit), ", averaged over ",
                      std::to_string(list_at(c.summary, "sensors").size()), " sensors.",
                      nominal_accuracy && nominal_mae ? than_nominal(*accuracy > *nominal_accuracy, *mae < *nominal_mae) : Html(), own_mesh(c, unit));
}

/// The kinds of calibration: tuned or physical.
Html products(const Study& study) {
  std::set<std::string> kinds;
  for (const auto& c : study.calibrations) kinds.insert(text_at(c.summary, "product"));
  Html s;
  if (kinds.contains("tuned"))
    s += paragraph(strong("Product: tuned."),
                   " The parameters make this simulation follow these records within the case\u2019s bounds; a tuned value is not a material property.");
  if (kinds.contains("physical"))
    s += paragraph(
        strong("Product: physical."),
        " Handbook priors and a discrepancy of the model were part of the calibration; the values may be read as material properties as far as those hold.");
  return s;
}

/// All warnings, each once, with the stages and methods that raised it.
std::vector<std::string> all_warnings(const Study& study, const ReportInput& input) {
  std::vector<std::string> list = input.warnings;
  std::vector<std::pair<std::string, std::string>> raised;  // the stages, the text
  const auto add = [&](const Json& summary, const std::string& from) {
    for (const auto& w : list_at(summary, "warnings")) {
      const std::string text = w.is_string() ? w.get<std::string>() : w.dump();
      if (std::find(input.warnings.begin(), input.warnings.end(), text) != input.warnings.end()) continue;
      const auto same = std::find_if(raised.begin(), raised.end(), [&](const auto& r) { return r.second == text; });
      if (same == raised.end()) {
        raised.emplace_back(from, text);
      } else {
        same->first += ", " + from;
      }
    }
  };
  if (study.campaign) add(*study.campaign, "campaign");
  if (study.train) add(*study.train, "training");
  for (const auto& c : study.calibrations) add(c.summary, c.label);
  if (study.sample) {
    add(*study.sample, "sampling");
    for (const auto& alarm : list_at(*study.sample, "absorption"))
      if (alarm.is_string()) raised.emplace_back("sampling", alarm.get<std::string>());
  }
  if (study.diagnosis) add(study.diagnosis->summary, "diagnosis");
  for (const auto& [from, text] : raised) list.push_back(from + ": " + text);
  if (study.diagnosis && text_at(study.diagnosis->summary, "status", "done") != "done")
    list.push_back("diagnosis: a fit that decides the verdict has not settled, so the verdict is not to be trusted");
  if (study.sensitivity && text_at(study.sensitivity->summary, "status", "done") != "done")
    list.push_back("sensitivity: not to be trusted: " + text_at(study.sensitivity->summary, "message", "see sensitivity.json"));
  if (study.sample && part_at(*study.sample, "converged") == Json(false)) list.push_back("sampling: " + text_at(*study.sample, "message"));
  if (study.campaign) {
    const auto runs = number_at(*study.campaign, "runs");
    const auto failed = number_at(*study.campaign, "failed");
    if (runs && failed && *failed > 0.2 * *runs)
      list.push_back(fmt::format("campaign: {} of {} runs failed, more than a fifth; results that use it are not to be trusted", *failed, *runs));
  }
  return list;
}

/// The training, with the names of its surrogates.
Html training(const Json& train) {
  std::vector<Html> names;
  for (const auto& s : list_at(train, "surrogates")) names.emplace_back(text_at(s, "name"));
  if (names.empty()) return "the training of surrogates";
  return fragment("the training of ", std::to_string(names.size()), names.size() == 1 ? " surrogate (" : " surrogates (", enumeration(names), ")");
}

Html what_was_run(const Study& study) {
  std::vector<Html> done;
  if (study.simulate) done.emplace_back("one simulation");
  if (study.campaign)
    done.push_back(fragment("a campaign of ", count_at(*study.campaign, "runs"), " simulations (", count_at(*study.campaign, "completed"), " completed)"));
  if (study.train) done.push_back(training(*study.train));
  if (study.sample)
    done.push_back(fragment("sampling of the posterior",
                            study.posterior ? fmt::format(" ({} chains of {} draws)", study.posterior->chains, study.posterior->draws) : std::string()));
  std::vector<Html> methods;
  for (const auto& c : study.calibrations) {
    const auto rounds = list_at(c.summary, "rounds").size();
    methods.push_back(fragment(c.label, rounds > 0 ? " (" + std::to_string(rounds) + " optimiser rounds)" : ""));
  }
  if (!methods.empty()) done.push_back("calibration by " + enumeration(methods));
  if (study.diagnosis) done.push_back(fragment("a diagnosis of omitted physics (", count_at(study.diagnosis->summary, "runs"), " runs of the model)"));
  if (study.sensitivity) done.push_back(fragment("an analysis of sensitivity (", count_at(study.sensitivity->summary, "evaluations"), " evaluations)"));
  return done.empty() ? Html() : paragraph("What was run: ", enumeration(done), ".");
}

/// The next step when nothing has been inferred yet.
Html next_step(const Study& study, const ReportInput& input) {
  return paragraph_of("outcome", "No calibration has been run yet, so this page shows ",
                      study.campaign || study.simulate ? "what has been simulated so far" : "only the case itself", ". The next step is ",
                      command(input, "study"), ", which runs every stage that is missing.");
}

Html load_paragraphs(const ReportInput& input) {
  Html s;
  if (!input.load_policy.empty()) s += paragraph(strong("Load:"), " ", input.load_policy);
  if (!input.deposited_energy) return s;
  const Html slice = input.slice_thickness ? fragment(" in a slice ", number_html(1e3 * *input.slice_thickness, 3), "\u00a0mm thick") : Html();
  return s + paragraph("Energy deposited by one pulse: ", number_html(*input.deposited_energy, 4), "\u00a0J", slice, ".");
}

Html warnings_html(const Study& study, const ReportInput& input) {
  Html items;
  for (const auto& w : all_warnings(study, input)) items += list_item(w);
  if (items.empty()) return {};
  return element("aside", {{"class", "warnings"}, {"aria-label", "Warnings"}}, element("h2", "Warnings"), element("ul", "\n", items)) + "\n";
}

}  // namespace

Html header_html(const Study& study, const ReportInput& input) {
  Html s = element("h1", input.case_name) + "\n" + verdict_html(study) + what_was_run(study) + posterior_headline(study, input);
  if (study.calibrations.empty() && !study.diagnosis && !study.sample && !study.sensitivity) s += next_step(study, input);
  for (const auto& c : study.calibrations) s += outcome(c, input);
  s += products(study);
  if (study.calibrations.size() > 1) s += headline_table(study, input).html();
  return s + load_paragraphs(input) + warnings_html(study, input);
}

}  // namespace calomel
