#include "uq/diagnosis/diagnosis_artefacts.hpp"

#include <cmath>
#include <limits>

#include "base/errors.hpp"
#include "base/not_finite.hpp"
#include "base/provenance.hpp"
#include "inverse/data/history_file.hpp"
#include "inverse/posterior/posterior_artefacts.hpp"
#include "uq/diagnosis/fit_measures.hpp"

namespace calomel {

namespace {

constexpr double absorbing = 2;  ///< prior deviation of a base parameter that may compensate for omitted physics

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
      if (o.compared[t]) {
        sum += (y[t] - o.mean[t]) * (y[t] - o.mean[t]);
        ++n;
      }
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

/// Middle and standard deviation of the parameters' priors; parameters without a handbook value are left out.
Json handbook_json(const Diagnosis& d, const std::vector<Parameter>& parameters) {
  Json object = Json::object();
  for (const auto& e : d.base.parameters)
    for (const auto& p : parameters) {
      if (p.name != e.name) continue;
      if (p.mean && p.sd) object[p.name] = {{"mean", number(*p.mean)}, {"sd", number(*p.sd)}};
      if (p.mu && p.sigma) object[p.name] = {{"mean", number(std::exp(*p.mu))}, {"sd", number(std::exp(*p.mu) * *p.sigma)}, {"log_sd", number(*p.sigma)}};
    }
  return object;
}

/// A number in the case's unit: one that the fit has as its inverse is inverted; NaN where it is none.
Estimate in_case_unit(const Estimate& e, const std::vector<ParameterGroup>& groups) {
  for (const auto& g : groups)
    for (const auto& a : g.added)
      if (a.inverse && e.name.ends_with(a.parameter.name))
        return {e.name, e.mean >= a.parameter.min && e.mean <= a.parameter.max ? 1 / e.mean : std::numeric_limits<double>::quiet_NaN(),
                e.sd / (e.mean * e.mean)};
  return e;
}

Json numbers_json(const Alternative& c, const std::vector<ParameterGroup>& groups, const std::vector<NumberText>& texts) {
  std::vector<Estimate> in_unit;
  for (const auto& e : c.numbers) in_unit.push_back(in_case_unit(e, groups));
  Json list = estimates_json(in_unit);
  for (std::size_t i = 0; i < c.numbers.size(); ++i) {
    const AddedParameter* added = added_parameter_of(c, c.numbers[i], groups);
    if (!added) added = shape_of(c, c.numbers[i], groups);
    list[i]["value"] = texts.at(i).value;
    list[i]["off"] = texts.at(i).off;
    list[i]["doc"] = added ? added->doc : "";
    list[i]["deviations_from_off"] = number(deviations_from_off(c, c.numbers[i], groups));
    list[i]["told_by_records"] = c.numbers[i].from_records;
  }
  return list;
}

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

/// Null where no terms were screened.
Json missing_json(const std::optional<MissingTerms>& m, const DiagnosisText& text) {
  if (!m) return {};
  Json terms = Json::array();
  for (std::size_t i = 0; i < m->terms.size(); ++i) {
    const MissingTerm& t = m->terms[i];
    terms.push_back({{"what", t.what},
                     {"place", t.place},
                     {"unit", t.unit},
                     {"mean", number(t.value)},
                     {"sd", number(t.sd)},
                     {"value", text.missing_terms.at(i)},
                     {"log_bayes_factor", number(t.log_bayes_factor)}});
  }
  return {{"terms", terms},
          {"asked", m->screened},
          {"misfit_before", number(m->misfit_before)},
          {"misfit_after", number(m->misfit_after)},
          {"sentence", text.missing}};
}

/// Adds what is known of an explanation to its entry of the ranking.
void add_explanation(Json& entry, const Alternative& c, const Diagnosis& d, const DiagnosisInputs& in, const ExplanationText& text) {
  const Explanation& e = c.explanation;
  const auto share = share_explained(d.base.evidence, e);
  entry["parameters"] = numbers_json(c, in.groups, text.numbers);
  entry["plain_name"] = text.plain_name;
  entry["size"] = text.size;
  entry["explained"] = share ? Json(*share) : Json();
  entry["numerical"] = e.numerical;
  entry["heldout_tried"] = !c.held_out.empty();
  entry["heldout_gain"] = number(c.held_out_gain);
  entry["log_bayes_factor"] = number(e.log_bayes_factor);
  entry["first_order_log_bayes_factor"] = number(c.first_order_log_bayes_factor);
  entry["score_p_value"] = number(c.p_value);
  entry["chi2"] = number(e.chi2);
  entry["base_pull"] = number(e.base_prior_deviation);
  entry["by_discrepancy"] = by_scale_json(e.by_scale);
  entry["discrepancy"] = number(mean_scale(e.by_scale));
  entry["farthest"] = number(e.farthest);
  entry["fitted"] = e.fitted;
  entry["runs"] = c.runs;
  entry["message"] = text.message;
  entry["same_as"] = e.same_as;
  entry["base_parameters"] = by_name(c.base_parameters);
  if (!c.history.empty()) entry["residual_rms"] = number(residual_rms(in.base.problem, c.history));
  if (const auto& p = e.hold_out_prediction) entry["beginning"] = {{"before", number(p->beginning_before)}, {"after", number(p->beginning)}};
  if (!c.sensor.empty()) entry["sensor"] = c.sensor;
  Json places = Json::object();  // walls, stretches, laws; of a fault of a gauge, by itself or in a pair, the gauge
  for (const auto& [group, place] : text.places)
    if (!place.empty()) places[group] = place;
  entry["places"] = std::move(places);
  if (!c.other_sensors.empty()) entry["other_sensors"] = c.other_sensors;
}

Json ranking_json(const Diagnosis& d, const DiagnosisInputs& in, const DiagnosisText& text) {
  Json ranking = Json::array();
  for (std::size_t i = 0; i < d.verdict.ranking.size(); ++i) {
    const Ranked& r = d.verdict.ranking[i];
    const ExplanationText& words = text.ranking.at(i);
    Json entry{{"name", r.name},
               {"probability", number(r.probability)},
               {"log_evidence", number(r.log_evidence)},
               {"parameters", Json::array()},
               {"heldout_gain", 0.0}};
    if (const Alternative* c = d.alternative(r.name)) add_explanation(entry, *c, d, in, words);
    entry["why"] = words.why;
    entry["would_change"] = words.would_change;
    ranking.push_back(std::move(entry));
  }
  return ranking;
}

/// The misfit of every gauge: before and with what is named, in the fit and held out of it.
Json gauges_json(const Diagnosis& d, const Problem& problem) {
  const Alternative* named = d.named();
  const PosteriorFit& base = d.base.fit;
  const auto before = misfits_by_gauge(base, d.base.history), after = misfits_by_gauge(base, named ? named->history : d.base.history);
  const auto out_before = misfits_by_gauge(base, d.hold_out.history), out_after = misfits_by_gauge(base, named ? named->held_out_history : d.hold_out.history);
  Json gauges = Json::array();
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Observation& o = problem.observations[i];
    gauges.push_back({{"name", problem.label(o)},
                      {"sensor", problem.shape.sensors[o.sensor]},
                      {"condition", problem.shape.conditions[o.condition]},
                      {"before", number(before[i])},
                      {"after", number(after[i])},
                      {"heldout_before", number(out_before[i])},
                      {"heldout_after", number(out_after[i])}});
  }
  return gauges;
}

/// Base parameters that the base model moves far from the handbook.
Json absorbed_json(const BaseFit& base) {
  Json absorbed = Json::array();
  for (std::size_t k = 0; k < base.prior_deviations.size(); ++k)
    if (std::abs(base.prior_deviations[k]) > absorbing)
      absorbed.push_back({{"parameter", base.parameters[k].name}, {"prior_sigmas", number(base.prior_deviations[k])}});
  return absorbed;
}

Json mislabelled_json(const std::vector<MislabelledChannel>& channels, const DiagnosisText& text) {
  Json all = Json::array();
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const MislabelledChannel& m = channels[i];
    all.push_back({{"gauge", m.gauge},
                   {"other", m.other},
                   {"own", number(m.own)},
                   {"like", number(m.like)},
                   {"factor", number(m.factor)},
                   {"text", text.mislabelled.at(i)}});
  }
  return all;
}

Json clock_json(const std::optional<ClockOffset>& clock, const DiagnosisText& text) {
  if (!clock) return {};
  return {{"late_s", number(clock->delay)}, {"sd_s", number(clock->sd)}, {"log_bayes_factor", number(clock->log_bayes_factor)}, {"text", text.clock}};
}

Json evidence_json(const BaseFit& base) {
  const BaseEvidence& e = base.evidence;
  const Json local = e.local ? Json{{"log_evidence", number(*e.local)}, {"gauges", base.likeliest_place}} : Json();
  return {{"values", number(e.values)},
          {"chi2", number(e.chi2)},
          {"discrepancy", number(mean_scale(e.by_scale))},
          {"by_discrepancy", by_scale_json(e.by_scale)},
          {"local", local}};
}

}  // namespace

Json diagnosis_json(const Diagnosis& d, const DiagnosisInputs& in, const DiagnosisText& text, const Provenance& provenance) {
  expect(text.ranking.size() == d.verdict.ranking.size() && text.mislabelled.size() == d.base.mislabelled.size(), "the words are about this diagnosis");
  const Problem& problem = in.base.problem;
  const Alternative* named = d.named();
  Json conditions = Json::array();
  for (const auto& c : d.hold_out.conditions)
    conditions.push_back({{"name", c.name}, {"heldout_before", number(c.before)}, {"heldout_after", number(c.after)}});
  return {{"verdict", calomel::text(d.verdict.kind)},
          {"mechanisms", d.verdict.mechanisms},
          {"reason", text.reason},
          {"summary", text.summary()},
          {"finding", text.finding},
          {"next_step", text.next_step},
          {"ranking", ranking_json(d, in, text)},
          {"location", location_json(d, in)},
          {"fit",
           {{"before", fit_of(problem, d.base.history, d.misfits.before, d.misfits.held_out_before)},
            {"after", fit_of(problem, named ? named->history : d.base.history, d.misfits.after, d.misfits.held_out_after)}}},
          {"gauges", gauges_json(d, problem)},
          {"conditions", conditions},
          {"base_parameters",
           {{"before", by_name(d.base.parameters)},
            {"after", by_name(named ? named->base_parameters : d.base.parameters)},
            {"handbook", handbook_json(d, in.base.parameters)}}},
          {"absorbed", absorbed_json(d.base)},
          {"missing", missing_json(d.missing, text)},
          {"separating_measurement", text.separating_measurement},
          {"mixed_up", mislabelled_json(d.base.mislabelled, text)},
          {"dead_gauges", d.dead},
          {"late", clock_json(d.clock, text)},
          {"evidence", evidence_json(d.base)},
          {"runs", d.runs},
          {"skipped", text.skipped},
          {"base_fit", fit_json(d.base.fit, in.base.parameters, text.base_fit)},
          {"unsettled", d.unsettled()},
          {"provenance", provenance.json()}};
}

const Alternative* shown_explanation(const Diagnosis& d) {
  if (const Alternative* named = d.named()) return named;
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
  file.history("base", d.base.history, "base model at its best fit, by the emulator");
  file.history("held_out_base", d.hold_out.history, "each gauge by the base model fitted without it");
  if (shown) {
    file.history("explained", shown->history, "model with " + shown->explanation.name + " at its best fit");
    file.history("held_out_explained", shown->held_out_history, "each gauge by the model with " + shown->explanation.name + " fitted without it");
  }
  file.commit();
}

}  // namespace calomel
