#include "apps/report/parts/traces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "apps/report/data/json_values.hpp"
#include "apps/report/data/quantities.hpp"
#include "apps/report/data/series.hpp"
#include "apps/report/parts/table.hpp"

namespace calomel {

namespace {

/// One trace of the page: its times and, for a condition and a sensor, its values.
struct Series {
  std::string key;
  std::string label;
  const Histories* histories;
  const std::vector<double>* values;
  bool on_records;  ///< whether its times are record_time, else they are time
  bool hidden = false;
  bool edge = false;  ///< whether it is an edge of another series' band
  [[nodiscard]] const std::vector<double>& times() const { return on_records ? histories->record_time : histories->time; }
  /// Its values; empty when these histories lack the sensor or the condition.
  [[nodiscard]] std::span<const double> at(const std::string& condition, const std::string& sensor) const {
    const auto& h = *histories;
    const auto c = std::size_t(std::find(h.conditions.begin(), h.conditions.end(), condition) - h.conditions.begin());
    const auto s = std::size_t(std::find(h.sensors.begin(), h.sensors.end(), sensor) - h.sensors.begin());
    if (c == h.conditions.size() || s == h.sensors.size() || values->empty()) return {};
    const std::size_t n = times().size();
    return std::span(*values).subspan((c * h.sensors.size() + s) * n, n);
  }
};

/// The traces of a plot.
struct Traces {
  std::vector<Series> series;  ///< measured mean, band low, band high, nominal, methods
  std::vector<std::string> conditions;
  std::vector<std::string> sensors;
};

void add_records(Traces& t, const Histories& records) {
  t.series.push_back({"measured", "measured mean and band", &records, &records.record_mean, true});
  t.series.push_back({"low", "band low", &records, &records.band_low, true, false, true});
  t.series.push_back({"high", "band high", &records, &records.band_high, true, false, true});
}

/// Adds the conditions and sensors of the case, then others that the series have.
void add_names(Traces& t, const ReportInput& input) {
  const auto add = [](std::vector<std::string>& list, const std::string& name) {
    if (std::find(list.begin(), list.end(), name) == list.end()) list.push_back(name);
  };
  for (const auto& s : input.sensors) add(t.sensors, s.name);
  for (const auto& s : t.series) {
    for (const auto& c : s.histories->conditions) add(t.conditions, c);
    for (const auto& name : s.histories->sensors) add(t.sensors, name);
  }
}

Traces collect_diagnosis(const Study& study, const ReportInput& input) {
  Traces t;
  if (!study.diagnosis || !study.diagnosis->histories) return t;
  const Histories& h = *study.diagnosis->histories;
  const Json& mechanisms = list_at(study.diagnosis->summary, "mechanisms");
  const bool named = std::find(mechanisms.begin(), mechanisms.end(), study.diagnosis->explanation) != mechanisms.end();
  const std::string with = "with " + study.diagnosis->explanation + (named ? "" : " (nearest, not named)");
  if (!h.record_mean.empty()) add_records(t, h);
  const auto add = [&](const char* key, const std::string& label, const std::vector<double>& values, bool hidden) {
    if (!values.empty()) t.series.push_back({key, label, &h, &values, false, hidden});
  };
  add("base", "simulation as it is", h.base, false);
  add("explained", "simulation " + with, h.explained, false);
  add("held_out_explained", "the same, fitted without this gauge", h.held_out_explained, false);
  add("held_out_base", "simulation as it is, fitted without this gauge", h.held_out_base, !h.held_out_explained.empty());
  add_names(t, input);
  return t;
}

Traces collect_predictive(const Study& study, const ReportInput& input) {
  Traces t;
  if (!study.predictive) return t;
  const Histories& h = *study.predictive;
  const auto band = [&](const std::string& key, const std::string& label, const std::vector<double>& low, const std::vector<double>& high) {
    if (low.empty()) return;
    t.series.push_back({key, label, &h, &h.predicted, true});
    t.series.push_back({key + "_low", "", &h, &low, true, false, true});
    t.series.push_back({key + "_high", "", &h, &high, true, false, true});
  };
  band("predicted", "90 % of the records that are predicted", h.predicted_low, h.predicted_high);
  band("draws", "90 % of the simulations at the draws", h.draws_low, h.draws_high);
  t.series.push_back({"measured", "measured mean", &h, &h.record_mean, true});
  add_names(t, input);
  return t;
}

/// The line beside a gauge's plot: the share of its record that lies within the predicted band.
Json predicted_lines(const Histories& h) {
  Json lines = Json::object();
  if (h.predicted_low.empty()) return lines;
  const std::size_t m = h.record_time.size();
  for (std::size_t c = 0; c < h.conditions.size(); ++c)
    for (std::size_t s = 0; s < h.sensors.size(); ++s) {
      std::size_t inside = 0;
      std::size_t all = 0;
      for (std::size_t k = 0; k < m; ++k) {
        const std::size_t i = (c * h.sensors.size() + s) * m + k;
        if (!std::isfinite(h.record_mean[i]) || !std::isfinite(h.predicted_low[i])) continue;
        ++all;
        inside += h.record_mean[i] >= h.predicted_low[i] && h.record_mean[i] <= h.predicted_high[i];
      }
      const std::string name = h.conditions.size() > 1 ? fmt::format("{} ({})", h.sensors[s], h.conditions[c]) : h.sensors[s];  // the label of Problem::label
      if (all > 0) lines[name] = fmt::format("{:.0f}\u00a0% of the record inside", 100 * double(inside) / double(all));
    }
  return lines;
}

Traces collect(const Study& study, const ReportInput& input) {
  Traces t;
  const Histories* records = nullptr;
  const Histories* nominal = nullptr;
  for (const auto& c : study.calibrations) {
    if (!c.histories) continue;
    if (!records && !c.histories->record_mean.empty()) records = &*c.histories;
    if (!nominal && !c.histories->nominal.empty()) nominal = &*c.histories;
  }
  if (records) add_records(t, *records);
  if (nominal) {
    t.series.push_back({"nominal", "nominal simulation", nominal, &nominal->nominal, false});
  } else if (study.simulation) {
    t.series.push_back({"nominal", "simulation (simulate.nc)", &*study.simulation, &study.simulation->nominal, false});
  }
  for (const auto& c : study.calibrations)
    if (c.histories && !c.histories->calibrated.empty())
      t.series.push_back({c.method, "calibrated simulation, " + c.label, &*c.histories, &c.histories->calibrated, false});
  add_names(t, input);
  return t;
}

/// The rising union of the series' times. Times closer than 1e-7 of the span are one.
std::vector<double> union_times(const std::vector<Series>& series) {
  std::vector<double> all;
  for (const auto& s : series) all.insert(all.end(), s.times().begin(), s.times().end());
  if (all.empty()) return all;
  std::sort(all.begin(), all.end());
  const double tolerance = 1e-7 * (all.back() - all.front());
  std::vector<double> out{all.front()};
  for (const double t : all)
    if (t - out.back() > tolerance) out.push_back(t);
  return out;
}

/// The times of the plots: those of the records, continued by those of the simulation before and after.
std::vector<double> plot_times(const std::vector<Series>& series) {
  auto all = union_times(series);
  const auto records = std::find_if(series.begin(), series.end(), [](const Series& s) { return s.on_records && !s.times().empty(); });
  if (records == series.end()) return all;
  const auto& grid = records->times();
  const double tolerance = 1e-7 * (all.back() - all.front());
  std::vector<double> times;
  for (const double t : all)
    if (t < grid.front() - tolerance) times.push_back(t);
  times.insert(times.end(), grid.begin(), grid.end());
  for (const double t : all)
    if (t > grid.back() + tolerance) times.push_back(t);
  return times;
}

Json traces_json(const Traces& traces, const ReportInput& input, const DisplayUnit& times, std::size_t most) {
  if (traces.series.empty()) return nullptr;
  const auto unit = display_unit(input);
  const auto grid = plot_times(traces.series);
  const Thinning thinning(grid.size(), most);

  Json json{{"unit", unit.name}, {"time_unit", times.name}, {"thinned", thinning.active()}, {"samples", grid.size()}};
  json["time"] = Json::array();
  for (const double t : thinning.times(grid)) json["time"].push_back(rounded(t * times.factor, 7));
  json["series"] = Json::array();
  for (const auto& s : traces.series)
    if (!s.edge) json["series"].push_back({{"key", s.key}, {"label", s.label}, {"hidden", s.hidden}});
  json["conditions"] = Json::array();
  for (const auto& condition : traces.conditions) {
    Json sensors = Json::array();
    for (const auto& sensor : traces.sensors) {
      Json item{{"name", sensor}};
      for (const auto& s : traces.series) {
        const auto values = s.at(condition, sensor);
        if (values.empty() || std::none_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); })) continue;
        Json list = Json::array();
        for (const double x : thinning.extremes(interpolated(s.times(), values, grid))) list.push_back(rounded(x * unit.factor, 4));
        item[s.key] = std::move(list);
      }
      if (item.size() > 1) sensors.push_back(std::move(item));
    }
    json["conditions"].push_back({{"name", condition}, {"sensors", std::move(sensors)}});
  }
  return json;
}

std::string traces_csv(const Traces& traces, const ReportInput& input) {
  if (traces.series.empty()) return {};
  const double factor = display_unit(input).factor;
  const auto grid = union_times(traces.series);
  const double tolerance = grid.empty() ? 0 : 1e-7 * (grid.back() - grid.front());
  std::string csv = "condition,sensor,time_s";
  for (const auto& s : traces.series)
    csv += ',' + std::string(s.key == "measured" ? "measured_mean" : s.key == "low" ? "band_low" : s.key == "high" ? "band_high" : s.key);
  csv += '\n';
  for (const auto& condition : traces.conditions)
    for (const auto& sensor : traces.sensors) {
      const std::string head = csv_field(condition) + ',' + csv_field(sensor) + ',';
      std::vector<std::span<const double>> values;
      for (const auto& s : traces.series) values.push_back(s.at(condition, sensor));
      if (std::all_of(values.begin(), values.end(), [](const auto& v) { return v.empty(); })) continue;
      std::vector<std::size_t> next(values.size(), 0);
      for (const double t : grid) {
        csv += head + number_text(t);
        for (std::size_t k = 0; k < values.size(); ++k) {
          csv += ',';
          const auto& times = traces.series[k].times();
          while (next[k] < times.size() && times[next[k]] < t - tolerance) ++next[k];
          if (next[k] < values[k].size() && std::abs(times[next[k]] - t) <= tolerance && std::isfinite(values[k][next[k]]))
            csv += number_text(values[k][next[k]] * factor);
        }
        csv += '\n';
      }
    }
  return csv;
}

/// The line beside a gauge's plot: the misfits of the diagnosis' fits to its record.
Json misfit_lines(const Json& diagnosis) {
  Json lines = Json::object();
  const auto in_percent = [](const std::optional<double>& x) { return x ? fmt::format("{:.1f}\u00a0%", 100 * *x) : std::string("\u2013"); };
  for (const auto& g : list_at(diagnosis, "gauges")) {
    const auto before = number_at(g, "before");
    const auto after = number_at(g, "after");
    const auto out_before = number_at(g, "heldout_before");
    const auto out_after = number_at(g, "heldout_after");
    const auto pair = [&](const auto& a, const auto& b) { return !b || a == b ? in_percent(a) : in_percent(a) + " \u2192 " + in_percent(b); };
    lines[text_at(g, "name")] = "misfit " + pair(before, after) + (out_before ? ", left out " + pair(out_before, out_after) : "");
  }
  return lines;
}

}  // namespace

Json histories_json(const Study& study, const ReportInput& input, std::size_t most) { return traces_json(collect(study, input), input, study.time, most); }

std::string histories_csv(const Study& study, const ReportInput& input) { return traces_csv(collect(study, input), input); }

Json diagnosis_histories_json(const Study& study, const ReportInput& input, std::size_t most) {
  Json json = traces_json(collect_diagnosis(study, input), input, study.time, most);
  if (!json.is_null()) json["scores"] = misfit_lines(study.diagnosis->summary);
  return json;
}

Json predictive_histories_json(const Study& study, const ReportInput& input, std::size_t most) {
  Json json = traces_json(collect_predictive(study, input), input, study.time, most);
  if (!json.is_null()) json["scores"] = predicted_lines(*study.predictive);
  return json;
}

std::string predictive_histories_csv(const Study& study, const ReportInput& input) { return traces_csv(collect_predictive(study, input), input); }

std::string diagnosis_histories_csv(const Study& study, const ReportInput& input) { return traces_csv(collect_diagnosis(study, input), input); }

}  // namespace calomel
