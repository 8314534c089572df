#include "inverse/map_rival.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/json.hpp"
#include "inverse/map.hpp"
#include "inverse/map_discrepancy.hpp"
#include "inverse/rival_hypothesis.hpp"

namespace calomel {

namespace {

constexpr double same_model = 1e-3;  ///< largest relative difference of two histories that are one model's
constexpr double decided = 3;        ///< nats: odds of 20 to 1

/// Places of the rival's parameters among the problem's. Errors: InputError unless they are some of them and not all.
std::vector<std::size_t> places(const std::vector<Parameter>& parameters, const RivalFit& rival) {
  std::vector<std::size_t> free;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (std::find(rival.sought.begin(), rival.sought.end(), parameters[k].name) != rival.sought.end()) free.push_back(k);
  if (free.size() < rival.sought.size() || free.size() == parameters.size())
    throw InputError({.problem = free.size() < rival.sought.size() ? "the fit of " + rival.name + " seeks parameters that this case does not have"
                                                                  : "the fit of " + rival.name + " seeks every parameter of this case",
                      .key = "map.compare_with",
                      .suggestion = "name the fit of the smaller model in the case of the larger one, which seeks the same parameters and more"});
  return free;
}

/// One emulator of the mesh's error from the pairs of both fits; empty with fewer than two.
MeshError pooled_mesh(const Problem& problem, const MapOptions& options, const std::vector<const std::vector<AddedRun>*>& sets) {
  std::vector<const AddedRun*> pairs;
  for (const auto* set : sets)
    for (const auto& r : *set)
      if (r.paired() && std::none_of(pairs.begin(), pairs.end(), [&](const auto* p) { return p->theta == r.theta; })) pairs.push_back(&r);
  if (pairs.size() < 2) return {};
  Eigen::MatrixXd theta(Eigen::Index(problem.shape.parameters.size()), Eigen::Index(pairs.size())), difference(Eigen::Index(problem.shape.values()), theta.cols());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& p = *pairs[i];
    theta.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXd>(p.theta.data(), theta.rows());
    const auto values = [&](const std::vector<float>& v) { return Eigen::Map<const Eigen::VectorXf>(v.data(), difference.rows()).cast<double>(); };
    difference.col(Eigen::Index(i)) = values(p.fine->mean) - values(p.working.mean);
  }
  return {problem.shape.parameters, theta, difference, {.mean = options.mesh_beyond, .sd = options.mesh_beyond_sd}};
}

/// A covariance that both hypotheses are judged under.
struct Yardstick {
  std::string words;
  Likelihood likelihood;
};

void expect_one_model(const RivalFit& rival, RunStore& store) {
  if (rival.history.empty()) return;
  const auto here = store.history(rival.theta);
  double apart = 0, size = 0;
  for (std::size_t i = 0; i < here.size() && i < rival.history.size(); ++i) apart += std::pow(here[i] - rival.history[i], 2), size += rival.history[i] * rival.history[i];
  const bool same = here.size() == rival.history.size() && apart <= same_model * same_model * size;
  if (!same)
    throw InputError({.problem = fmt::format("this case's model, with the added parameters at their nominal values, is not that of {}: at its answer their histories differ by {:.2g} %",
                                             rival.name, here.size() == rival.history.size() ? 100 * std::sqrt(apart / size) : 100.0),
                      .key = "map.compare_with",
                      .suggestion = "both cases need the same tables and --set, and nominal values that switch the mechanism off"});
}

std::string joined(const std::vector<std::string>& names) {
  std::string s;
  for (std::size_t i = 0; i < names.size(); ++i) s += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return s;
}

void conclude(RivalComparison& c) {
  c.log_bayes_factor = c.low = c.high = c.judgements[0].log_bayes_factor();
  for (const auto& j : c.judgements) {
    const double b = j.log_bayes_factor();
    c.low = std::min(c.low, b - 2 * j.roughness - c.prior_change), c.high = std::max(c.high, b + 2 * j.roughness + c.prior_change);
  }
  c.verdict = c.low > decided ? RivalVerdict::added_favoured : c.high < -decided ? RivalVerdict::added_not_favoured : RivalVerdict::undecided;
  const SharedJudgement& mean = c.judgements[0];
  const std::string added = joined(c.added), range = fmt::format("between {:.3g} and {:.3g} over the covariances at either answer, the model's roughness and priors half and twice as wide", c.low, c.high);
  const std::string numbers = fmt::format("log Bayes factor {:.3g}, {}; chi-squared {:.4g} with and {:.4g} without for {} values under one covariance", c.log_bayes_factor, range,
                                          mean.larger.chi2, mean.smaller.chi2, c.values);
  switch (c.verdict) {
    case RivalVerdict::added_favoured: c.sentence = fmt::format("the records favour {} over {} by odds of at least {:.2g} to 1 ({})", added, c.rival, std::exp(std::min(c.low, 700.0)), numbers); break;
    case RivalVerdict::added_not_favoured: c.sentence = fmt::format("the records speak against {}: {} is favoured by odds of at least {:.2g} to 1 ({})", added, c.rival, std::exp(std::min(-c.high, 700.0)), numbers); break;
    case RivalVerdict::undecided: c.sentence = fmt::format("the records do not decide between {} and {} with {} as well ({})", c.rival, "a model", added, numbers); break;
  }
}

}  // namespace

RivalComparison compare_with_rival(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options, const MapModels& models,
                                   const MapOptions& options, const std::vector<double>& theta, double scale, const std::vector<AddedRun>& runs, const RivalFit& rival,
                                   std::uint64_t seed, int threads, const CalibrationProgress& progress) {
  const bool physical = options.product == "physical";
  const auto parameters = physical ? with_handbook_priors(problem.shape.parameters) : problem.shape.parameters;
  const auto shared = places(parameters, rival);
  RivalComparison out{.rival = rival.name};
  std::vector<std::size_t> all;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    all.push_back(k);
    if (std::find(shared.begin(), shared.end(), k) == shared.end()) out.added.push_back(parameters[k].name);
  }
  out.prior_change = double(out.added.size()) * std::numbers::ln2;

  // 1. What both have in common: runs of the true model and the mesh's error.
  RunStore store(models.true_model);
  expect_one_model(rival, store);
  for (const auto* set : {&runs, &rival.runs})
    for (const auto& r : *set)
      if (r.working.done) store.put(r.theta, {r.working.mean.begin(), r.working.mean.end()});
  MapModels own{.true_model = models.true_model, .floor_variance = models.floor_variance, .mesh = pooled_mesh(problem, options, {&runs, &rival.runs})};
  own.mesh_relative = models.mesh_relative, own.positions = models.positions;

  // 2. Three yardsticks: the covariances at either answer, and first of all their mean.
  const auto yardstick = [&](const std::string& words, const std::vector<double>& at, double s) {
    if (models.unknown_directions) own.unknowns = models.unknown_directions(at);
    const Likelihood l =
        likelihood_at(problem, recordings, recording_options, options.likelihood, options.discrepancy.distance, own, at, false).without_shift();
    return Yardstick{words, physical ? with_discrepancy(l, problem, own, options.discrepancy, s) : l};
  };
  const Yardstick at_rival = yardstick("at the answer of " + rival.name, rival.theta, rival.discrepancy_scale), at_own = yardstick("at this case's answer", theta, scale);
  const Yardstick mean{"mean of those at either answer", at_rival.likelihood.mean_with(at_own.likelihood)};
  out.values = std::size_t(mean.likelihood.errors().size());

  // 3. Each hypothesis under each of them, from its own answer and from the other's. The larger one comes last and once more, for the smaller one is part of it.
  const auto held = nominal(problem.shape);
  Hypothesis smaller(store, own.mesh, parameters, held, shared), larger(store, own.mesh, parameters, held, all);
  for (const auto& point : {rival.theta, theta}) smaller.try_at(point), larger.try_at(point);
  const JudgeSettings settings{.polish_runs = options.polish_runs, .secant = options.secant, .threads = threads, .seed = seed};
  for (const auto* y : {&mean, &at_rival, &at_own}) {
    const JudgedPoint l = larger.judge(y->likelihood, settings, progress);
    smaller.try_at(l.fit.theta);
    const JudgedPoint s = smaller.judge(y->likelihood, settings, progress);
    const JudgedPoint again = s.fit.log_likelihood > l.fit.log_likelihood ? larger.judge(y->likelihood, settings, progress) : l;
    out.judgements.push_back({y->words, s.fit, again.fit, std::hypot(s.roughness, again.roughness)});
  }
  out.model_runs = store.made();
  conclude(out);
  return out;
}

Json rival_json(const RivalComparison& c, const ModelShape& shape) {
  const auto fit = [&](const JudgedFit& f) {
    return Json{{"theta", named(shape, f.theta)}, {"log_likelihood", number(f.log_likelihood)}, {"log_posterior", number(f.log_posterior)},
                {"log_evidence", number(f.log_evidence)}, {"chi2", number(f.chi2)}};
  };
  Json judgements = Json::array();
  for (const auto& j : c.judgements)
    judgements.push_back({{"covariance", j.covariance}, {"log_bayes_factor", number(j.log_bayes_factor())}, {"roughness", number(j.roughness)}, {"with", fit(j.larger)}, {"without", fit(j.smaller)}});
  const char* verdict = c.verdict == RivalVerdict::added_favoured ? "favoured" : c.verdict == RivalVerdict::added_not_favoured ? "not favoured" : "undecided";
  return {{"with", c.rival}, {"added", c.added}, {"log_bayes_factor", number(c.log_bayes_factor)}, {"low", number(c.low)}, {"high", number(c.high)},
          {"prior_change", number(c.prior_change)}, {"values", c.values}, {"verdict", verdict}, {"sentence", c.sentence}, {"judgements", judgements}, {"model_runs", c.model_runs}};
}

}  // namespace calomel
