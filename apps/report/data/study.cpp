#include "apps/report/data/study.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "apps/report/data/json_values.hpp"
#include "apps/report/data/series.hpp"
#include "base/artefact.hpp"
#include "base/netcdf_file.hpp"
#include "uq/convergence/diagnostics.hpp"
#include "uq/posterior_file.hpp"

namespace calomel {

const CalibrationArtefacts* Study::calibration(const std::string& method) const {
  for (const auto& c : calibrations)
    if (c.method == method) return &c;
  return nullptr;
}

bool Study::empty() const {
  return calibrations.empty() && !campaign && !train && !simulate && floor.is_null() && !optimizer_comparison && !runs && !simulation && !sample &&
         !posterior && !diagnosis && !sensitivity;
}

std::vector<std::string> parameter_names(const Study& study, const ReportInput& input) {
  std::vector<std::string> names;
  for (const auto& p : input.parameters) names.push_back(p.name);
  if (!names.empty()) return names;
  for (const auto& c : study.calibrations) {
    const Json& theta = part_at(c.summary, "theta");
    if (!theta.is_object()) continue;
    for (const auto& [name, value] : theta.items())
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

namespace {
std::optional<Json> json_if_there(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  return read_json(path);
}

/// Values of a (condition, sensor, time) variable. A file of one condition may lack the first axis.
/// Errors: InputError when the count is not that of the axes.
std::vector<double> values(const NetcdfReader& file, const std::string& name, const Histories& h, std::size_t times, const std::filesystem::path& path) {
  if (!file.has(name)) return {};
  auto list = file.doubles(name);
  const std::size_t wanted = h.conditions.size() * h.sensors.size() * times;
  if (list.size() != wanted)
    throw InputError({.problem = "has " + std::to_string(list.size()) + " values where its sensors and times make " + std::to_string(wanted),
                      .key = name,
                      .suggestion = "make the artefact again with --fresh",
                      .file = path.string()});
  return list;
}

Histories axes(const NetcdfReader& file) {
  Histories h;
  h.sensors = file.strings("sensor");
  h.conditions = file.has("condition") ? file.strings("condition") : std::vector<std::string>{"default"};
  h.time = file.doubles("time");
  return h;
}

/// The axes and the records of a file.
Histories records_of(const NetcdfReader& file, const std::filesystem::path& path) {
  Histories h = axes(file);
  if (file.has("record_time")) h.record_time = file.doubles("record_time");
  h.record_mean = values(file, "record_mean", h, h.record_time.size(), path);
  h.band_low = values(file, "band_low", h, h.record_time.size(), path);
  h.band_high = values(file, "band_high", h, h.record_time.size(), path);
  return h;
}

std::optional<Histories> calibration_histories(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  const NetcdfReader file(path);
  Histories h = records_of(file, path);
  h.calibrated = values(file, "calibrated", h, h.time.size(), path);
  h.nominal = values(file, "nominal", h, h.time.size(), path);
  return h;
}

std::optional<DiagnosisArtefacts> diagnosis_artefacts(const std::filesystem::path& dir) {
  auto summary = json_if_there(dir / "diagnosis.json");
  if (!summary) return std::nullopt;
  DiagnosisArtefacts d{.summary = std::move(*summary), .histories = {}, .explanation = ""};
  const auto path = dir / "diagnosis.nc";
  if (!std::filesystem::exists(path)) return d;
  const NetcdfReader file(path);
  const Json provenance = Json::parse(file.attribute("provenance"), nullptr, false);
  if (text_at(provenance, "identity") != text_at(part_at(d.summary, "provenance"), "identity")) return d;
  d.explanation = file.attribute("explanation");
  Histories h = records_of(file, path);
  h.base = values(file, "base", h, h.time.size(), path);
  h.explained = values(file, "explained", h, h.time.size(), path);
  h.held_out_base = values(file, "held_out_base", h, h.time.size(), path);
  h.held_out_explained = values(file, "held_out_explained", h, h.time.size(), path);
  d.histories = std::move(h);
  return d;
}

std::optional<SensitivityArtefacts> sensitivity_artefacts(const std::filesystem::path& dir) {
  auto summary = json_if_there(dir / "sensitivity.json");
  if (!summary) return std::nullopt;
  SensitivityArtefacts s{
      .summary = std::move(*summary), .conditions = {}, .sensors = {}, .parameters = {}, .time = {}, .sd = {}, .first_order = {}, .total_order = {}};
  const auto path = dir / "sensitivity.nc";
  if (!std::filesystem::exists(path)) return s;
  const NetcdfReader file(path);
  const Json provenance = Json::parse(file.attribute("provenance"), nullptr, false);
  if (text_at(provenance, "identity") != text_at(part_at(s.summary, "provenance"), "identity")) return s;
  const Histories h = axes(file);
  s.conditions = h.conditions;
  s.sensors = h.sensors;
  s.time = h.time;
  s.parameters = file.strings("parameter");
  s.sd = values(file, "sd", h, h.time.size(), path);
  s.first_order = values(file, "first_order", h, h.time.size() * s.parameters.size(), path);
  s.total_order = values(file, "total_order", h, h.time.size() * s.parameters.size(), path);
  return s;
}

/// The coordinate of this name; null when the group has none.
const PosteriorCoordinate* coordinate(const PosteriorGroup& group, const std::string& name) {
  for (const auto& c : group.coordinates)
    if (c.name == name) return &c;
  return nullptr;
}

/// Quantile p of the mixture of Gaussians with these means and one standard deviation, by bisection of its distribution function. Draws and errors together
/// have such a distribution.
double mixture_quantile(const std::vector<double>& middles, double sd, double p) {
  const auto [least, greatest] = std::minmax_element(middles.begin(), middles.end());
  double low = *least - 8 * sd;
  double high = *greatest + 8 * sd;
  for (int i = 0; i < 40; ++i) {
    const double x = 0.5 * (low + high);
    double below = 0;
    for (const double m : middles) below += sd > 0 ? 0.5 * std::erfc((m - x) / (std::numbers::sqrt2 * sd)) : double(m <= x);
    (below < p * double(middles.size()) ? low : high) = x;
  }
  return 0.5 * (low + high);
}

/// The records that the posterior predicts; empty when the groups lack a variable or do not fit together.
std::optional<Histories> predictive_histories(const PosteriorGroup& predictive, const PosteriorGroup& observed) {
  const auto* strain = predictive.variable("strain");
  const auto* record = observed.variable("strain");
  const auto* error = observed.variable("error_sd");
  const auto* sensor = coordinate(predictive, "sensor");
  const auto* time = coordinate(predictive, "time");
  const auto* record_time = coordinate(observed, "record_time");
  const auto* condition = coordinate(predictive, "condition");
  const std::size_t draws = predictive.chains * predictive.draws;
  if (!strain || !record || !sensor || !time || !record_time || draws == 0) return std::nullopt;
  Histories h;
  h.conditions = condition ? condition->words : std::vector<std::string>{"default"};
  h.sensors = sensor->words;
  h.time = time->numbers;
  h.record_time = record_time->numbers;
  h.record_mean = record->values;
  const std::size_t n = h.time.size();
  const std::size_t m = h.record_time.size();
  const std::size_t records = h.conditions.size() * h.sensors.size();
  if (strain->values.size() != draws * records * n || record->values.size() != records * m) return std::nullopt;
  const bool with_errors = error && error->values.size() == records * m;
  for (std::size_t r = 0; r < records; ++r) {
    std::vector<std::vector<double>> at(m);  // by record time
    for (std::size_t i = 0; i < draws; ++i) {
      const auto y = interpolated(h.time, std::span(strain->values).subspan((i * records + r) * n, n), h.record_time);
      for (std::size_t k = 0; k < m; ++k)
        if (std::isfinite(y[k])) at[k].push_back(y[k]);
    }
    for (std::size_t k = 0; k < m; ++k) {
      h.predicted.push_back(at[k].empty() ? std::nan("") : std::accumulate(at[k].begin(), at[k].end(), 0.0) / double(at[k].size()));
      h.draws_low.push_back(at[k].empty() ? std::nan("") : quantile(at[k], 0.05));
      h.draws_high.push_back(at[k].empty() ? std::nan("") : quantile(at[k], 0.95));
      if (!with_errors) continue;
      const double sd = error->values[r * m + k];
      const bool there = !at[k].empty() && std::isfinite(sd);
      h.predicted_low.push_back(there ? mixture_quantile(at[k], sd, 0.05) : std::nan(""));
      h.predicted_high.push_back(there ? mixture_quantile(at[k], sd, 0.95) : std::nan(""));
    }
  }
  return h;
}

/// Number of chains that move together, from posterior.json.
std::size_t walkers_of(const Study& study) { return study.sample ? std::size_t(number_at(part_at(*study.sample, "sampler"), "walkers").value_or(1)) : 1; }

void read_draws(const std::filesystem::path& path, Study& study) {
  if (!std::filesystem::exists(path)) return;
  const auto groups = read_posterior(path);
  const auto group = [&](const std::string& name) -> const PosteriorGroup* {
    const auto found = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.name == name; });
    return found == groups.end() ? nullptr : &*found;
  };
  if (const auto* g = group("posterior")) {
    study.posterior = draws_of(*g);
    study.posterior->walkers = walkers_of(study);
  } else {
    (void)read_posterior(path, {"posterior"});  // throws an error that names the missing group
  }
  if (const auto* g = group("prior")) study.prior = draws_of(*g);
  const auto* predictive = group("posterior_predictive");
  const auto* observed = group("observed_data");
  if (predictive && observed) study.predictive = predictive_histories(*predictive, *observed);
}

std::optional<Histories> simulation_histories(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  const NetcdfReader file(path);
  Histories h = axes(file);
  h.nominal = values(file, "strain", h, h.time.size(), path);
  return h;
}

std::optional<CampaignRuns> campaign_runs(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  const NetcdfReader file(path);
  CampaignRuns c;
  c.parameters = file.strings("parameter");
  c.theta = file.doubles("theta");
  c.status = file.integers("status");
  if (file.has("sensor")) c.sensors = file.strings("sensor");
  c.message = file.has("message") ? file.strings("message") : std::vector<std::string>(c.runs());
  std::string word;
  for (const char letter : file.attribute("flag_meanings", "status") + ' ') {
    if (letter != ' ') {
      word += letter;
    } else if (!word.empty()) {
      c.status_words.push_back(word);
      word.clear();
    }
  }
  if (c.theta.size() != c.runs() * c.parameters.size() || c.message.size() != c.runs())
    throw InputError(
        {.problem = "theta, status and message have different numbers of runs", .suggestion = "make it again with --fresh", .file = path.string()});

  // The scatter has the axes (run, [condition,] sensor, time).
  if (file.has("scatter") && !c.sensors.empty()) {
    const auto shape = file.shape("scatter");
    const auto list = file.doubles("scatter");
    const std::size_t times = shape.empty() ? 0 : shape.back();
    std::vector<double> sum(c.sensors.size());
    std::vector<double> count(c.sensors.size());
    for (std::size_t i = 0; times > 0 && i < list.size(); ++i) {
      if (!std::isfinite(list[i])) continue;
      const std::size_t s = i / times % c.sensors.size();
      sum[s] += list[i] * list[i];
      ++count[s];
    }
    for (std::size_t s = 0; s < sum.size(); ++s) c.scatter.push_back(count[s] > 0 ? std::sqrt(sum[s] / count[s]) : std::nan(""));
  }
  return c;
}
}  // namespace

Study read_study(const std::filesystem::path& out_dir, double time_end) {
  Study study;
  study.time = time_unit(time_end);
  for (const auto& [method, label] : {std::pair{"enc", "ENC"}, std::pair{"spe", "SPE"}, std::pair{"map", "MAP"}})
    if (auto summary = json_if_there(out_dir / (std::string(method) + ".json")))
      study.calibrations.push_back({method, label, std::move(*summary), calibration_histories(out_dir / (std::string(method) + ".nc"))});
  study.campaign = json_if_there(out_dir / "campaign.json");
  study.train = json_if_there(out_dir / "train.json");
  study.simulate = json_if_there(out_dir / "simulate.json");
  study.floor = study.campaign ? part_at(*study.campaign, "floor") : Json();
  if (study.floor.is_null()) study.floor = json_if_there(out_dir / "floor.json").value_or(Json());
  study.optimizer_comparison = json_if_there(out_dir / "optimizer_comparison.json");
  study.runs = campaign_runs(out_dir / "campaign.nc");
  study.sample = json_if_there(out_dir / "posterior.json");
  read_draws(out_dir / "posterior.nc", study);
  study.simulation = simulation_histories(out_dir / "simulate.nc");
  study.diagnosis = diagnosis_artefacts(out_dir);
  study.sensitivity = sensitivity_artefacts(out_dir);
  return study;
}

}  // namespace calomel
