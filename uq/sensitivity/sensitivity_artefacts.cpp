#include <fmt/format.h>

#include "base/json.hpp"
#include "base/netcdf_file.hpp"
#include "base/provenance.hpp"
#include "uq/sensitivity/sensitivity.hpp"

namespace calomel {

namespace {

Json indices_json(const std::vector<SensitivityIndex>& indices, const std::vector<Parameter>& parameters) {
  Json list = Json::array();
  for (std::size_t k = 0; k < indices.size(); ++k)
    list.push_back(
        {{"parameter", parameters[k].name}, {"value", number(indices[k].value)}, {"low", number(indices[k].low)}, {"high", number(indices[k].high)}});
  return list;
}

Json morris_json(const std::vector<MorrisEffect>& effects, const std::vector<Parameter>& parameters) {
  Json list = Json::array();
  for (std::size_t k = 0; k < effects.size(); ++k)
    list.push_back({{"parameter", parameters[k].name},
                    {"mu", number(effects[k].mu)},
                    {"mu_star", number(effects[k].mu_star)},
                    {"mu_star_se", number(effects[k].mu_star_se)},
                    {"sigma", number(effects[k].sigma)}});
  return list;
}

Json chaos_json(const LegendreChaos& chaos, const std::vector<Parameter>& parameters) {
  const auto indices = indices_of(chaos);
  Json j{{"order", chaos.order}, {"left_out_r2", number(chaos.left_out_r2)}, {"first_order", Json::array()}, {"total_order", Json::array()}};
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    j["first_order"].push_back({{"parameter", parameters[k].name}, {"value", number(indices.first_order[Eigen::Index(k)])}});
    j["total_order"].push_back({{"parameter", parameters[k].name}, {"value", number(indices.total_order[Eigen::Index(k)])}});
  }
  return j;
}

/// A name as a field of a CSV line (RFC 4180).
std::string field(const std::string& name) {
  if (name.find_first_of(",\"\r\n") == std::string::npos) return name;
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

/// Writes the totals of runs. Totals of one name follow one another by condition, in the shape's order.
void write_totals(NetcdfWriter& file, const TotalsOfRuns& totals, const ModelShape& shape) {
  const auto runs = std::size_t(totals.thetas.cols());
  file.dimension("run", runs);
  file.variable("run_theta", {"run", "parameter"}, std::span<const double>(totals.thetas.data(), std::size_t(totals.thetas.size())),
                {{"long_name", "parameters of each run, in natural units"}});
  const bool many = shape.conditions.size() > 1;
  for (std::size_t q = 0; q < totals.which.size(); ++q) {
    const auto& which = totals.which[q];
    if (std::any_of(totals.which.begin(), totals.which.begin() + std::ptrdiff_t(q), [&](const auto& w) { return w.name == which.name; })) continue;
    std::vector<double> values;
    for (std::size_t i = 0; i < runs; ++i)
      for (std::size_t r = q; r < totals.which.size(); ++r)
        if (totals.which[r].name == which.name) values.push_back(totals.values(Eigen::Index(r), Eigen::Index(i)));
    file.variable("run_" + which.name, many ? std::vector<std::string>{"run", "condition"} : std::vector<std::string>{"run"}, values, {{"units", which.unit}});
  }
}

}  // namespace

Json sensitivity_json(const Sensitivity& s, const SensitivityInputs& in, const SensitivityWords& words, const Provenance& provenance) {
  expect(words.sources.size() == s.quantities.size() && words.notes.size() == s.quantities.size(), "every quantity has its words");
  const auto& parameters = in.model.shape().parameters;
  Json quantities = Json::array();
  for (std::size_t i = 0; i < s.quantities.size(); ++i) {
    const auto& q = s.quantities[i];
    Json one{{"name", q.name},
             {"sensor", q.sensor},
             {"condition", q.condition},
             {"unit", q.unit},
             {"mean", number(q.mean)},
             {"sd", number(q.sd)},
             {"first_order", indices_json(q.sobol.first_order, parameters)},
             {"total_order", indices_json(q.sobol.total_order, parameters)}};
    one["morris"] = morris_json(q.morris, parameters);
    if (q.chaos) one["polynomial"] = chaos_json(*q.chaos, parameters);
    if (!words.sources[i].empty()) {
      one["source"] = words.sources[i];
      one["left_out_r2"] = number(q.left_out_r2);
    }
    if (!words.notes[i].empty()) one["note"] = words.notes[i];
    quantities.push_back(std::move(one));
  }
  const auto& whole = s.quantities.back();
  Json all_morris = Json::array();
  for (const auto& q : s.quantities)
    if (!q.morris.empty()) all_morris.push_back({{"name", q.name}, {"sensor", q.sensor}, {"effects", morris_json(q.morris, parameters)}});
  Json json{{"status", words.doubt.empty() ? "done" : "not_to_be_trusted"},
            {"source", words.source},
            {"measure", in.options.measure},
            {"samples", in.options.samples},
            {"rows", s.rows},
            {"evaluations", s.evaluations},
            {"failed", s.failed},
            {"first_order", indices_json(whole.sobol.first_order, parameters)},
            {"total_order", indices_json(whole.sobol.total_order, parameters)},
            {"morris", std::move(all_morris)},
            {"quantities", std::move(quantities)},
            {"provenance", provenance.json()}};
  if (!words.doubt.empty()) json["message"] = words.doubt;
  return json;
}

std::string sensitivity_csv(const Sensitivity& s, const std::vector<Parameter>& parameters) {
  std::string out =
      "quantity,condition,sensor,unit,mean,sd,parameter,parameter_min,parameter_max,first_order,first_low,first_high,total_order,total_low,total_high,morris_"
      "mu,morris_mu_star,morris_mu_star_se,morris_sigma,polynomial_first,polynomial_total,polynomial_left_out_r2\n";
  const auto text = [](double x) { return std::isfinite(x) ? fmt::format("{:.6g}", x) : std::string(); };
  for (const auto& q : s.quantities)
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      const auto &f = q.sobol.first_order[k], &t = q.sobol.total_order[k];
      out += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}", q.name, field(q.condition), field(q.sensor), q.unit, text(q.mean), text(q.sd),
                         field(parameters[k].name), text(parameters[k].min), text(parameters[k].max), text(f.value), text(f.low), text(f.high), text(t.value),
                         text(t.low), text(t.high));
      out += q.morris.empty()
                 ? ",,,,"
                 : fmt::format(",{},{},{},{}", text(q.morris[k].mu), text(q.morris[k].mu_star), text(q.morris[k].mu_star_se), text(q.morris[k].sigma));
      if (q.chaos) {
        const auto indices = indices_of(*q.chaos);
        out += fmt::format(",{},{},{}\n", text(indices.first_order[Eigen::Index(k)]), text(indices.total_order[Eigen::Index(k)]), text(q.chaos->left_out_r2));
      } else {
        out += fmt::format(",,,{}\n", text(q.left_out_r2));
      }
    }
  return out;
}

void write_sensitivity(const std::filesystem::path& path, const Sensitivity& s, const ModelShape& shape, const TotalsOfRuns* totals,
                       const Provenance& provenance) {
  NetcdfWriter file(path);
  file.attribute("title", "calomel sensitivity");
  file.attribute("provenance", provenance.json().dump());
  std::vector<std::string> names;
  for (const auto& p : shape.parameters) names.push_back(p.name);
  std::vector<std::string> dims{"sensor", "time"};
  if (shape.conditions.size() > 1) {
    file.dimension("condition", shape.conditions.size());
    file.variable("condition", {"condition"}, shape.conditions);
    dims.insert(dims.begin(), "condition");
  }
  file.dimension("sensor", shape.sensors.size());
  file.dimension("time", shape.times.size());
  file.dimension("parameter", names.size());
  file.variable("sensor", {"sensor"}, shape.sensors);
  file.variable("time", {"time"}, shape.times, {{"units", "s"}});
  file.variable("parameter", {"parameter"}, names);
  file.variable("sd", dims, std::vector<double>(s.sd.begin(), s.sd.end()), {{"units", shape.unit == "strain" ? "1" : shape.unit}});
  dims.push_back("parameter");
  const auto rows = [](const Eigen::MatrixXd& m) {
    std::vector<double> out;
    for (Eigen::Index i = 0; i < m.rows(); ++i)
      for (Eigen::Index k = 0; k < m.cols(); ++k) out.push_back(m(i, k));
    return out;
  };
  file.variable("first_order", dims, rows(s.first_order), {{"units", "1"}});
  file.variable("total_order", dims, rows(s.total_order), {{"units", "1"}});
  if (totals) write_totals(file, *totals, shape);
  file.commit();
}

}  // namespace calomel
