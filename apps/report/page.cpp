#include "apps/report/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "apps/report/comparison_tables.hpp"
#include "apps/report/diagnosis_tables.hpp"
#include "apps/report/emulator_tables.hpp"
#include "apps/report/floor_tables.hpp"
#include "apps/report/html.hpp"
#include "apps/report/posterior.hpp"
#include "apps/report/sensitivity.hpp"
#include "apps/report/spe_tables.hpp"
#include "apps/report/tables.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"

namespace calomel {

namespace {
std::string count(const Json& json, const std::string& key) {
  const auto x = number_at(json, key);
  return x ? number_html(*x, 6) : "an unknown number of";
}

/// "a, b and c"
std::string enumeration(const std::vector<std::string>& words) {
  std::string s;
  for (std::size_t i = 0; i < words.size(); ++i) s += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  return s;
}

/// Which mesh the scores of a calibration are on; nothing where it was not corrected for it.
std::string on_mesh(const CalibrationArtefacts& c, const std::string& unit) {
  const Json& working = part_at(part_at(c.summary, "mesh"), "working_mesh");
  const auto mae = number_at(working, "mae"), accuracy = number_at(working, "accuracy");
  if (!mae) return "";
  return fmt::format(" These scores are corrected for the mesh, as the runs on finer meshes tell; on the case\u2019s own mesh it is {}{}\u00a0{}.",
                     accuracy ? fixed_html(*accuracy, 1) + "\u00a0% and " : "", fixed_html(*mae, 1), unit);
}

std::string outcome(const CalibrationArtefacts& c, const ReportInput& input) {
  const auto accuracy = number_at(c.summary, "accuracy"), nominal_accuracy = number_at(c.summary, "nominal_accuracy");
  const auto mae = number_at(c.summary, "mae"), nominal_mae = number_at(c.summary, "nominal_mae");
  if (!mae) return fmt::format("<p>{}.json holds no scores, so nothing can be said of how well the calibration fits.</p>\n", c.method);
  const std::string unit = escape_html(display_unit(input).name);
  const auto against = [](const std::optional<double>& x, const std::string& of) { return x ? " (nominal " + fixed_html(*x, 1) + of + ")" : std::string(); };
  if (!accuracy) {
    const char* than_nominal = !nominal_mae          ? ""
                               : *mae < *nominal_mae ? " It is nearer to the mean record than with the nominal values."
                                                     : " <strong>It is no nearer than with the nominal values.</strong>";
    return fmt::format(
        "<p class=\"outcome\">With the parameters found by {}, the mean absolute error of the calibrated simulation is <strong>{}\u00a0{}</strong>{}, averaged "
        "over {} "
        "sensors.{} No sample has a band wide enough to say how often the simulation lies inside it.{}</p>\n",
        escape_html(c.label), fixed_html(*mae, 1), unit, against(nominal_mae, "\u00a0" + unit), list_at(c.summary, "sensors").size(), than_nominal,
        on_mesh(c, unit));
  }
  std::string s = fmt::format(
      "<p class=\"outcome\">With the parameters found by {}, the calibrated simulation lies inside the measured band <strong>{}\u00a0%</strong> of the time{}, "
      "and its mean absolute error is <strong>{}\u00a0{}</strong>{}, averaged over {} sensors.",
      escape_html(c.label), fixed_html(*accuracy, 1), against(nominal_accuracy, "\u00a0%"), fixed_html(*mae, 1), unit, against(nominal_mae, "\u00a0" + unit),
      list_at(c.summary, "sensors").size());
  if (nominal_accuracy && nominal_mae) {
    const bool more = *accuracy > *nominal_accuracy, nearer = *mae < *nominal_mae;
    s += more && nearer ? " Both are better than with the nominal values."
         : more         ? " It is inside the band more often than with the nominal values, but further from the mean record."
         : nearer       ? " It is nearer to the mean record than with the nominal values, but not more often inside the band."
                        : " <strong>Neither is better than with the nominal values.</strong>";
  }
  return s + on_mesh(c, unit) + "</p>\n";
}

std::string product(const Study& study) {
  std::set<std::string> kinds;
  for (const auto& c : study.calibrations) kinds.insert(text_at(c.summary, "product"));
  std::string s;
  if (kinds.contains("tuned"))
    s += "<p><strong>Product: tuned.</strong> The parameters make this simulation follow these records within the case\u2019s bounds; a tuned value is "
         "not a material property.</p>\n";
  if (kinds.contains("physical"))
    s += "<p><strong>Product: physical.</strong> Handbook priors and a discrepancy of the model were part of the calibration; the values may be read as "
         "material properties as far as those hold.</p>\n";
  return s;
}

/// Each warning once, with the stages and methods that gave it.
std::vector<std::string> all_warnings(const Study& study, const ReportInput& input) {
  std::vector<std::string> list = input.warnings;
  std::vector<std::pair<std::string, std::string>> told;  // the stages, the text
  const auto add = [&](const Json& summary, const std::string& from) {
    for (const auto& w : list_at(summary, "warnings")) {
      const std::string text = w.is_string() ? w.get<std::string>() : w.dump();
      if (std::find(input.warnings.begin(), input.warnings.end(), text) != input.warnings.end()) continue;
      const auto same = std::find_if(told.begin(), told.end(), [&](const auto& t) { return t.second == text; });
      if (same == told.end())
        told.emplace_back(from, text);
      else
        same->first += ", " + from;
    }
  };
  if (study.campaign) add(*study.campaign, "campaign");
  if (study.train) add(*study.train, "training");
  for (const auto& c : study.calibrations) add(c.summary, c.label);
  if (study.sample) {
    add(*study.sample, "sampling");
    for (const auto& alarm : list_at(*study.sample, "absorption"))
      if (alarm.is_string()) told.emplace_back("sampling", alarm.get<std::string>());
  }
  if (study.diagnosis) add(study.diagnosis->summary, "diagnosis");
  for (const auto& [from, text] : told) list.push_back(from + ": " + text);
  if (study.diagnosis && text_at(study.diagnosis->summary, "status", "done") != "done")
    list.push_back("diagnosis: a fit on which the verdict hangs has not settled, so it is not to be trusted");
  if (study.sensitivity && text_at(study.sensitivity->summary, "status", "done") != "done")
    list.push_back("sensitivity: not to be trusted: " + text_at(study.sensitivity->summary, "message", "see sensitivity.json"));
  if (study.sample && part_at(*study.sample, "converged") == Json(false)) list.push_back("sampling: " + text_at(*study.sample, "message"));
  if (study.campaign) {
    const auto runs = number_at(*study.campaign, "runs"), failed = number_at(*study.campaign, "failed");
    if (runs && failed && *failed > 0.2 * *runs)
      list.push_back(fmt::format("campaign: {} of {} runs failed, more than a fifth; what is built on it is not to be trusted", *failed, *runs));
  }
  return list;
}

std::string what_was_run(const Study& study) {
  std::vector<std::string> done;
  if (study.simulate) done.push_back("one simulation");
  if (study.campaign)
    done.push_back("a campaign of " + count(*study.campaign, "runs") + " simulations (" + count(*study.campaign, "completed") + " completed)");
  if (study.train) {
    std::vector<std::string> names;
    for (const auto& s : list_at(*study.train, "surrogates")) names.push_back(escape_html(text_at(s, "name")));
    done.push_back(names.empty()
                       ? "the training of surrogates"
                       : "the training of " + std::to_string(names.size()) + (names.size() == 1 ? " surrogate (" : " surrogates (") + enumeration(names) + ")");
  }
  std::vector<std::string> methods;
  for (const auto& c : study.calibrations) {
    const auto rounds = list_at(c.summary, "rounds").size();
    methods.push_back(c.label + (rounds > 0 ? " (" + std::to_string(rounds) + " optimiser rounds)" : ""));
  }
  if (study.sample)
    done.push_back("sampling of the posterior" +
                   (study.posterior ? fmt::format(" ({} chains of {} draws)", study.posterior->chains, study.posterior->draws) : std::string()));
  if (!methods.empty()) done.push_back("calibration by " + enumeration(methods));
  if (study.diagnosis) done.push_back("a diagnosis of omitted physics (" + count(study.diagnosis->summary, "runs") + " runs of the model)");
  if (study.sensitivity) done.push_back("an analysis of sensitivity (" + count(study.sensitivity->summary, "evaluations") + " evaluations)");
  return done.empty() ? "" : "<p>What was run: " + enumeration(done) + ".</p>\n";
}

std::string section(const std::string& id, const std::string& title, const std::string& body) {
  return fmt::format("<section id=\"{0}\" aria-labelledby=\"{0}-title\">\n<h2 id=\"{0}-title\">{1}</h2>\n{2}</section>\n", id, title, body);
}

std::string no_calibration(const ReportInput& input, const std::string& lead) {
  return missing(lead, "There is no calibration yet (enc.json, spe.json or map.json). Make one with " + command(input, "calibrate", "--method enc") + ".");
}

std::string target_section(const ReportInput& input) {
  std::string s;
  if (input.outer.empty() && input.sensors.empty())
    return missing("Of this model neither a surface nor the places of its sensors are known, so there is nothing to draw.", "");
  s += "<div class=\"target\"><div id=\"target-view\" class=\"target-view\" role=\"img\" aria-label=\"The target with its sensors; the table below gives the "
       "positions\"></div>"
       "<p class=\"note\" id=\"target-note\">Drag to turn, scroll to zoom. Arrows show the direction in which each sensor measures strain.</p></div>\n";
  if (input.outer.empty()) s += missing("The model gives no surface (an outside model has none), so only the sensors are drawn.", "");
  return s + sensor_table(input).html();
}

std::string history_section(const Study& study, const ReportInput& input) {
  const bool traces =
      study.simulation || std::any_of(study.calibrations.begin(), study.calibrations.end(), [](const auto& c) { return c.histories.has_value(); });
  if (!traces)
    return missing("There are no time histories yet (enc.nc, spe.nc, map.nc or simulate.nc).",
                   "Make them with " + command(input, "calibrate", "--method enc") + " or " + command(input, "simulate") + ".");
  std::string s;
  for (const auto& c : study.calibrations)
    if (!c.histories)
      s += missing(escape_html(c.method) + ".nc is missing, so the histories of " + escape_html(c.label) + " are not drawn.",
                   "Make it with " + command(input, "calibrate", "--method " + c.method + " --fresh") + ".");
  s += "<p>Strain is positive in tension; time 0 is the start of the pulse. Drag across a plot to zoom in time: all plots follow. "
       "Double-click, or the button, shows everything again. A trace is switched on and off in the legend. "
       "Beside each name stand the share of samples inside the band and the mean absolute error.</p>\n"
       "<div id=\"history-controls\" class=\"controls\"></div>\n<div id=\"histories-plots\" class=\"plots\"></div>\n";
  return s;
}

std::string score_section(const Study& study, const ReportInput& input) {
  const Table accuracy = score_table(study, input, "accuracy"), mae = score_table(study, input, "mae");
  if (accuracy.empty()) return no_calibration(input, "Sensors are scored by a calibration.");
  const Table mesh = mesh_table(study, input);
  return "<div class=\"pair\"><div>" + accuracy.html() + "</div><div>" + mae.html() + "</div></div>\n" + (mesh.empty() ? "" : mesh.html());
}

std::string optimizer_comparison_section(const Study& study) {
  const Json figures = decay_json(study);
  std::string s;
  for (std::size_t i = 0; i < figures.size(); ++i)
    s += plot("decay-plot-" + std::to_string(i),
              "Best value so far against evaluations on " + escape_html(figures[i]["title"].get<std::string>()) +
                  ": mean of the trials, shaded three standard deviations to either side, cut at the frame.",
              "Decay of the optimisers");
  if (const Table t = trial_table(study); !t.empty()) s += t.html();
  return s;
}

std::string convergence_section(const Study& study, const ReportInput& input) {
  const std::string compared = optimizer_comparison_section(study);
  const auto* enc = study.calibration("enc");
  if (!enc)
    return compared + missing("Optimiser rounds belong to the evolutionary neural calibration, which has not been run (enc.json).",
                              "Run it with " + command(input, "calibrate", "--method enc") + ".");
  std::string s;
  const Table table = optimizer_table(study);
  if (!convergence_table(study).empty())
    s += plot("convergence-plot", "Best objective so far by generation, in the best round of each optimiser.", "Convergence of each optimiser");
  else
    s += missing("enc.json holds no traces of the optimisers.", "");
  if (const Table optimizers = optimizer_agreement_table(study); !optimizers.empty())
    s += optimizers.html();
  else if (!table.empty())
    s += table.html();
  if (const Table formulations = formulation_table(study, input); !formulations.empty()) s += formulations.html();
  return s + compared;
}

std::string candidate_section(const Study& study, const ReportInput& input) {
  if (study.calibrations.empty()) return no_calibration(input, "Candidates come from a calibration.");
  std::string s;
  const Table table = candidate_table(study, input);
  s += table.empty() ? missing("No candidates are listed in the calibration.", "") : table.html();
  const Impedance z = impedance(input);
  if (!z.ridge())
    s += "<p class=\"note\">Density and sound speed of the liquid are not both calibrated here, so there is no \u03c1\u2013c ridge to show.</p>\n";
  else if (!study.calibration("enc"))
    s += missing("The \u03c1\u2013c ridge is drawn from the rounds of enc.json, which is missing.",
                 "Make it with " + command(input, "calibrate", "--method enc") + ".");
  else
    s += plot("ridge-plot",
              "Every round\u2019s best density and sound speed, coloured by the objective on the surrogate. The line is \u03c1c = const through the calibrated "
              "point: rounds that lie along it are told apart poorly by these records.",
              "Scatter of density and sound speed with the line of constant impedance");
  const Table rounds = round_table(study, input);
  return s + folded("All " + std::to_string(rounds.rows.size()) + " rounds", rounds);
}

/// What SPE's own surrogates are worth; empty where it has not been run.
std::string polynomial_section(const Study& study, const ReportInput& input) {
  std::string s;
  if (const Table t = polynomial_error_table(study); !t.empty()) s += t.html();
  if (const Table t = lambda_table(study); !t.empty()) s += t.html();
  if (const Table t = mode_table(study, input); !t.empty()) s += t.html();
  const Table polynomials = polynomial_table(study);
  return s + folded("All " + std::to_string(polynomials.rows.size()) + " polynomial surrogates", polynomials);
}

std::string surrogate_section(const Study& study, const ReportInput& input) {
  const std::string polynomials = polynomial_section(study, input);
  if (!study.train) return polynomials + missing("No surrogate has been trained (train.json).", "Train one with " + command(input, "train") + ".");
  const Table table = surrogate_table(study, input);
  std::string s = table.empty() ? missing("train.json lists no surrogates.", "") : table.html();
  if (!loss_table(study).empty())
    s +=
        plot("loss-plot",
             "Training and test loss by epoch, logarithmic. Losses of different networks are of different quantities: compare their shapes, not their heights.",
             "Training loss");
  return s + polynomials;
}

std::string campaign_section(const Study& study, const ReportInput& input) {
  if (!study.campaign && !study.runs)
    return missing("No campaign has been run (campaign.json, campaign.nc).", "Run it with " + command(input, "campaign") + ".");
  std::string s;
  if (study.campaign) {
    const Json& j = *study.campaign;
    s += "<p>" + count(j, "runs") + " runs were planned: " + count(j, "completed") + " completed, " + count(j, "failed") + " failed, " + count(j, "reused") +
         " were taken from an earlier call.";
    if (const auto wall = number_at(j, "wall_s")) s += " The last call took " + number_html(*wall, 3) + " s.";
    s += "</p>\n";
  } else {
    s += missing("campaign.json is missing.", "");
  }
  if (!study.runs) return s + missing("campaign.nc is missing, so the design is not drawn.", "Make it with " + command(input, "campaign") + ".");
  s += plot("design-plot", "Design: the parameters of every run, each pair of them. Failed runs are crosses.", "Scatter of the campaign's design");
  if (const Table t = failure_table(study, 50); !t.empty()) s += t.html();
  if (const Table t = scatter_table(study, input); !t.empty()) s += t.html();
  return s;
}

std::string provenance_section(const Study& study, const ReportInput& input) {
  Table t{.id = "provenance", .caption = "Artefacts of this report."};
  t.columns = {{"stage", "Stage", 4, true},
               {"version", "Version", 4, true},
               {"seed", "Seed", 12},
               {"identity", "Identity", 4, true},
               {"inputs", "Hashes of the inputs", 4, true}};
  std::string details;
  const auto add = [&](const std::string& stage, const std::optional<Json>& summary) {
    if (!summary) return;
    const Json& p = part_at(*summary, "provenance");
    std::string inputs;
    if (const Json& list = part_at(p, "inputs"); list.is_object())
      for (const auto& [name, hash] : list.items())
        inputs += (inputs.empty() ? "" : ", ") + name + " " + (hash.is_string() ? hash.get<std::string>() : hash.dump());
    t.rows.push_back({stage, text_at(p, "version"), number_at(p, "seed"), text_at(p, "identity"), inputs});
    if (p.is_object() && p.contains("options"))
      details += "<details><summary>Options of " + escape_html(stage) + "</summary><pre>" + escape_html(p["options"].dump(2)) + "</pre></details>\n";
  };
  add("simulate", study.simulate);
  add("campaign", study.campaign);
  add("train", study.train);
  for (const auto& c : study.calibrations) add(c.method, c.summary);
  add("sample", study.sample);
  if (study.diagnosis) add("diagnosis", study.diagnosis->summary);
  if (study.sensitivity) add("sensitivity", study.sensitivity->summary);
  return fmt::format("<p>Written by calomel {}; seed {}. Equal options, seed and inputs give equal artefacts.</p>\n", escape_html(version), input.seed) +
         (t.empty() ? missing("No stage has written an artefact yet.", "Run them all with " + command(input, "study") + ".") : t.html()) +
         "<details><summary>Resolved options of the case</summary><pre>" + escape_html(input.options.dump(2)) + "</pre></details>\n" + details;
}
}  // namespace

std::string header_html(const Study& study, const ReportInput& input) {
  std::string s = "<h1>" + escape_html(input.case_name) + "</h1>\n" + verdict_html(study);
  const auto warnings = all_warnings(study, input);
  s += what_was_run(study);
  s += posterior_headline(study, input);
  if (study.calibrations.empty() && !study.diagnosis && !study.sample && !study.sensitivity)
    s += "<p class=\"outcome\">No calibration has been run yet, so this page shows " +
         std::string(study.campaign || study.simulate ? "what has been simulated so far" : "only the case itself") + ". The next step is " +
         command(input, "study") + ", which runs every stage that is missing.</p>\n";
  for (const auto& c : study.calibrations) s += outcome(c, input);
  s += product(study);
  if (study.calibrations.size() > 1) s += headline_table(study, input).html();
  if (!input.load_policy.empty()) s += "<p><strong>Load:</strong> " + escape_html(input.load_policy) + "</p>\n";
  if (input.deposited_energy)
    s += "<p>Energy deposited by one pulse: " + number_html(*input.deposited_energy, 4) + "\u00a0J" +
         (input.slice_thickness ? " in a slice " + number_html(1e3 * *input.slice_thickness, 3) + "\u00a0mm thick" : "") + ".</p>\n";
  if (!warnings.empty()) {
    s += "<aside class=\"warnings\" aria-label=\"Warnings\"><h2>Warnings</h2><ul>\n";
    for (const auto& w : warnings) s += "<li>" + escape_html(w) + "</li>\n";
    s += "</ul></aside>\n";
  }
  return s;
}

std::string sections_html(const Study& study, const ReportInput& input) {
  const Table parameters = parameter_table(study, input);
  std::string first = parameters.empty()
                          ? missing("The case has no parameters to infer.", "Add a table <code>[parameter.NAME]</code> with min and max to the case file.")
                          : parameters.html();
  if (study.calibrations.empty() && !parameters.empty()) first += no_calibration(input, "Only nominal values and bounds are known.");
  for (const Table& t : {agreement_table(study), place_table(study), hypothesis_table(study), effort_table(study)})
    if (!t.empty()) first += t.html();
  const std::string emulator = emulator_section(study);
  const std::string diagnosis = diagnosis_section(study, input);
  return (diagnosis.empty() ? "" : section("diagnosis", "What the simulation leaves out", diagnosis)) + section("parameters", "Parameters", first) +
         (emulator.empty() ? "" : section("emulator", "What the answer stands on", emulator)) + section("target", "Target and sensors", target_section(input)) +
         section("histories", "Measured and simulated histories", history_section(study, input)) +
         section("scores", "Accuracy and error by sensor", score_section(study, input)) +
         section("convergence", "Convergence of the optimisers", convergence_section(study, input)) +
         section("candidates", "Candidates and the \u03c1\u2013c ridge", candidate_section(study, input)) +
         section("posterior", "Posterior", posterior_section(study, input)) + section("sensitivity", "Sensitivity", sensitivity_section(study, input)) +
         section("surrogate", "Surrogate quality", surrogate_section(study, input)) + section("campaign", "Campaign", campaign_section(study, input)) +
         section("floor", "Repeatability floor", floor_section(study, input, "Measure it with " + command(input, "check", "--floor") + ".")) +
         section("provenance", "Provenance", provenance_section(study, input));
}

}  // namespace calomel
