#include <cmath>
#include <limits>

#include "base/json.hpp"
#include "base/not_finite.hpp"
#include "base/provenance.hpp"
#include "inverse/data/history_file.hpp"
#include "inverse/posterior/posterior_artefacts.hpp"
#include "uq/diagnosis/diagnosis_artefacts.hpp"
#include "uq/diagnosis/plain_words.hpp"

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

Json fit_of(const Problem& problem, const std::vector<double>& history, double compared, double held_out) {
  const Score s = score(problem, history);
  return {{"accuracy", number(s.accuracy)},    {"mae", number(s.mae)},
          {"nrmse", number(s.nrmse)},          {"compared_nrmse", number(compared)},
          {"heldout_nrmse", number(held_out)}, {"residual_rms", number(residual_rms(problem, history))},
          {"unit", problem.mae_unit}};
}

/// |history - record| / |record| of each observation on the grid that is compared; NaN where there is no history.
std::vector<double> misfits_of(const PosteriorFit& base, const std::vector<double>& history) {
  const Decimation& grid = base.errors->grid();
  std::vector<double> all(grid.observations(), std::numeric_limits<double>::quiet_NaN());
  if (history.empty()) return all;
  const Eigen::VectorXd values = grid.apply(Eigen::Map<const Eigen::VectorXd>(history.data(), Eigen::Index(history.size())));
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = misfit_of(fold_of(grid, {i}), grid, values, base.errors->data());
  return all;
}

double mean_of(const std::vector<double>& x) {
  double sum = 0;
  for (const double v : x) sum += v;
  return sum / double(x.size());
}

/// Middle and deviation of what was known of the parameters beforehand; those without such a prior are left out.
Json handbook_json(const Diagnosis& d, const std::vector<Parameter>& parameters) {
  Json object = Json::object();
  for (const auto& e : d.base_parameters)
    for (const auto& p : parameters) {
      if (p.name != e.name) continue;
      if (p.mean && p.sd) object[p.name] = {{"mean", number(*p.mean)}, {"sd", number(*p.sd)}};
      if (p.mu && p.sigma) object[p.name] = {{"mean", number(std::exp(*p.mu))}, {"sd", number(std::exp(*p.mu) * *p.sigma)}, {"log_sd", number(*p.sigma)}};
    }
  return object;
}

/// In the case's unit: a number that the fit counts by its inverse is told as itself; null where it is none.
Estimate in_case_unit(const Estimate& e, const std::vector<ParameterGroup>& groups) {
  for (const auto& g : groups)
    for (const auto& a : g.added)
      if (a.inverse && e.name.ends_with(a.parameter.name))
        return {e.name, e.mean >= a.parameter.min && e.mean <= a.parameter.max ? 1 / e.mean : std::numeric_limits<double>::quiet_NaN(),
                e.sd / (e.mean * e.mean)};
  return e;
}

Json numbers_json(const Alternative& c, const std::vector<ParameterGroup>& groups) {
  std::vector<Estimate> told;
  for (const auto& e : c.numbers) told.push_back(in_case_unit(e, groups));
  Json list = estimates_json(told);
  for (std::size_t i = 0; i < c.numbers.size(); ++i) {
    const PlainNumber plain = plain_number(c, c.numbers[i], groups);
    list[i]["value"] = plain.value, list[i]["off"] = plain.off, list[i]["doc"] = plain.doc, list[i]["deviations_from_off"] = number(plain.deviations),
    list[i]["told_by_records"] = c.numbers[i].told;
  }
  return list;
}

/// The explanation that the verdict names, the first of them, or null.
const Alternative* named_of(const Diagnosis& d) { return d.verdict.mechanisms.empty() ? nullptr : d.alternative(d.verdict.mechanisms[0]); }

Json location_json(const Diagnosis& d, const DiagnosisInputs& in) {
  const LocatedMismatch& l = d.location;
  Json sensors = Json::array(), windows = Json::array(), bands = Json::array();
  for (const auto& s : l.sensors) sensors.push_back({{"name", s.name}, {"score", number(s.score)}, {"q_value", number(s.q_value)}});
  for (const auto& w : l.windows) windows.push_back({{"begin_s", w.begin}, {"end_s", w.end}, {"score", number(w.score)}, {"q_value", number(w.q_value)}});
  for (const auto& b : l.bands) bands.push_back({{"low_hz", b.low}, {"high_hz", b.high}, {"score", number(b.score)}, {"q_value", number(b.q_value)}});
  Json region = Json::object();
  if (!l.first_sensor.empty()) {
    region = {{"first_sensor", l.first_sensor}, {"first_time_s", l.first_time}};
    if (const auto& positions = in.base.places.positions; positions.rows() > 0) {
      const auto at = positions.row(Eigen::Index(in.base.problem.observations[l.first_observation].sensor));
      region["position"] = {at[0], at[1], at[2]};
    }
  }
  return {{"sensors", sensors},
          {"windows", windows},
          {"bands", bands},
          {"map", matrix_json(l.map)},
          {"map_q_values", matrix_json(l.map_q_values)},
          {"band_map", matrix_json(l.band_map)},
          {"band_map_q_values", matrix_json(l.band_map_q_values)},
          {"region", region}};
}

Json by_scale_json(const EvidenceByScale& all) {
  Json out = Json::array();
  for (const auto& s : all) out.push_back({{"scale", number(s.scale)}, {"weight", number(s.weight)}, {"log_evidence", number(s.log_evidence)}});
  return out;
}

/// null where it was not asked.
Json missing_json(const std::optional<MissingTerms>& m) {
  if (!m) return {};
  Json terms = Json::array();
  for (const auto& t : m->terms)
    terms.push_back({{"what", t.what},
                     {"place", t.place},
                     {"unit", t.unit},
                     {"mean", number(t.value)},
                     {"sd", number(t.sd)},
                     {"value", plain_term(t)},
                     {"log_bayes_factor", number(t.log_bayes_factor)}});
  return {{"terms", terms},
          {"asked", m->asked},
          {"misfit_before", number(m->misfit_before)},
          {"misfit_after", number(m->misfit_after)},
          {"sentence", plain_missing(*m)}};
}

}  // namespace

Json diagnosis_json(const Diagnosis& d, const DiagnosisInputs& in, const Provenance& provenance) {
  Json ranking = Json::array();
  for (const auto& r : d.verdict.ranking) {
    Json entry{{"name", r.name},
               {"probability", number(r.probability)},
               {"log_evidence", number(r.log_evidence)},
               {"parameters", Json::array()},
               {"heldout_gain", 0.0}};
    for (const auto& c : d.candidates)
      if (c.explanation.name == r.name) {
        entry["parameters"] = numbers_json(c, in.groups);
        entry["plain_name"] = plain_name(c, in.groups), entry["size"] = plain_size(c, in.groups);
        const auto share = share_explained(d.evidence, c.explanation);
        entry["explained"] = share ? Json(*share) : Json(), entry["numerical"] = c.explanation.numerical;
        entry["heldout_tried"] = !c.held_out.empty();
        entry["heldout_gain"] = number(c.held_out_gain);
        entry["log_bayes_factor"] = number(c.explanation.log_bayes_factor), entry["first_order_log_bayes_factor"] = number(c.first_log_bayes_factor);
        entry["score_p_value"] = number(c.p_value), entry["chi2"] = number(c.explanation.chi2), entry["base_pull"] = number(c.explanation.base_pull);
        entry["by_discrepancy"] = by_scale_json(c.explanation.by_scale), entry["discrepancy"] = number(mean_scale(c.explanation.by_scale)),
        entry["farthest"] = number(c.explanation.farthest);
        entry["fitted"] = c.explanation.fitted, entry["runs"] = c.runs, entry["message"] = c.message, entry["same_as"] = c.explanation.same_as;
        entry["base_parameters"] = by_name(c.base_parameters);
        if (!c.history.empty()) entry["residual_rms"] = number(residual_rms(in.base.problem, c.history));
        if (const auto& f = c.explanation.foretold) entry["beginning"] = {{"before", number(f->beginning_before)}, {"after", number(f->beginning)}};
        if (!c.sensor.empty()) entry["sensor"] = c.sensor;
        Json places = Json::object();  // walls, stretches, laws; of a fault of a gauge, by itself or in a pair, the gauge
        for (const auto& [group, place] : c.places)
          if (!place.empty()) places[group] = place;
        entry["places"] = std::move(places);
        if (!c.other_sensors.empty()) entry["other_sensors"] = c.other_sensors;
      }
    const Why because = why(d, r.name, in.groups);
    entry["why"] = because.why, entry["would_change"] = because.would_change;
    ranking.push_back(std::move(entry));
  }
  const Alternative* named = named_of(d);
  const std::vector<double>& after_history = named ? named->history : d.base_history;
  const auto before = misfits_of(d.base, d.base_history), after = misfits_of(d.base, after_history);
  const auto out_before = misfits_of(d.base, d.held_out_history), out_after = misfits_of(d.base, named ? named->held_out_history : d.held_out_history);
  const PlainSummary summary = plain_summary(
      d, in.groups,
      {mean_of(before), mean_of(after), d.held_out_before, d.held_out_after, in.base.problem.observations.size() == 1 ? "stretches of the record" : "gauges"});
  Json gauges = Json::array();
  for (std::size_t i = 0; i < before.size(); ++i)
    gauges.push_back({{"name", in.base.problem.label(in.base.problem.observations[i])},
                      {"sensor", in.base.problem.shape.sensors[in.base.problem.observations[i].sensor]},
                      {"condition", in.base.problem.shape.conditions[in.base.problem.observations[i].condition]},
                      {"before", number(before[i])},
                      {"after", number(after[i])},
                      {"heldout_before", number(out_before[i])},
                      {"heldout_after", number(out_after[i])}});
  Json conditions = Json::array();
  for (const auto& c : d.held_out_conditions)
    conditions.push_back({{"name", c.name}, {"heldout_before", number(c.before)}, {"heldout_after", number(c.after)}});
  Json absorbed = Json::array();
  for (std::size_t k = 0; k < d.handbook_pulls.size(); ++k)
    if (std::abs(d.handbook_pulls[k]) > absorbing)
      absorbed.push_back({{"parameter", d.base_parameters[k].name}, {"prior_sigmas", number(d.handbook_pulls[k])}});
  Json mixed_up = Json::array();
  for (const auto& m : d.mixed_up)
    mixed_up.push_back(
        {{"gauge", m.gauge}, {"other", m.other}, {"own", number(m.own)}, {"like", number(m.like)}, {"factor", number(m.factor)}, {"text", plain_mixed_up(m)}});
  return {{"verdict", text(d.verdict.kind)},
          {"mechanisms", d.verdict.mechanisms},
          {"reason", d.verdict.reason},
          {"summary", summary.text()},
          {"finding", summary.finding},
          {"next_step", summary.next_step},
          {"ranking", ranking},
          {"location", location_json(d, in)},
          {"fit",
           {{"before", fit_of(in.base.problem, d.base_history, mean_of(before), d.held_out_before)},
            {"after", fit_of(in.base.problem, after_history, mean_of(after), d.held_out_after)}}},
          {"gauges", gauges},
          {"conditions", conditions},
          {"base_parameters",
           {{"before", by_name(d.base_parameters)},
            {"after", by_name(named ? named->base_parameters : d.base_parameters)},
            {"handbook", handbook_json(d, in.base.parameters)}}},
          {"absorbed", absorbed},
          {"missing", missing_json(d.missing)},
          {"separating_measurement", d.separating},
          {"mixed_up", mixed_up},
          {"dead_gauges", d.dead},
          {"late", d.late ? Json{{"late_s", number(d.late->late)},
                                 {"sd_s", number(d.late->sd)},
                                 {"log_bayes_factor", number(d.late->log_bayes_factor)},
                                 {"text", plain_late(*d.late)}}
                          : Json()},
          {"evidence",
           {{"values", number(d.evidence.values)},
            {"chi2", number(d.evidence.chi2)},
            {"discrepancy", number(mean_scale(d.evidence.by_scale))},
            {"by_discrepancy", by_scale_json(d.evidence.by_scale)},
            {"local", d.evidence.local ? Json{{"log_evidence", number(*d.evidence.local)}, {"gauges", d.likeliest_place}} : Json()}}},
          {"runs", d.runs},
          {"skipped", d.skipped},
          {"base_fit", fit_json(d.base, in.base.parameters)},
          {"unsettled", d.unsettled()},
          {"provenance", provenance.json()}};
}

const Alternative* shown_explanation(const Diagnosis& d) {
  if (const Alternative* named = named_of(d)) return named;
  if (d.verdict.kind != VerdictKind::unknown) return nullptr;
  for (const auto& e : d.by_evidence())
    if (const Alternative* c = d.alternative(e.name); !c->history.empty() && e.log_bayes_factor > 0) return c;
  return nullptr;
}

void write_diagnosis_histories(const Diagnosis& d, const Problem& problem, const Provenance& provenance, const std::filesystem::path& path) {
  const Alternative* shown = shown_explanation(d);
  HistoryFile file(path, problem, provenance);
  file.attribute("title", "calomel diagnosis");
  file.attribute("verdict", text(d.verdict.kind));
  file.attribute("explanation", shown ? shown->explanation.name : "");
  file.history("base", d.base_history, "base model at its best fit, by the emulator");
  file.history("held_out_base", d.held_out_history, "each gauge by the base model fitted without it");
  if (shown) {
    file.history("explained", shown->history, "model with " + shown->explanation.name + " at its best fit");
    file.history("held_out_explained", shown->held_out_history, "each gauge by the model with " + shown->explanation.name + " fitted without it");
  }
  file.commit();
}

}  // namespace calomel
