#include <cmath>

#include "base/json.hpp"
#include "base/nan.hpp"
#include "base/provenance.hpp"
#include "inverse/posterior/posterior_artefacts.hpp"
#include "uq/diagnosis/diagnosis.hpp"

namespace calomel {

namespace {

constexpr double absorbing = 2;  ///< prior standard deviations

Json estimates_json(const std::vector<Estimate>& all) {
  Json list = Json::array();
  for (const auto& e : all) list.push_back({{"name", e.name}, {"mean", number(e.mean)}, {"sd", number(e.sd)}});
  return list;
}

Json by_name(const std::vector<Estimate>& all) {
  Json object = Json::object();
  for (const auto& e : all) object[e.name] = {{"mean", number(e.mean)}, {"sd", number(e.sd)}};
  return object;
}

/// Root mean square over all samples compared of the mean records less the history, in the records' unit.
double residual_rms(const Problem& problem, const std::vector<double>& history) {
  double sum = 0;
  std::size_t n = 0;
  for (const auto& o : problem.observations) {
    const auto y = on_record_times(problem, std::span(history).subspan(problem.shape.at(o.condition, o.sensor, 0), problem.shape.times.size()));
    for (std::size_t t = 0; t < y.size(); ++t)
      if (o.compared[t]) sum += (y[t] - o.mean[t]) * (y[t] - o.mean[t]), ++n;
  }
  return problem.mae_scale * std::sqrt(sum / double(n));
}

Json fit_of(const Problem& problem, const std::vector<double>& history, double held_out) {
  const Score s = score(problem, history);
  return {{"accuracy", number(s.accuracy)}, {"mae", number(s.mae)}, {"nrmse", number(s.nrmse)}, {"heldout_nrmse", number(held_out)}, {"residual_rms", number(residual_rms(problem, history))}, {"unit", problem.mae_unit}};
}

/// The explanation that the verdict is about, or null.
const Alternative* named_of(const Diagnosis& d) {
  if (d.verdict.mechanisms.empty()) return nullptr;
  for (const auto& c : d.candidates)
    if (c.explanation.name == d.verdict.mechanisms[0]) return &c;
  return nullptr;
}

Json location_json(const Diagnosis& d, const DiagnosisInputs& in) {
  const LocatedMismatch& l = d.location;
  Json sensors = Json::array(), windows = Json::array(), bands = Json::array(), map = Json::array();
  for (const auto& s : l.sensors) sensors.push_back({{"name", s.name}, {"score", number(s.score)}, {"q_value", number(s.q_value)}});
  for (const auto& w : l.windows) windows.push_back({{"begin_s", w.begin}, {"end_s", w.end}, {"score", number(w.score)}, {"q_value", number(w.q_value)}});
  for (const auto& b : l.bands) bands.push_back({{"low_hz", b.low}, {"high_hz", b.high}, {"score", number(b.score)}, {"q_value", number(b.q_value)}});
  for (Eigen::Index i = 0; i < l.map.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index w = 0; w < l.map.cols(); ++w) row.push_back(number(l.map(i, w)));
    map.push_back(std::move(row));
  }
  Json region = Json::object();
  if (!l.first_sensor.empty()) {
    region = {{"first_sensor", l.first_sensor}, {"first_time_s", l.first_time}};
    const auto& shape = in.base.problem.shape;
    for (std::size_t s = 0; s < shape.sensors.size() && in.base.positions.rows() > 0; ++s)
      if (shape.sensors[s] == l.first_sensor) {
        const auto at = in.base.positions.row(Eigen::Index(s));
        region["position"] = {at[0], at[1], at[2]};
      }
  }
  return {{"sensors", sensors}, {"windows", windows}, {"bands", bands}, {"map", map}, {"region", region}};
}

}  // namespace

Json diagnosis_json(const Diagnosis& d, const DiagnosisInputs& in, const Provenance& provenance) {
  Json ranking = Json::array();
  for (const auto& r : d.verdict.ranking) {
    Json entry{{"name", r.name}, {"probability", number(r.probability)}, {"log_evidence", number(r.log_evidence)}, {"parameters", Json::array()}, {"heldout_gain", 0.0}};
    for (const auto& c : d.candidates)
      if (c.explanation.name == r.name) {
        entry["parameters"] = estimates_json(c.numbers);
        entry["heldout_gain"] = number(c.held_out_gain);
        entry["log_bayes_factor"] = number(c.explanation.log_bayes_factor), entry["first_order_log_bayes_factor"] = number(c.first_log_bayes_factor);
        entry["score_p_value"] = number(c.p_value), entry["chi2"] = number(c.explanation.chi2), entry["base_pull"] = number(c.explanation.base_pull);
        entry["fitted"] = c.explanation.fitted, entry["runs"] = c.runs, entry["message"] = c.message, entry["same_as"] = c.explanation.same_as;
        entry["base_parameters"] = by_name(c.base_parameters);
        if (!c.history.empty()) entry["residual_rms"] = number(residual_rms(in.base.problem, c.history));
        if (in.base.draw_in && c.explanation.fitted) entry["true_model_shift"] = number(c.true_model_shift);
        if (!c.sensor.empty()) entry["sensor"] = c.sensor;
      }
    ranking.push_back(std::move(entry));
  }
  const Alternative* named = named_of(d);
  Json absorbed = Json::array();
  for (std::size_t k = 0; k < d.handbook_pulls.size(); ++k)
    if (std::abs(d.handbook_pulls[k]) > absorbing) absorbed.push_back({{"parameter", d.base_parameters[k].name}, {"prior_sigmas", number(d.handbook_pulls[k])}});
  return {{"verdict", text(d.verdict.kind)},
          {"mechanisms", d.verdict.mechanisms},
          {"reason", d.verdict.reason},
          {"ranking", ranking},
          {"location", location_json(d, in)},
          {"fit", {{"before", fit_of(in.base.problem, d.base_history, d.held_out_before)}, {"after", fit_of(in.base.problem, named ? named->history : d.base_history, d.held_out_after)}}},
          {"base_parameters", {{"before", by_name(d.base_parameters)}, {"after", by_name(named ? named->base_parameters : d.base_parameters)}}},
          {"absorbed", absorbed},
          {"separating_measurement", d.separating},
          {"evidence", {{"values", number(d.evidence.values)}, {"chi2", number(d.evidence.chi2)}, {"log_without_discrepancy", number(d.evidence.log_plain)},
                        {"log_with_discrepancy", number(d.evidence.log_discrepancy)}}},
          {"runs", d.runs},
          {"skipped", d.skipped},
          {"base_fit", fit_json(d.base, in.base.parameters)},
          {"provenance", provenance.json()}};
}

}  // namespace calomel
