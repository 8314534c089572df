#include "inverse/enc/enc_agreement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json.hpp"
#include "base/not_finite.hpp"

namespace calomel {

namespace {

constexpr std::uint64_t streams_of_a_search = 1'000'000;  // no calibration has as many rounds

/// The best of the rounds that have a value; null when none has.
const EncRound* best_of(const std::vector<EncRound>& rounds, const Objective& objective, const std::string& optimizer = "") {
  const EncRound* best = nullptr;
  for (const auto& r : rounds)
    if (std::isfinite(r.objective) && (optimizer.empty() || r.optimizer == optimizer) &&
        (!best || objective.cost(r.objective) < objective.cost(best->objective)))
      best = &r;
  return best;
}

double apart(const std::vector<double>& a, const std::vector<double>& b, const Bounds& bounds) { return distance({0, a}, {0, b}, bounds); }

ComparedOptimizer compared(const std::string& name, const std::vector<EncRound>& rounds, const EncRound& best, const Objective& objective,
                           const Bounds& bounds) {
  ComparedOptimizer r{.name = name, .theta = {}};
  double squares = 0;
  for (const auto& x : rounds)
    if (x.optimizer == name && std::isfinite(x.objective)) {
      ++r.rounds;
      r.mean += x.objective;
      r.share += apart(x.theta, best.theta, bounds) <= agreement_tolerance;
    }
  const EncRound* own = best_of(rounds, objective, name);
  if (!own) {
    r.mean = r.sd = r.best = r.distance = r.shortfall = nan;
    return r;
  }
  r.mean /= r.rounds;
  r.share /= r.rounds;
  for (const auto& x : rounds)
    if (x.optimizer == name && std::isfinite(x.objective)) squares += (x.objective - r.mean) * (x.objective - r.mean);
  r.sd = r.rounds > 1 ? std::sqrt(squares / (r.rounds - 1)) : nan;
  r.best = own->objective;
  r.theta = own->theta;
  r.distance = apart(r.theta, best.theta, bounds);
  r.shortfall = objective.cost(r.best) - objective.cost(best.objective);
  r.agrees = r.distance <= agreement_tolerance;
  return r;
}

std::string sentence_of(const EncAgreement& a, const ModelShape& shape) {
  std::string s, apart;
  for (const auto& r : a.optimizers)
    if (r.rounds > 0 && !r.agrees)
      apart += fmt::format("{}{} ends {:.2f} of the bounds away, {:.3g} worse", apart.empty() ? "" : "; ", r.name, r.distance, r.shortfall);
  if (a.optimizers.size() > 1)
    s = a.optimizers_agree ? fmt::format("The optimisers agree: the best of each lies within {:g} of the bounds of the best of all.", agreement_tolerance)
                           : "The optimisers disagree: " + apart + ".";
  apart.clear();
  for (const auto& f : a.objectives)
    if (!f.agrees)
      apart += f.theta.empty() ? fmt::format("{}{} has no value anywhere", apart.empty() ? "" : "; ", f.objective)
                               : fmt::format("{}{} moves {}", apart.empty() ? "" : "; ", f.objective, moves(shape, a.objectives[0].theta, f.theta));
  if (a.objectives.size() > 1)
    s += std::string(s.empty() ? "" : " ") + (a.objectives_agree
                                                  ? fmt::format("The objectives agree within {:g} of the bounds.", agreement_tolerance)
                                                  : "The objectives disagree: " + apart + ". The result depends on the formulation of the misfit.");
  return s;
}

/// The true model at each formulation's answer.
void run_model(EncAgreement& a, const Problem& problem, const ForwardModel& true_model, const std::vector<Objective>& objectives, int threads,
               const CalibrationProgress& progress) {
  std::vector<EncFormulation*> with_answer;
  for (auto& f : a.objectives) {
    f.model.theta = f.theta;
    f.model.objective_surrogate = nan;
    for (const auto& o : objectives) f.values.emplace_back(o.name, std::nullopt);
    if (!f.theta.empty()) with_answer.push_back(&f);
  }
  Eigen::MatrixXd thetas(Eigen::Index(problem.shape.parameters.size()), Eigen::Index(with_answer.size()));
  for (std::size_t i = 0; i < with_answer.size(); ++i)
    thetas.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXd>(with_answer[i]->theta.data(), thetas.rows());
  const auto predictions = true_model.predictions(thetas, threads, [&](std::size_t done, std::size_t total) {
    if (progress) progress("true-model runs of other objectives", done, total);
  });
  for (std::size_t i = 0; i < with_answer.size(); ++i) {
    EncFormulation& f = *with_answer[i];
    const Prediction& p = predictions[i];
    if (p.ok) f.model.score = score(problem, p.mean);
    f.model.message = p.message;
    if (f.model.score.ok)
      for (std::size_t k = 0; k < objectives.size(); ++k)
        if (const double v = objectives[k].value(f.model.score); std::isfinite(v)) f.values[k].second = v;
    f.model.objective_model = f.values[0].second;
  }
}

}  // namespace

EncAgreement find_agreement(const Problem& problem, const ForwardModel& surrogate, const ForwardModel& true_model, const Objective& objective,
                            const std::vector<EncRound>& own, const AgreementPlan& plan, std::uint64_t seed, int threads, const CalibrationProgress& progress) {
  EncAgreement out;
  const Bounds bounds = bounds_of(problem.shape);
  std::uint64_t searches = 0;
  const auto search = [&](const Objective& by, const std::vector<std::string>& optimizers, const std::string& what) {
    RoundPlan rounds = plan.rounds;
    rounds.optimizers = optimizers;
    rounds.first_stream = ++searches * streams_of_a_search;
    auto found = search_rounds(problem, surrogate, by, rounds, seed, threads, [&](std::size_t done) {
      if (progress) progress(what, done, rounds.rounds);
    });
    for (const auto& r : found.rounds) out.evaluations += r.evaluations;
    return found.rounds;
  };

  // 1. Other optimisers by the same objective, beside the calibration's own.
  std::vector<EncRound> all = own;
  std::vector<std::string> names;
  for (const auto& r : own)
    if (std::find(names.begin(), names.end(), r.optimizer) == names.end()) names.push_back(r.optimizer);
  std::sort(names.begin(), names.end());
  for (const auto& name : plan.optimizers) {
    if (std::find(names.begin(), names.end(), name) != names.end() || (name == gradient_search && !surrogate.has_gradient())) continue;
    names.push_back(name);
    const auto rounds = search(objective, {name}, "rounds of " + name);
    all.insert(all.end(), rounds.begin(), rounds.end());
  }
  const EncRound* best = best_of(all, objective);
  if (!best) return out;
  out.optimizers_agree = true;
  for (const auto& name : names) {
    out.optimizers.push_back(compared(name, all, *best, objective, bounds));
    out.optimizers_agree = out.optimizers_agree && out.optimizers.back().agrees;
  }

  // 2. The same optimisers by other objectives.
  std::vector<Objective> formulations{objective};
  for (const auto& name : plan.objectives)
    if (std::none_of(formulations.begin(), formulations.end(), [&](const auto& f) { return f.name == name; }))
      formulations.push_back(objectives().get(name, "enc.compare_objectives"));
  if (formulations.size() > 1) {
    out.objectives.push_back({.objective = objective.name, .theta = best->theta, .agrees = true, .model = {}, .values = {}});
    for (std::size_t i = 1; i < formulations.size(); ++i) {
      const auto rounds = search(formulations[i], plan.rounds.optimizers, "rounds by " + formulations[i].name);
      const EncRound* answer = best_of(rounds, formulations[i]);
      EncFormulation f{.objective = formulations[i].name, .theta = answer ? answer->theta : std::vector<double>{}, .distance = nan, .model = {}, .values = {}};
      if (answer) {
        f.distance = apart(f.theta, best->theta, bounds);
        f.agrees = f.distance <= agreement_tolerance;
      }
      out.objectives.push_back(std::move(f));
    }
    out.objectives_agree = std::all_of(out.objectives.begin(), out.objectives.end(), [](const auto& f) { return f.agrees; });
    run_model(out, problem, true_model, formulations, threads, progress);
  }
  out.sentence = sentence_of(out, problem.shape);
  return out;
}

Json agreement_json(const EncAgreement& a, const Problem& problem) {
  Json j{{"tolerance", agreement_tolerance},
         {"optimizers_agree", a.optimizers_agree},
         {"objectives_agree", a.objectives.empty() ? Json() : Json(a.objectives_agree)},
         {"sentence", a.sentence}};
  j["optimizers"] = Json::array();
  j["objectives"] = Json::array();
  for (const auto& r : a.optimizers)
    j["optimizers"].push_back({{"name", r.name},
                               {"rounds", r.rounds},
                               {"mean", number(r.mean)},
                               {"sd", number(r.sd)},
                               {"best", number(r.best)},
                               {"theta", named(problem.shape.parameters, r.theta)},
                               {"distance", number(r.distance)},
                               {"shortfall", number(r.shortfall)},
                               {"share_of_rounds", number(r.share)},
                               {"agrees", r.agrees}});
  for (const auto& f : a.objectives) {
    Json values = Json::object();
    for (const auto& [name, value] : f.values) values[name] = value ? Json(*value) : Json();
    const auto& s = f.model.score;
    j["objectives"].push_back({{"name", f.objective},
                               {"theta", named(problem.shape.parameters, f.theta)},
                               {"distance", number(f.distance)},
                               {"agrees", f.agrees},
                               {"accuracy", s.ok && s.banded_sensors > 0 ? number(s.accuracy) : Json()},
                               {"mae", s.ok ? number(s.mae) : Json()},
                               {"objectives_model", values}});
  }
  j["evaluations"] = a.evaluations;
  return j;
}

}  // namespace calomel
