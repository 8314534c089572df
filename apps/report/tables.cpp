#include "apps/report/tables.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "apps/report/comparison_tables.hpp"
#include "base/json.hpp"

namespace calomel {

DisplayUnit display_unit(const ReportInput& input) { return input.unit == "strain" ? DisplayUnit{"\u00b5\u03b5", 1e6} : DisplayUnit{input.unit, 1.0}; }

std::vector<std::string> parameter_names(const Study& study, const ReportInput& input) {
  std::vector<std::string> names;
  for (const auto& p : input.parameters) names.push_back(p.name);
  if (names.empty())
    for (const auto& c : study.calibrations) {
      const Json& theta = part_at(c.summary, "theta");
      if (theta.is_object())
        for (const auto& [name, value] : theta.items())
          if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  return names;
}

std::optional<double> Impedance::at(const Json& theta) const {
  const auto value = [&](const std::string& name, const std::optional<double>& own) { return name.empty() ? own : number_at(theta, name); };
  const auto rho = value(density, density_value), c = value(sound_speed, sound_speed_value);
  return rho && c ? std::optional(*rho * *c) : std::nullopt;
}

Impedance impedance(const ReportInput& input) {
  Impedance z;
  for (const auto& p : input.parameters) {
    const std::string key = p.key.empty() ? "material.mercury." + p.name : p.key;
    if (key == "material.mercury.density") z.density = p.name;
    if (key == "material.mercury.sound_speed") z.sound_speed = p.name;
  }
  const Json& mercury = part_at(part_at(input.options, "material"), "mercury");
  z.density_value = number_at(mercury, "density");
  z.sound_speed_value = number_at(mercury, "sound_speed");
  return z;
}

std::string parameter_unit(const ReportInput& input, const std::string& parameter) {
  const auto found = std::find_if(input.parameters.begin(), input.parameters.end(), [&](const Parameter& p) { return p.name == parameter; });
  return found == input.parameters.end() || found->unit == "1" ? "" : found->unit;
}

namespace {
std::string with_unit(const std::string& name, const std::string& unit) { return unit.empty() ? name : name + " [" + unit + "]"; }
}  // namespace

std::string parameter_label(const ReportInput& input, const std::string& parameter) { return with_unit(parameter, parameter_unit(input, parameter)); }

namespace {
void add_parameter_columns(Table& table, const std::vector<std::string>& names, const ReportInput& input) {
  for (const auto& n : names) table.columns.push_back({n, parameter_label(input, n), 5});
}

/// theta is {NAME: value}, or a list in declared order.
void add_theta(std::vector<Cell>& row, const Json& theta, const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (theta.is_array())
      row.push_back(i < theta.size() && theta[i].is_number() ? Cell(theta[i].get<double>()) : Cell());
    else
      row.emplace_back(number_at(theta, names[i]));
  }
}

std::string objective_name(const Study& study) {
  for (const auto& c : study.calibrations)
    if (auto name = text_at(part_at(c.summary, "objective"), "name"); !name.empty()) return name;
  return "objective";
}

/// Whether `calibrated` is as good as `nominal`, or better; accuracy is to be large and the mean absolute error small.
bool as_good(const std::string& key, double calibrated, double nominal) { return key == "mae" ? calibrated <= nominal : calibrated >= nominal; }

/// Labels of the calibrations whose predictions carry the mesh's error.
std::vector<std::string> with_mesh(const Study& study) {
  std::vector<std::string> labels;
  for (const auto& c : study.calibrations)
    if (part_at(part_at(c.summary, "mesh"), "working_mesh").is_object()) labels.push_back(c.label);
  return labels;
}

/// Labels of the calibrations whose simulations are runs of another mesh than the case's.
std::vector<std::string> on_other_mesh(const Study& study) {
  std::vector<std::string> labels;
  for (const auto& c : study.calibrations)
    if (const auto on = text_at(c.summary, "scores_on");
        !on.empty() && on != "the case's own mesh" && !part_at(part_at(c.summary, "mesh"), "working_mesh").is_object())
      labels.push_back(c.label + " are runs on " + on);
  return labels;
}

/// What a caption of scores says of the mesh; empty where all are on the case's.
std::string mesh_caption(const Study& study) {
  const auto corrected = with_mesh(study), other = on_other_mesh(study);
  if (corrected.empty() && other.empty()) return "";
  std::string names, s;
  for (const auto& l : corrected) names += (names.empty() ? "" : ", ") + l;
  if (!names.empty()) s = " Simulations of " + names + " and the nominal one are corrected for the mesh, as the runs on finer meshes tell";
  for (const auto& l : other) s += (s.empty() ? " Simulations of " : "; those of ") + l;
  return s + (corrected.size() + other.size() == study.calibrations.size() ? "." : "; the others are on the case\u2019s mesh.");
}

/// What is said of nominal scores that are corrected beyond where the emulator knows the mesh; empty where none is.
std::string nominal_note(const Study& study) {
  std::string names;
  for (const auto& c : study.calibrations)
    if (part_at(part_at(c.summary, "mesh"), "nominal_inside_emulator") == Json(false)) names += (names.empty() ? "" : ", ") + c.label;
  return names.empty() ? ""
                       : "The nominal point lies outside the emulator\u2019s box (" + names +
                             "): its correction is that of the box\u2019s nearest point, and its scores are surer on the case\u2019s own mesh.";
}
}  // namespace

Table mesh_table(const Study& study, const ReportInput& input) {
  const auto unit = display_unit(input);
  Table t{.id = "mesh", .caption = "Scores with the correction for the mesh, and of the same runs on the case\u2019s own mesh."};
  t.columns = {{"simulation", "Simulation", 4, true},
               {"accuracy_percent", "Inside the band [%]", -1},
               {"mae", "Mean absolute error [" + unit.name + "]", -1},
               {"accuracy_working_percent", "Inside the band, case\u2019s mesh [%]", -1},
               {"mae_working", "Mean absolute error, case\u2019s mesh [" + unit.name + "]", -1},
               {"difference", "The correction changes the histories by [%]", -1, false, 100}};
  for (const auto& c : study.calibrations) {
    const Json& mesh = part_at(c.summary, "mesh");
    const Json& working = part_at(mesh, "working_mesh");
    if (!working.is_object()) continue;
    for (const std::string of : {"", "nominal_"})
      t.rows.push_back({(of.empty() ? "calibrated, " : "nominal, ") + c.label, number_at(c.summary, of + "accuracy"), number_at(c.summary, of + "mae"),
                        number_at(working, of + "accuracy"), number_at(working, of + "mae"),
                        of.empty() ? number_at(mesh, "relative_difference") : std::nullopt});
  }
  t.note = nominal_note(study);
  return t;
}

Table parameter_table(const Study& study, const ReportInput& input) {
  Table t{.id = "parameters", .caption = "Calibrated parameters beside the nominal ones."};
  t.columns = {{"parameter", "Parameter", 4, true}, {"unit", "Unit", 4, true}};
  t.columns.push_back({"nominal", "Nominal", 5});
  for (const auto& c : study.calibrations) t.columns.push_back({c.method, c.label, 5});
  const Comparison compared = comparison_of(study);
  const auto* map = study.calibration("map");
  if (map) t.columns.push_back({"map_sd", "sd by " + map->label, 3});
  for (const auto& c : study.calibrations) t.columns.push_back({c.method + "_change_percent", c.label + " against nominal [%]", -1});
  t.columns.push_back({"min", "Lower bound", 5});
  t.columns.push_back({"max", "Upper bound", 5});

  const auto nominal_of = [&](const std::string& name, const Parameter* p) -> std::optional<double> {
    if (p && p->nominal) return p->nominal;
    for (const auto& c : study.calibrations)
      if (const auto x = number_at(part_at(c.summary, "nominal"), name)) return x;
    return std::nullopt;
  };
  const auto add = [&](const std::string& name, const std::string& unit, const std::vector<std::optional<double>>& found, std::optional<double> nominal,
                       std::optional<double> low, std::optional<double> high) {
    std::vector<Cell> row{name, unit};
    row.emplace_back(nominal);
    for (const auto& x : found) row.emplace_back(x);
    const auto of =
        std::find_if(compared.parameters.begin(), compared.parameters.end(), [&](const auto& r) { return r.name == name || name.starts_with(r.name + ' '); });
    if (map) row.emplace_back(of == compared.parameters.end() ? std::nullopt : of->map_sd);
    for (const auto& x : found) row.emplace_back(x && nominal && *nominal != 0 ? std::optional(100 * (*x / *nominal - 1)) : std::nullopt);
    row.emplace_back(low);
    row.emplace_back(high);
    t.rows.push_back(std::move(row));
  };
  Json nominal_theta = Json::object();
  for (const auto& name : parameter_names(study, input)) {
    const auto at = std::find_if(input.parameters.begin(), input.parameters.end(), [&](const Parameter& p) { return p.name == name; });
    const Parameter* p = at == input.parameters.end() ? nullptr : &*at;
    std::vector<std::optional<double>> found;
    for (const auto& c : study.calibrations) found.push_back(number_at(part_at(c.summary, "theta"), name));
    const auto nominal = nominal_of(name, p);
    if (nominal) nominal_theta[name] = *nominal;
    add(name, parameter_unit(input, name), found, nominal, p ? std::optional(p->min) : std::nullopt, p ? std::optional(p->max) : std::nullopt);
  }
  const Impedance z = impedance(input);
  if (!t.rows.empty() && (!z.density.empty() || !z.sound_speed.empty())) {
    std::vector<std::optional<double>> found;
    for (const auto& c : study.calibrations) found.push_back(z.at(part_at(c.summary, "theta")));
    if (z.at(nominal_theta)) {
      add("impedance \u03c1c", "Pa\u00b7s/m", found, z.at(nominal_theta), std::nullopt, std::nullopt);
      t.note = "The impedance \u03c1c of the liquid is derived, not fitted: density and sound speed can trade against each other along \u03c1c = const.";
    }
  }
  return t;
}

Table headline_table(const Study& study, const ReportInput& input) {
  const auto unit = display_unit(input);
  Table t{.id = "summary", .caption = "Whole-record scores, averaged over the sensors." + mesh_caption(study)};
  t.columns = {
      {"simulation", "Simulation", 4, true}, {"accuracy_percent", "Inside the measured band [%]", -1}, {"mae", "Mean absolute error [" + unit.name + "]", -1}};
  std::optional<double> accuracy, mae;
  for (const auto& c : study.calibrations) {
    t.rows.push_back({"calibrated, " + c.label, number_at(c.summary, "accuracy"), number_at(c.summary, "mae")});
    if (!accuracy) accuracy = number_at(c.summary, "nominal_accuracy"), mae = number_at(c.summary, "nominal_mae");
  }
  if (!t.rows.empty()) t.rows.push_back({"nominal", accuracy, mae});
  t.note = nominal_note(study);
  return t;
}

Table sensor_table(const ReportInput& input) {
  Table t{.id = "sensors", .caption = "Sensors: where the simulation reads them, and how far that is from the declared position."};
  t.columns = {{"sensor", "Sensor", 4, true}};
  for (const char axis : {'x', 'y', 'z'}) t.columns.push_back({std::string(1, axis) + "_m", std::string(1, axis) + " [mm]", 4, false, 1e3});
  for (const char axis : {'x', 'y', 'z'}) t.columns.push_back({std::string("d") + axis, std::string("direction ") + axis, 3});
  t.columns.push_back({"moved_m", "Moved [mm]", 3, false, 1e3});
  t.columns.push_back({"gauge_length_m", "Gauge length [mm]", 3, false, 1e3});
  for (const auto& s : input.sensors) {
    std::vector<Cell> row{s.name};
    for (const double x : s.placed) row.emplace_back(x);
    for (const double x : s.direction) row.emplace_back(std::abs(x) < 1e-9 ? 0 : x);
    row.emplace_back(s.moved);
    row.emplace_back(s.gauge_length);
    t.rows.push_back(std::move(row));
  }
  return t;
}

Table score_table(const Study& study, const ReportInput& input, const std::string& key) {
  const bool mae = key == "mae";
  const auto unit = display_unit(input);
  Table t{.id = key,
          .caption =
              mae ? "Mean absolute error against the mean record [" + unit.name + "]." : "Accuracy: share of samples strictly inside the measured band [%]."};
  t.caption += mesh_caption(study);
  t.columns = {{"sensor", "Sensor", 4, true}, {"nominal", "Nominal", -1}};
  for (const auto& c : study.calibrations) t.columns.push_back({c.method, c.label, -1});

  // The order of the case, then what only an artefact names.
  std::vector<std::string> names;
  const auto add_name = [&](const std::string& n) {
    if (!n.empty() && std::find(names.begin(), names.end(), n) == names.end()) names.push_back(n);
  };
  std::set<std::string> scored;
  for (const auto& c : study.calibrations)
    for (const auto& s : list_at(c.summary, "sensors")) scored.insert(text_at(s, "name"));
  for (const auto& s : input.sensors)
    if (scored.contains(s.name)) add_name(s.name);
  for (const auto& c : study.calibrations)
    for (const auto& s : list_at(c.summary, "sensors")) add_name(text_at(s, "name"));

  const auto row_of = [&](const std::string& title, auto&& part) {
    std::vector<Cell> row{Cell(title), Cell()};
    std::optional<double> nominal;
    for (const auto& c : study.calibrations) {
      const Json& j = part(c);
      const auto x = number_at(j, key), n = number_at(j, "nominal_" + key);
      if (!nominal) nominal = n;
      row.emplace_back(x, x && n && as_good(key, *x, *n));
    }
    row[1] = Cell(nominal);
    return row;
  };
  for (const auto& name : names)
    t.rows.push_back(row_of(name, [&](const CalibrationArtefacts& c) -> const Json& {
      static const Json nothing;
      for (const auto& s : list_at(c.summary, "sensors"))
        if (text_at(s, "name") == name) return s;
      return nothing;
    }));
  if (!t.rows.empty()) {
    t.footer = row_of("Average", [](const CalibrationArtefacts& c) -> const Json& { return c.summary; });
    t.note = mae ? "Bold: the calibrated simulation is as near to the mean record as the nominal one, or nearer."
                 : "Bold: the calibrated simulation is inside the band as often as the nominal one, or more often.";
    if (const auto note = nominal_note(study); !note.empty()) t.note += " " + note;
  }
  return t;
}

Table optimizer_table(const Study& study) {
  const auto* enc = study.calibration("enc");
  Table t{.id = "optimizers", .caption = "Best " + objective_name(study) + " of each round, by optimiser (on the surrogate)."};
  t.columns = {{"optimizer", "Optimiser", 4, true}, {"rounds", "Rounds", 4}, {"mean", "Mean", 5}, {"sd", "Standard deviation", 3}, {"best", "Best", 5}};
  if (enc)
    for (const auto& o : list_at(enc->summary, "optimizers"))
      t.rows.push_back({text_at(o, "name"), number_at(o, "rounds"), number_at(o, "mean"), number_at(o, "sd"), number_at(o, "best")});
  return t;
}

Table candidate_table(const Study& study, const ReportInput& input) {
  const auto names = parameter_names(study, input);
  const Impedance z = impedance(input);
  Table t{.id = "candidates",
          .caption =
              "Candidates, each run again in the true model. Bold: the answer, the best by the true model; of MAP the emulator\u2019s mode, which the run "
              "verifies."};
  t.columns = {{"method", "Method", 4, true}, {"candidate", "Candidate", 4}};
  add_parameter_columns(t, names, input);
  const bool impedance_known = !z.density.empty() || !z.sound_speed.empty();
  if (impedance_known) t.columns.push_back({"impedance", "\u03c1c [Pa\u00b7s/m]", 4});
  t.columns.push_back({"objective_surrogate", "Objective, surrogate", 5});
  t.columns.push_back({"objective_model", "Objective, true model", 5});
  for (const auto& c : study.calibrations) {
    const auto& list = list_at(c.summary, "candidates");
    const bool maximise = text_at(part_at(c.summary, "objective"), "sense", "maximise") != "minimise";
    std::optional<double> best;
    for (const auto& x : list)
      if (const auto v = number_at(x, "objective_model"); v && (!best || (maximise ? *v > *best : *v < *best))) best = v;
    double n = 0;
    for (const auto& x : list) {
      std::vector<Cell> row{c.label, ++n};
      add_theta(row, part_at(x, "theta"), names);
      if (impedance_known) row.emplace_back(z.at(part_at(x, "theta")));
      row.emplace_back(number_at(x, "objective_surrogate"));
      row.emplace_back(number_at(x, "objective_model"));
      if (c.method == "map" ? n == 1 : best && number_at(x, "objective_model") == best)
        for (auto& cell : row) cell.strong = true;
      t.rows.push_back(std::move(row));
    }
  }
  return t;
}

Table round_table(const Study& study, const ReportInput& input) {
  const auto names = parameter_names(study, input);
  Table t{.id = "rounds", .caption = "Every round's best point on the surrogate."};
  t.columns = {{"round", "Round", 4}, {"optimizer", "Optimiser", 4, true}};
  add_parameter_columns(t, names, input);
  t.columns.push_back({"objective", "Objective", 5});
  double n = 0;
  if (const auto* enc = study.calibration("enc"))
    for (const auto& r : list_at(enc->summary, "rounds")) {
      std::vector<Cell> row{++n, text_at(r, "optimizer")};
      add_theta(row, part_at(r, "theta"), names);
      row.emplace_back(number_at(r, "objective"));
      t.rows.push_back(std::move(row));
    }
  return t;
}

Table convergence_table(const Study& study) {
  Table t{.id = "convergence", .caption = "Best objective so far, by generation, in the best round of each optimiser."};
  t.columns = {{"optimizer", "Optimiser", 4, true}, {"generation", "Generation", 6}, {"objective", "Best objective so far", 6}};
  if (const auto* enc = study.calibration("enc"))
    for (const auto& o : list_at(enc->summary, "optimizers")) {
      double generation = 0;
      for (const auto& x : list_at(o, "trace")) t.rows.push_back({text_at(o, "name"), generation++, x.is_number() ? Cell(x.get<double>()) : Cell()});
    }
  return t;
}

Table surrogate_table(const Study& study, const ReportInput& input) {
  const auto unit = display_unit(input);
  Table t{.id = "surrogates", .caption = "Surrogates of the simulation, scored on runs that they were not trained on."};
  t.columns = {{"surrogate", "Surrogate", 4, true},
               {"kind", "Kind", 4, true},
               {"n_train", "Training runs", 6},
               {"n_test", "Test runs", 6},
               {"mae", "Mean absolute error [" + unit.name + "]", 4},
               {"rmse", "Root mean square error [" + unit.name + "]", 4},
               {"r2", "R\u00b2", 5}};
  const auto shown = [&](const std::optional<double>& x) { return x ? std::optional(unit.factor * *x) : std::nullopt; };
  if (study.train)
    for (const auto& s : list_at(*study.train, "surrogates"))
      t.rows.push_back({text_at(s, "name"), text_at(s, "kind"), number_at(s, "n_train"), number_at(s, "n_test"), shown(number_at(s, "mae")),
                        shown(number_at(s, "rmse")), number_at(s, "r2")});
  if (!t.rows.empty()) t.note = "R\u00b2 is pooled over all outputs: 1 \u2212 \u03a3 error\u00b2 / \u03a3 (value \u2212 mean over runs)\u00b2.";
  return t;
}

Table loss_table(const Study& study) {
  Table t{.id = "training_loss", .caption = "Training loss by epoch."};
  t.columns = {{"surrogate", "Surrogate", 4, true}, {"epoch", "Epoch", 6}, {"train_loss", "Training loss", 5}, {"test_loss", "Test loss", 5}};
  if (study.train)
    for (const auto& s : list_at(*study.train, "surrogates")) {
      const auto &train = list_at(s, "train_loss"), &test = list_at(s, "test_loss");
      for (std::size_t i = 0; i < std::max(train.size(), test.size()); ++i) {
        const auto at = [&](const Json& list) { return i < list.size() && list[i].is_number() ? Cell(list[i].get<double>()) : Cell(); };
        t.rows.push_back({text_at(s, "name"), double(i + 1), at(train), at(test)});
      }
    }
  return t;
}

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

}  // namespace calomel
