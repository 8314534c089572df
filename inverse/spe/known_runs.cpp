#include "inverse/spe/known_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "forward/campaign/design.hpp"
#include "forward/surrogate/training.hpp"
#include "inverse/spe/spe.hpp"
#include "inverse/spe/unit_box.hpp"

namespace calomel {

namespace {

/// Runs nearer than this, in units of the box, give the surrogates nothing new.
constexpr double same_place = 1e-3;

}  // namespace

KnownRuns::KnownRuns(const Problem& problem, const Archive& archive, const Objective& objective, const SpeOptions& options, std::uint64_t seed)
    : problem_(problem), archive_(archive), objective_(objective), options_(options) {
  const auto split = split_runs(archive, options.validation_fraction, seed);
  excluded_ = split.excluded;
  const auto point = [&](std::size_t run) {
    const Eigen::VectorXd theta = archive.theta.col(Eigen::Index(run));
    return std::vector<double>(theta.begin(), theta.end());
  };
  for (const bool held_out : {false, true})
    for (const auto run : held_out ? split.test : split.train)
      runs_.push_back({.theta = point(run), .history = archive.mean.col(Eigen::Index(run)), .held_out = held_out, .of_campaign = true});
  for (std::size_t run = 0; run < archive.runs(); ++run) seen_.emplace_back(point(run), archive.status[run] == RunStatus::failed);
}

void KnownRuns::price(Run& run) const {
  const auto cost = [&](const Eigen::VectorXd& history) {
    return objective_.cost(objective_.value(score(problem_, {history.data(), std::size_t(history.size())})));
  };
  const Eigen::VectorXd history = run.history.cast<double>();
  run.cost = run.cost_without = cost(history);
  if (correction_ && !correction_->empty()) run.cost = cost(history + correction_->shift(run.theta));
}

bool KnownRuns::usable(const Run& run) const { return std::isfinite(run.cost) && (options_.transform != "log" || run.cost > 0); }

bool KnownRuns::add(const std::vector<double>& theta, const Prediction& run, bool held_out, const Bounds& box) {
  const bool fresh = std::none_of(seen_.begin(), seen_.end(), [&](const auto& s) { return distance({0, s.first}, {0, theta}, box) < same_place; });
  if (!fresh) return false;
  const Eigen::VectorXf history = Eigen::Map<const Eigen::VectorXd>(run.mean.data(), Eigen::Index(run.mean.size())).cast<float>();
  const bool done = run.ok && history.allFinite();
  seen_.emplace_back(theta, !done);
  if (!done) return false;
  Run r{.theta = theta, .history = history, .held_out = held_out};
  price(r);
  if (!usable(r)) return false;
  runs_.push_back(std::move(r));
  return true;
}

void KnownRuns::price(const MeshCorrection* correction) {
  correction_ = correction;
  for (auto& r : runs_) {
    price(r);
    if (r.of_campaign && options_.transform == "log" && !(r.cost > 0))
      throw InputError({.problem = fmt::format("the misfit \"{}\" is not positive at every run and has no logarithm", objective_.name),
                        .key = "spe.transform",
                        .value = "\"log\"",
                        .suggestion = "take spe.transform = \"none\""});
  }
}

ScatteredData KnownRuns::data(const Bounds& box, bool whole) const {
  const auto& chebyshev = designs().get("chebyshev");
  const bool weighted = whole && designs().get(archive_.design).measure != chebyshev.measure;
  const UnitBox units(box);
  std::vector<const Run*> inside;
  for (const auto& r : runs_)
    if (usable(r) && (whole || units.contains(r.theta))) inside.push_back(&r);
  ScatteredData data;
  data.units.resize(archive_.theta.rows(), Eigen::Index(inside.size()));
  data.values.resize(data.units.cols());
  data.weights = Eigen::VectorXd::Ones(data.units.cols());
  for (std::size_t i = 0; i < inside.size(); ++i) {
    const auto at = Eigen::Index(i);
    (inside[i]->held_out ? data.validation : data.train).push_back(i);
    data.units.col(at) = units.unit(inside[i]->theta);
    data.values[at] = transformed(options_.transform, inside[i]->cost);
    if (weighted && inside[i]->of_campaign)
      data.weights[at] = std::sqrt(chebyshev.density(data.units.col(at)) / design_density(archive_.design, data.units.col(at)));
  }
  return data;
}

std::vector<Proposal> KnownRuns::ranked(std::size_t of_campaign) const {
  std::vector<Proposal> campaign, all;
  for (const auto& r : runs_)
    if (usable(r)) (r.of_campaign ? campaign : all).push_back({r.cost, r.theta});
  const auto cheaper = [](const auto& a, const auto& b) { return a.cost < b.cost; };
  std::stable_sort(campaign.begin(), campaign.end(), cheaper);
  campaign.resize(std::min(campaign.size(), of_campaign));
  all.insert(all.end(), campaign.begin(), campaign.end());
  std::stable_sort(all.begin(), all.end(), cheaper);
  return all;
}

std::vector<double> KnownRuns::best_without_correction() const {
  const auto best = std::min_element(runs_.begin(), runs_.end(), [](const auto& a, const auto& b) { return a.cost_without < b.cost_without; });
  return best == runs_.end() ? std::vector<double>{} : best->theta;
}

const KnownRuns::Run* KnownRuns::find(const std::vector<double>& theta) const {
  const auto r = std::find_if(runs_.begin(), runs_.end(), [&](const auto& x) { return x.theta == theta; });
  return r == runs_.end() ? nullptr : &*r;
}

const Eigen::VectorXf& KnownRuns::history(const std::vector<double>& theta) const {
  const Run* r = find(theta);
  expect(r != nullptr, "the point was run");
  return r->history;
}

Feasibility KnownRuns::feasibility() const {
  Eigen::MatrixXd thetas(archive_.theta.rows(), Eigen::Index(seen_.size()));
  std::vector<bool> failed;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    thetas.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXd>(seen_[i].first.data(), thetas.rows());
    failed.push_back(seen_[i].second);
  }
  return {problem_.shape.parameters, thetas, failed};
}

std::size_t KnownRuns::added() const {
  return std::size_t(std::count_if(runs_.begin(), runs_.end(), [](const auto& r) { return !r.of_campaign; }));
}

ScatteredData discrepancies(const Problem& problem, const Archive& archive, const Objective& objective, const SpeOptions& options, std::uint64_t seed,
                            std::size_t* excluded) {
  KnownRuns runs(problem, archive, objective, options, seed);
  runs.price(nullptr);
  if (excluded) *excluded = runs.excluded();
  return runs.data(bounds_of(problem.shape), true);
}

}  // namespace calomel
