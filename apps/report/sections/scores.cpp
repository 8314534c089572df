#include "apps/report/sections/scores.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/report/data/json_values.hpp"
#include "apps/report/parts/elements.hpp"
#include "inverse/calibration/scored_mesh.hpp"

namespace calomel {

namespace {

/// Whether the score `calibrated` is as good as `nominal`, or better. An accuracy should be large and a mean absolute error small.
bool as_good(const std::string& key, double calibrated, double nominal) { return key == "mae" ? calibrated <= nominal : calibrated >= nominal; }

/// Labels of the calibrations whose simulations are corrected for the mesh.
std::vector<std::string> with_mesh(const Study& study) {
  std::vector<std::string> labels;
  for (const auto& c : study.calibrations)
    if (part_at(part_at(c.summary, "mesh"), "working_mesh").is_object()) labels.push_back(c.label);
  return labels;
}

/// A statement about each calibration whose simulations are runs on another mesh than the case's.
std::vector<std::string> on_other_mesh(const Study& study) {
  std::vector<std::string> labels;
  for (const auto& c : study.calibrations)
    if (const auto on = text_at(c.summary, "scores_on");
        !on.empty() && on != artefact_name(ScoredMesh::own) && !part_at(part_at(c.summary, "mesh"), "working_mesh").is_object())
      labels.push_back(c.label + " are runs on " + on);
  return labels;
}

/// The part of a caption of scores that names the meshes; empty when all simulations are on the case's own mesh.
std::string mesh_caption(const Study& study) {
  const auto corrected = with_mesh(study);
  const auto other = on_other_mesh(study);
  if (corrected.empty() && other.empty()) return "";
  std::string names;
  std::string s;
  for (const auto& l : corrected) names += (names.empty() ? "" : ", ") + l;
  if (!names.empty()) s = " Simulations of " + names + " and the nominal one are corrected for the mesh by runs on finer meshes";
  for (const auto& l : other) s += (s.empty() ? " Simulations of " : "; those of ") + l;
  return s + (corrected.size() + other.size() == study.calibrations.size() ? "." : "; the others are on the case\u2019s mesh.");
}

/// A note on nominal scores whose point lies outside the box in which the emulator knows the mesh; empty when there are none.
std::string nominal_note(const Study& study) {
  std::string names;
  for (const auto& c : study.calibrations)
    if (part_at(part_at(c.summary, "mesh"), "nominal_inside_emulator") == Json(false)) names += (names.empty() ? "" : ", ") + c.label;
  return names.empty() ? ""
                       : "The nominal point lies outside the emulator\u2019s box (" + names +
                             "): its correction is that of the box\u2019s nearest point, and its scores are more reliable on the case\u2019s own mesh.";
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

Table headline_table(const Study& study, const ReportInput& input) {
  const auto unit = display_unit(input);
  Table t{.id = "summary", .caption = "Whole-record scores, averaged over the sensors." + mesh_caption(study)};
  t.columns = {
      {"simulation", "Simulation", 4, true}, {"accuracy_percent", "Inside the measured band [%]", -1}, {"mae", "Mean absolute error [" + unit.name + "]", -1}};
  std::optional<double> accuracy;
  std::optional<double> mae;
  for (const auto& c : study.calibrations) {
    t.rows.push_back({"calibrated, " + c.label, number_at(c.summary, "accuracy"), number_at(c.summary, "mae")});
    if (!accuracy) {
      accuracy = number_at(c.summary, "nominal_accuracy");
      mae = number_at(c.summary, "nominal_mae");
    }
  }
  if (!t.rows.empty()) t.rows.push_back({"nominal", accuracy, mae});
  t.note = nominal_note(study);
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

  // Sensors in the order of the case, then those that only an artefact names.
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
      const auto x = number_at(j, key);
      const auto n = number_at(j, "nominal_" + key);
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

Html scores_section(const Study& study, const ReportInput& input) {
  const Table accuracy = score_table(study, input, "accuracy");
  if (accuracy.empty()) return no_calibration(input, "Sensors are scored by a calibration.");
  const Html pair = fragment(element("div", accuracy.html()), element("div", score_table(study, input, "mae").html()));
  return element("div", {{"class", "pair"}}, pair) + "\n" + shown(mesh_table(study, input));
}

}  // namespace calomel
