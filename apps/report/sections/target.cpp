#include "apps/report/sections/target.hpp"

#include <cmath>

#include "apps/report/data/json_values.hpp"
#include "apps/report/data/surface.hpp"
#include "apps/report/parts/elements.hpp"

namespace calomel {

namespace {

Json surface_json(const ReportSurface& full, std::size_t quads) {
  if (full.empty()) return nullptr;
  const ReportSurface s = thinned(full, quads);
  Json vertices = Json::array();
  Json faces = Json::array();
  for (const auto& v : s.vertices)
    for (const double x : v) vertices.push_back(rounded(x, 5));
  for (const auto& q : s.quads)
    for (const auto i : q) faces.push_back(i);
  return {{"vertices", std::move(vertices)}, {"quads", std::move(faces)}, {"thinned", s.quads.size() < full.quads.size()}};
}

Json vector_json(const Vec3& v) { return Json::array({rounded(v[0], 6), rounded(v[1], 6), rounded(v[2], 6)}); }

}  // namespace

Json target_json(const ReportInput& input, std::size_t quads) {
  if (input.outer.empty() && input.sensors.empty()) return nullptr;
  Json sensors = Json::array();
  for (const auto& s : input.sensors) sensors.push_back({{"name", s.name}, {"position", vector_json(s.placed)}, {"direction", vector_json(s.direction)}});
  return {{"outer", surface_json(input.outer, quads)}, {"wetted", surface_json(input.wetted, quads / 3)}, {"sensors", std::move(sensors)}};
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

Html target_section(const ReportInput& input) {
  if (input.outer.empty() && input.sensors.empty())
    return missing("Of this model neither a surface nor the places of its sensors are known, so there is nothing to draw.");
  const Html view = element(
      "div",
      {{"id", "target-view"}, {"class", "target-view"}, {"role", "img"}, {"aria-label", "The target with its sensors; the table below gives the positions"}});
  const Html note =
      element("p", {{"class", "note"}, {"id", "target-note"}}, "Drag to turn, scroll to zoom. Arrows show the direction in which each sensor measures strain.");
  Html s = element("div", {{"class", "target"}}, view, note) + "\n";
  if (input.outer.empty()) s += missing("The model gives no surface (an external model has none), so only the sensors are drawn.");
  return s + sensor_table(input).html();
}

}  // namespace calomel
