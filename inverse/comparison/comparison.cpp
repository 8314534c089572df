#include "inverse/comparison/comparison.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cctype>
#include <cmath>

#include "base/json.hpp"
#include "base/linear_algebra.hpp"
#include "inverse/calibration/scored_mesh.hpp"

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

/// MAP's answer and the covariance of its parameters.
class LaplacePosterior {
 public:
  explicit LaplacePosterior(std::span<const MethodSummary> summaries) {
    const auto map = std::find_if(summaries.begin(), summaries.end(), [](const auto& s) { return s.method == "map"; });
    if (map == summaries.end()) return;
    const Json &names = part_of(map->json, "parameters"), &matrix = part_of(map->json, "covariance");
    if (!names.is_array() || names.empty() || !matrix.is_array() || matrix.size() != names.size()) return;
    const auto n = Eigen::Index(names.size());
    Eigen::VectorXd mode(n);
    Eigen::MatrixXd covariance(n, n);
    std::vector<std::string> parameters;
    for (Eigen::Index i = 0; i < n; ++i) {
      const Json& line = matrix[std::size_t(i)];
      if (!names[std::size_t(i)].is_string() || !line.is_array() || Eigen::Index(line.size()) != n) return;
      parameters.push_back(names[std::size_t(i)].get<std::string>());
      const auto value = number_of(part_of(map->json, "theta"), parameters.back());
      if (!value) return;
      mode[i] = *value;
      for (Eigen::Index j = 0; j < n; ++j) {
        if (!line[std::size_t(j)].is_number()) return;
        covariance(i, j) = line[std::size_t(j)].get<double>();
      }
    }
    parameters_ = std::move(parameters);
    mode_ = std::move(mode);
    covariance_ = std::move(covariance);
  }
  [[nodiscard]] bool known() const { return !parameters_.empty(); }
  /// Standard deviation of a row of the parameters' table; of the impedance rho c by first order.
  [[nodiscard]] std::optional<double> sd(const std::string& row) const {
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(mode_.size());
    if (const auto i = at(row)) {
      slope[*i] = 1;
    } else if (const auto rho = at("density"), c = at("sound_speed"); row == impedance_row && rho && c) {
      slope[*rho] = mode_[*c];
      slope[*c] = mode_[*rho];
    }
    const double v = slope.dot(covariance_ * slope);
    return v > 0 ? std::optional(std::sqrt(v)) : std::nullopt;
  }
  [[nodiscard]] PlaceInPosterior place(const MethodSummary& summary) const {
    PlaceInPosterior p{.method = summary.method, .distance = std::nullopt, .share_nearer = std::nullopt};
    Eigen::VectorXd off = -mode_;
    for (std::size_t k = 0; k < parameters_.size(); ++k) {
      const auto value = number_of(part_of(summary.json, "theta"), parameters_[k]);
      if (!value) return p;
      off[Eigen::Index(k)] += *value;
    }
    const Cholesky factor(covariance_);
    if (!factor.positive_definite()) return p;
    const double d2 = factor.solve_lower(off).squaredNorm();
    if (!std::isfinite(d2)) return p;
    p.distance = std::sqrt(d2);
    p.share_nearer = boost::math::cdf(boost::math::chi_squared(double(parameters_.size())), d2);
    return p;
  }

 private:
  std::vector<std::string> parameters_;
  Eigen::VectorXd mode_;
  Eigen::MatrixXd covariance_;
  [[nodiscard]] std::optional<Eigen::Index> at(const std::string& name) const {
    const auto found = std::find(parameters_.begin(), parameters_.end(), name);
    return found == parameters_.end() ? std::nullopt : std::optional<Eigen::Index>(found - parameters_.begin());
  }
};

std::vector<ComparedRow> parameter_rows(std::span<const MethodSummary> summaries, const LaplacePosterior& posterior) {
  Names names;
  for (const auto& s : summaries)
    if (const Json& theta = part_of(s.json, "theta"); theta.is_object())
      for (const auto& [name, value] : theta.items()) names.add(name);
  std::vector<ComparedRow> rows;
  const auto add = [&](ComparedRow r) {
    if (posterior.known()) r.map_sd = posterior.sd(r.name);
    rows.push_back(std::move(r));
  };
  const auto in = [](const char* table, const std::string& name) { return [table, name](const Json& j) { return number_of(part_of(j, table), name); }; };
  for (const auto& name : names.all()) add(row(name, summaries, in("theta", name), in("nominal", name)));
  ComparedRow z = row(impedance_row, summaries, in("impedance", "value"), in("impedance", "nominal"));
  if (std::any_of(z.values.begin(), z.values.end(), [](const auto& v) { return v.has_value(); })) add(std::move(z));
  return rows;
}

const std::string own_mesh_name = artefact_name(ScoredMesh::own);

/// The mesh of a summary's scores as artefacts name it.
std::string mesh_of(const Json& json) {
  const Json& on = part_of(json, "scores_on");
  return on.is_string() ? on.get<std::string>() : own_mesh_name;
}

/// Scores on the case's own mesh: beside those corrected for the mesh, or a summary's only ones; null without them.
const Json& own_mesh(const Json& json) {
  static const Json nothing;
  const Json& own = part_of(part_of(json, "mesh"), "working_mesh");
  return own.is_object() ? own : mesh_of(json) == own_mesh_name ? json : nothing;
}

/// `same_mesh`: all by the case's own mesh, because not every summary has the same other one.
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
    }
    if (d.in_map_sd) pair.largest_in_map_sd = std::max(pair.largest_in_map_sd.value_or(0), std::abs(*d.in_map_sd));
    pair.differences.push_back(std::move(d));
  }
  return pair;
}

}  // namespace

std::string method_label(const std::string& method) {
  std::string s = method;
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char ch) { return char(std::toupper(ch)); });
  return s;
}

bool PlaceInPosterior::outside() const { return share_nearer && *share_nearer > Comparison::outside_share; }

std::optional<double> ComparedEffort::evaluations_per_second() const {
  return evaluations && search_s && *search_s > 0 ? std::optional(*evaluations / *search_s) : std::nullopt;
}

Comparison compare_calibrations(std::span<const MethodSummary> summaries) {
  Comparison c;
  for (const auto& s : summaries) {
    c.methods.push_back(s.method);
    c.effort.push_back(
        {s.method, number_of(s.json, "evaluations"), number_of(s.json, "model_runs"), number_of(s.json, "search_s"), number_of(s.json, "model_s")});
    if (c.mae_unit.empty() && part_of(s.json, "mae_unit").is_string()) c.mae_unit = s.json["mae_unit"].get<std::string>();
  }
  const LaplacePosterior posterior(summaries);
  c.parameters = parameter_rows(summaries, posterior);
  if (posterior.known())
    for (const auto& s : summaries)
      if (s.method != "map") c.in_posterior.push_back(posterior.place(s));
  const bool all = std::all_of(summaries.begin(), summaries.end(), [&](const auto& s) { return mesh_of(s.json) == mesh_of(summaries[0].json); });
  c.scores_on = !all ? own_mesh_name : summaries.empty() || mesh_of(summaries[0].json) == own_mesh_name ? "" : mesh_of(summaries[0].json);
  c.accuracy = score_rows(summaries, "accuracy", !all);
  c.mae = score_rows(summaries, "mae", !all);
  for (std::size_t a = 0; a < c.methods.size(); ++a)
    for (std::size_t b = a + 1; b < c.methods.size(); ++b) c.pairs.push_back(pair_of(c, a, b));
  c.agree = !c.in_posterior.empty() && std::all_of(c.in_posterior.begin(), c.in_posterior.end(), [](const auto& p) { return p.distance && !p.outside(); });
  return c;
}

}  // namespace calomel
