#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/report/chains.hpp"
#include "apps/report/comparison_tables.hpp"
#include "apps/report/diagnosis_tables.hpp"
#include "apps/report/page.hpp"
#include "apps/report/posterior.hpp"
#include "apps/report/sensitivity.hpp"
#include "apps/report/surface.hpp"
#include "apps/report/tables.hpp"
#include "apps/report/traces.hpp"
#include "base/json.hpp"

namespace calomel {

namespace {
Json surface_json(const ReportSurface& full, std::size_t quads) {
  if (full.empty()) return nullptr;
  const ReportSurface s = thinned(full, quads);
  Json vertices = Json::array(), faces = Json::array();
  for (const auto& v : s.vertices)
    for (const double x : v) vertices.push_back(rounded(x, 5));
  for (const auto& q : s.quads)
    for (const auto i : q) faces.push_back(i);
  return {{"vertices", std::move(vertices)}, {"quads", std::move(faces)}, {"thinned", s.quads.size() < full.quads.size()}};
}

Json vector_json(const Vec3& v) { return Json::array({rounded(v[0], 6), rounded(v[1], 6), rounded(v[2], 6)}); }

Json target_json(const ReportInput& input, std::size_t quads) {
  if (input.outer.empty() && input.sensors.empty()) return nullptr;
  Json sensors = Json::array();
  for (const auto& s : input.sensors) sensors.push_back({{"name", s.name}, {"position", vector_json(s.placed)}, {"direction", vector_json(s.direction)}});
  return {{"outer", surface_json(input.outer, quads)}, {"wetted", surface_json(input.wetted, quads / 3)}, {"sensors", std::move(sensors)}};
}

/// Every k-th, so that at most `most` stay.
std::size_t stride(std::size_t n, std::size_t most) { return most == 0 ? n + 1 : std::max<std::size_t>(1, (n + most - 1) / most); }

std::string lower_first(std::string text) {
  if (!text.empty() && text[0] >= 'A' && text[0] <= 'Z') text[0] = char(text[0] - 'A' + 'a');
  return text;
}

/// Lines of one group share a colour and those of one variant a dash.
Json lines_json(const Table& table, const std::vector<std::size_t>& value_columns) {
  // Rows are (name, x, y, ...): one line for each name and value column, in the order in which they come.
  Json lines = Json::array();
  std::vector<std::string> names;
  for (std::size_t variant = 0; variant < value_columns.size(); ++variant) {
    const auto column = value_columns[variant];
    std::string name;
    Json* line = nullptr;
    for (const auto& row : table.rows) {
      const auto* x = std::get_if<double>(&row[1].value);
      const auto* y = std::get_if<double>(&row[column].value);
      if (!x || !y) continue;
      const auto& row_name = std::get<std::string>(row[0].value);
      if (!line || row_name != name) {
        name = row_name;
        const std::string label = value_columns.size() > 1 ? name + ", " + lower_first(table.columns[column].title) : name;
        auto at = std::find(names.begin(), names.end(), name);
        if (at == names.end()) at = names.insert(at, name);
        lines.push_back({{"label", label},
                         {"group", at - names.begin()},
                         {"variant", value_columns.size() > 1 ? variant : std::size_t(at - names.begin())},
                         {"x", Json::array()},
                         {"y", Json::array()}});
        line = &lines.back();
      }
      (*line)["x"].push_back(rounded(*x, 6));
      (*line)["y"].push_back(rounded(*y, 5));
    }
  }
  return lines;
}

Json ridge_json(const Study& study, const ReportInput& input, std::size_t points) {
  const Impedance z = impedance(input);
  const auto* enc = study.calibration("enc");
  if (!z.ridge() || !enc) return nullptr;
  const auto names = parameter_names(study, input);
  const auto value = [&](const Json& theta, const std::string& name) -> std::optional<double> {
    if (!theta.is_array()) return number_at(theta, name);
    const auto i = std::size_t(std::find(names.begin(), names.end(), name) - names.begin());
    return i < theta.size() && theta[i].is_number() ? std::optional(theta[i].get<double>()) : std::nullopt;
  };
  Json list = Json::array();
  const auto& rounds = list_at(enc->summary, "rounds");
  const auto step = stride(rounds.size(), points);
  for (std::size_t i = 0; i < rounds.size(); i += step) {
    const auto rho = value(part_at(rounds[i], "theta"), z.density), c = value(part_at(rounds[i], "theta"), z.sound_speed);
    const auto objective = number_at(rounds[i], "objective");
    if (rho && c && objective) list.push_back({rounded(*rho, 5), rounded(*c, 5), rounded(*objective, 5), text_at(rounds[i], "optimizer")});
  }
  Json marks = Json::array();
  for (const auto& c : study.calibrations) {
    const Json& theta = part_at(c.summary, "theta");
    if (const auto rho = number_at(theta, z.density), speed = number_at(theta, z.sound_speed); rho && speed)
      marks.push_back({{"label", c.label}, {"x", rounded(*rho, 6)}, {"y", rounded(*speed, 6)}});
  }
  Json nominal;
  const Json& theta = part_at(enc->summary, "nominal");
  if (const auto rho = number_at(theta, z.density), speed = number_at(theta, z.sound_speed); rho && speed)
    marks.push_back({{"label", "nominal"}, {"x", rounded(*rho, 6)}, {"y", rounded(*speed, 6)}});
  const auto best = z.at(part_at(enc->summary, "theta"));
  return {{"points", std::move(list)},
          {"marks", std::move(marks)},
          {"product", best ? rounded(*best, 6) : Json()},
          {"x_label", parameter_label(input, z.density)},
          {"y_label", parameter_label(input, z.sound_speed)},
          {"value_label", text_at(part_at(enc->summary, "objective"), "name", "objective")},
          {"minimise", text_at(part_at(enc->summary, "objective"), "sense") == "minimise"}};
}

/// What stands beside a sensor's plot: its scores by method, and nominal.
Json score_lines(const Study& study, const ReportInput& input) {
  Json lines = Json::object();
  const std::string unit = display_unit(input).name;
  const auto add = [&](const std::string& sensor, const std::string& who, const std::optional<double>& accuracy, const std::optional<double>& mae) {
    if (!mae) return;
    std::string text = lines.contains(sensor) ? lines[sensor].get<std::string>() + "; " : "";
    lines[sensor] = text + who + (accuracy ? fmt::format(" {:.1f}\u00a0%,", *accuracy) : "") + fmt::format(" {:.1f}\u00a0{}", *mae, unit);
  };
  for (const auto& c : study.calibrations)
    for (const auto& s : list_at(c.summary, "sensors")) add(text_at(s, "name"), c.label, number_at(s, "accuracy"), number_at(s, "mae"));
  if (!study.calibrations.empty())
    for (const auto& s : list_at(study.calibrations.front().summary, "sensors"))
      add(text_at(s, "name"), "nominal", number_at(s, "nominal_accuracy"), number_at(s, "nominal_mae"));
  return lines;
}

Json design_json(const Study& study, const ReportInput& input, std::size_t points) {
  if (!study.runs || study.runs->runs() == 0) return nullptr;
  const auto& r = *study.runs;
  Json names = Json::array(), done = Json::array(), failed = Json::array(), bounds = Json::array();
  for (const auto& p : r.parameters) {
    names.push_back(parameter_label(input, p));
  }
  const auto step = stride(r.runs(), points);
  for (std::size_t i = 0; i < r.runs(); ++i) {
    if (r.status[i] == 0 && i % step != 0) continue;  // a failed run is always shown
    Json row = Json::array();
    for (std::size_t p = 0; p < r.parameters.size(); ++p) row.push_back(rounded(r.theta[i * r.parameters.size() + p], 4));
    (r.status[i] == 0 ? done : failed).push_back(std::move(row));
  }
  return {{"parameters", std::move(names)}, {"done", std::move(done)}, {"failed", std::move(failed)}};
}
}  // namespace

Json page_data(const Study& study, const ReportInput& input, std::size_t samples, std::size_t quads, std::size_t points) {
  Json data{{"target", target_json(input, quads)},
            {"histories", histories_json(study, input, samples)},
            {"diagnosis", diagnosis_drawings(study)},
            {"diagnosis_histories", diagnosis_histories_json(study, input, samples)},
            {"convergence", nullptr},
            {"ridge", ridge_json(study, input, points)},
            {"loss", nullptr},
            {"decay", decay_json(study)},
            {"design", design_json(study, input, points)},
            {"corner", corner_json(study, input, points * 3 / 4)},
            {"predictive", predictive_histories_json(study, input, samples)},
            {"priors", priors_json(study, input)},
            {"chains", chains_json(study, input)},
            {"sensitivity", sensitivity_drawings(study, input)}};
  if (!data["histories"].is_null()) data["histories"]["scores"] = score_lines(study, input);
  if (const Table t = convergence_table(study); !t.empty()) {
    data["convergence"] = {{"lines", lines_json(t, {2})}, {"x_label", "generation"}, {"y_label", "best objective so far"}};
    if (const auto* enc = study.calibration("enc"))
      data["convergence"]["y_label"] = "best " + text_at(part_at(enc->summary, "objective"), "name", "objective") + " so far";
  }
  if (const Table t = loss_table(study); !t.empty()) data["loss"] = {{"lines", lines_json(t, {2, 3})}, {"x_label", "epoch"}, {"y_label", "loss"}};
  return data;
}

}  // namespace calomel
