#include "inverse/comparison/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/json.hpp"

namespace calomel {

namespace {

const std::string impedance_row = "impedance";

std::optional<double> number_of(const Json& json, const std::string& key) {
  if (!json.is_object() || !json.contains(key) || !json[key].is_number()) return std::nullopt;
  return json[key].get<double>();
}

const Json& part_of(const Json& json, const std::string& key) {
  static const Json nothing;
  return json.is_object() && json.contains(key) ? json[key] : nothing;
}

/// Names in the order in which they first appear.
class Names {
 public:
  void add(const std::string& name) {
    if (!name.empty() && std::find(all_.begin(), all_.end(), name) == all_.end()) all_.push_back(name);
  }
  [[nodiscard]] const std::vector<std::string>& all() const { return all_; }

 private:
  std::vector<std::string> all_;
};

/// `of` gives a method's value, `nominal_of` its nominal one.
template <class Of, class NominalOf>
ComparedRow row(const std::string& name, std::span<const MethodSummary> summaries, const Of& of, const NominalOf& nominal_of) {
  ComparedRow r{.name = name};
  for (const auto& s : summaries) {
    r.values.push_back(of(s.json));
    if (!r.nominal) r.nominal = nominal_of(s.json);
  }
  return r;
}

/// A method's variances: of the parameters and, by first order, of the product density x sound speed.
class MethodSpread {
 public:
  explicit MethodSpread(const Json& json) : json_(json) {}
  /// Of a row of the parameters' table.
  [[nodiscard]] std::optional<double> of(const std::string& row) const { return row == impedance_row ? impedance_sd() : sd(row); }

 private:
  const Json& json_;
  [[nodiscard]] std::optional<double> sd(const std::string& parameter) const {
    const auto v = covariance(parameter, parameter);
    return v && *v > 0 ? std::optional(std::sqrt(*v)) : std::nullopt;
  }
  [[nodiscard]] std::optional<double> impedance_sd() const {
    const auto rho = number_of(part_of(json_, "theta"), "density"), c = number_of(part_of(json_, "theta"), "sound_speed");
    const auto rr = covariance("density", "density"), cc = covariance("sound_speed", "sound_speed"), rc = covariance("density", "sound_speed");
    if (!rho || !c || !rr || !cc || !rc) return std::nullopt;
    const double v = *c * *c * *rr + *rho * *rho * *cc + 2 * *rho * *c * *rc;
    return v > 0 ? std::optional(std::sqrt(v)) : std::nullopt;
  }
  [[nodiscard]] std::optional<double> covariance(const std::string& a, const std::string& b) const {
    const Json &names = part_of(json_, "parameters"), &matrix = part_of(json_, "covariance");
    const auto at = [&](const std::string& name) {
      for (std::size_t i = 0; names.is_array() && i < names.size(); ++i)
        if (names[i] == name) return int(i);
      return -1;
    };
    const int i = at(a), j = at(b);
    if (i < 0 || j < 0 || !matrix.is_array() || std::size_t(std::max(i, j)) >= matrix.size()) return std::nullopt;
    const Json& line = matrix[std::size_t(i)];
    if (!line.is_array() || std::size_t(j) >= line.size() || !line[std::size_t(j)].is_number()) return std::nullopt;
    return line[std::size_t(j)].get<double>();
  }
};

std::vector<ComparedRow> parameter_rows(std::span<const MethodSummary> summaries) {
  Names names;
  for (const auto& s : summaries)
    if (const Json& theta = part_of(s.json, "theta"); theta.is_object())
      for (const auto& [name, value] : theta.items()) names.add(name);
  std::vector<ComparedRow> rows;
  const auto add = [&](ComparedRow r) {
    for (const auto& s : summaries) {
      r.sds.push_back(MethodSpread(s.json).of(r.name));
      if (s.method == "map") r.map_sd = r.sds.back();
    }
    rows.push_back(std::move(r));
  };
  const auto in = [](const char* table, const std::string& name) { return [table, name](const Json& j) { return number_of(part_of(j, table), name); }; };
  for (const auto& name : names.all()) add(row(name, summaries, in("theta", name), in("nominal", name)));
  ComparedRow z = row(impedance_row, summaries, in("impedance", "value"), in("impedance", "nominal"));
  if (std::any_of(z.values.begin(), z.values.end(), [](const auto& v) { return v.has_value(); })) add(std::move(z));
  return rows;
}

/// Scores on the case's own mesh where a summary tells them beside those corrected for the mesh.
const Json& own_mesh(const Json& json) {
  const Json& own = part_of(part_of(json, "mesh"), "working_mesh");
  return own.is_object() ? own : json;
}

/// `same_mesh`: all by the case's own mesh, because not every summary is corrected.
std::vector<ComparedRow> score_rows(std::span<const MethodSummary> summaries, const std::string& key, bool same_mesh) {
  Names names;
  for (const auto& s : summaries)
    if (const Json& sensors = part_of(s.json, "sensors"); sensors.is_array())
      for (const auto& sensor : sensors) names.add(sensor.value("name", ""));
  const auto sensor_of = [](const Json& json, const std::string& name) -> const Json& {
    static const Json nothing;
    const Json& sensors = part_of(json, "sensors");
    for (const auto& s : sensors)
      if (s.value("name", "") == name) return s;
    return nothing;
  };
  const auto scores = [&](const Json& json) -> const Json& { return same_mesh ? own_mesh(json) : json; };
  std::vector<ComparedRow> rows;
  for (const auto& name : names.all())
    rows.push_back(row(
        name, summaries, [&](const Json& j) { return number_of(sensor_of(scores(j), name), key); },
        [&](const Json& j) { return number_of(sensor_of(scores(j), name), "nominal_" + key); }));
  rows.push_back(row(
      "mean", summaries, [&](const Json& j) { return number_of(scores(j), key); }, [&](const Json& j) { return number_of(scores(j), "nominal_" + key); }));
  return rows;
}

ComparedPair pair_of(const Comparison& c, std::size_t a, std::size_t b) {
  ComparedPair pair{c.methods[a], c.methods[b], {}, std::nullopt};
  for (const auto& r : c.parameters) {
    ComparedDifference d{.name = r.name, .absolute = std::nullopt, .percent = std::nullopt, .in_map_sd = std::nullopt};
    if (r.values[a] && r.values[b]) {
      d.absolute = *r.values[b] - *r.values[a];
      if (*r.values[a] != 0) d.percent = 100 * *d.absolute / *r.values[a];
      if (r.map_sd) d.in_map_sd = *d.absolute / *r.map_sd;
      if (r.sds[a] && r.sds[b]) d.in_own_sds = *d.absolute / std::hypot(*r.sds[a], *r.sds[b]);
    }
    if (d.in_map_sd) pair.largest_in_map_sd = std::max(pair.largest_in_map_sd.value_or(0), std::abs(*d.in_map_sd));
    pair.differences.push_back(std::move(d));
  }
  return pair;
}

/// Whether the pairs agree, and in what they do not.
void judge(Comparison& c) {
  std::string apart;
  bool told = !c.pairs.empty();
  for (const auto& p : c.pairs) {
    told = told && p.largest_in_map_sd.has_value();
    std::string beyond;
    for (const auto& d : p.differences)
      if (d.in_map_sd && std::abs(*d.in_map_sd) > Comparison::agreement_sds)
        beyond += fmt::format("{}{} ({:+.1f} sd{}, {:+.1f} %)", beyond.empty() ? "" : ", ", d.name, *d.in_map_sd,
                              d.in_own_sds ? fmt::format(", {:+.1f} of the two's own", *d.in_own_sds) : "", d.percent.value_or(0));
    if (!beyond.empty()) apart += fmt::format("{}{} against {} in {}", apart.empty() ? "" : "; ", method_label(p.second), method_label(p.first), beyond);
  }
  c.agree = told && apart.empty();
  if (!apart.empty())
    c.sentence = fmt::format("The methods disagree, by more than {:g} of MAP's standard deviations: {}.", Comparison::agreement_sds, apart);
  else if (c.agree)
    c.sentence = fmt::format("The methods agree within {:g} of MAP's standard deviations in every parameter.", Comparison::agreement_sds);
  else
    c.sentence = "Whether the methods agree cannot be told without MAP's standard deviations; the differences in percent are listed.";
}

}  // namespace

std::string method_label(const std::string& method) {
  std::string s = method;
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char ch) { return char(std::toupper(ch)); });
  return s;
}

std::optional<double> ComparedEffort::evaluations_per_second() const {
  return evaluations && search_s && *search_s > 0 ? std::optional(*evaluations / *search_s) : std::nullopt;
}

Comparison compare_calibrations(std::span<const MethodSummary> summaries) {
  Comparison c;
  for (const auto& s : summaries) {
    c.methods.push_back(s.method);
    c.effort.push_back({s.method, number_of(s.json, "evaluations"), number_of(s.json, "model_runs"), number_of(s.json, "search_s"), number_of(s.json, "model_s")});
    if (c.mae_unit.empty() && part_of(s.json, "mae_unit").is_string()) c.mae_unit = s.json["mae_unit"].get<std::string>();
  }
  c.parameters = parameter_rows(summaries);
  const auto corrected = std::count_if(summaries.begin(), summaries.end(), [](const auto& s) { return &own_mesh(s.json) != &s.json; });
  const auto on = [](const MethodSummary& s) { return s.json.value("scores_on", ""); };
  const bool all = std::size_t(corrected) == summaries.size() && std::all_of(summaries.begin(), summaries.end(), [&](const auto& s) { return on(s) == on(summaries[0]); });
  c.scores_on = corrected == 0 ? "" : all ? on(summaries[0]) : "the case's own mesh";
  c.accuracy = score_rows(summaries, "accuracy", !all), c.mae = score_rows(summaries, "mae", !all);
  for (std::size_t a = 0; a < c.methods.size(); ++a)
    for (std::size_t b = a + 1; b < c.methods.size(); ++b) c.pairs.push_back(pair_of(c, a, b));
  judge(c);
  return c;
}

}  // namespace calomel
