#include "uq/diagnosis/held_out.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace calomel {

namespace {

constexpr double on_face = 1e-4;    ///< [m] between a gauge and the outermost gauge of its face, at most
constexpr double of_target = 1e-3;  ///< [m] between the outermost gauge and the target's own plane, at most: gauges' places are those of the case
constexpr std::size_t parts = 4;    ///< of a single record

using Gauges = std::vector<std::size_t>;  ///< observations

/// The groups of a map, by their keys.
template <class Key>
std::vector<Gauges> groups_of(std::map<Key, Gauges> by_key) {
  std::vector<Gauges> all;
  for (auto& [key, gauges] : by_key) all.push_back(std::move(gauges));
  return all;
}

/// Each gauge by itself, under all conditions that it recorded; where there is one gauge, each condition by itself.
std::vector<Gauges> each_alone(const Problem& problem) {
  std::map<std::size_t, Gauges> by_sensor, by_observation;
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    by_sensor[problem.observations[i].sensor].push_back(i);
    by_observation[i].push_back(i);
  }
  return groups_of(by_sensor.size() > 1 ? std::move(by_sensor) : std::move(by_observation));
}

std::vector<Gauges> gauges_by_face(const Problem& problem, const GaugePlaces& places) {
  if (places.outermost.size() == 0) return each_alone(problem);
  std::map<int, Gauges> by_face;
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const auto s = Eigen::Index(problem.observations[i].sensor);
    int face = 6;  // the first of the target's outermost planes that the gauge sits on: z, x, y
    for (const int axis : {1, 0, 2})
      for (const bool upper : {true, false}) {
        const double edge = upper ? places.positions.col(axis).maxCoeff() : places.positions.col(axis).minCoeff();
        if (std::abs(edge - places.outermost(upper, axis)) < of_target && std::abs(places.positions(s, axis) - edge) < on_face) face = 2 * axis + upper;
      }
    by_face[face].push_back(i);
  }
  return by_face.size() < 3 ? each_alone(problem) : groups_of(std::move(by_face));
}

}  // namespace

std::vector<Fold> folds_by_face(const Problem& problem, const Decimation& grid, const GaugePlaces& places) {
  std::vector<Fold> folds;
  if (grid.observations() == 1) {
    const std::size_t n = grid.size();
    for (std::size_t p = 0; p < parts && n >= 2 * parts; ++p) {
      Fold& f = folds.emplace_back();
      f.records = 1.0 / parts;
      for (std::size_t k = n * p / parts; k < n * (p + 1) / parts; ++k) f.rows.push_back(Eigen::Index(k));
    }
    return folds;
  }
  for (const auto& gauges : gauges_by_face(problem, places)) folds.push_back(fold_of(grid, gauges));
  return folds;
}

Fold fold_of(const Decimation& grid, const std::vector<std::size_t>& observations) { return {rows_of(grid, observations), double(observations.size())}; }

std::vector<Eigen::Index> rows_of(const Decimation& grid, const std::vector<std::size_t>& observations) {
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < grid.observations(); ++i) {
    if (std::find(observations.begin(), observations.end(), i) == observations.end()) continue;
    for (std::size_t k = 0; k < grid.windows(i).size(); ++k) rows.push_back(Eigen::Index(grid.offset(i) + k));
  }
  return rows;
}

LogPosterior part_of(const PosteriorFit& fit, const std::vector<WeightedErrors>& hypotheses, const std::vector<Eigen::Index>& rows) {
  std::vector<RecordErrors> parts;
  for (const auto& h : hypotheses)
    parts.push_back({Eigen::MatrixXd(h.errors.covariance()(rows, rows)), Eigen::VectorXd(h.errors.data()(rows)), h.errors.freedom(), h.log_weight});
  const LogPosterior& all = *fit.posterior;
  return {all.box(),    all.emulator(),    Eigen::MatrixXd(fit.coefficients(rows, Eigen::all)), parts, Eigen::MatrixXd(fit.noise(rows, rows)),
          all.priors(), all.beyond_prior()};
}

namespace {

/// The grid's rows that are not the fold's.
std::vector<Eigen::Index> rows_without(const Fold& fold, const Decimation& grid) {
  std::vector<Eigen::Index> rest;
  for (Eigen::Index k = 0; k < Eigen::Index(grid.size()); ++k)
    if (!std::binary_search(fold.rows.begin(), fold.rows.end(), k)) rest.push_back(k);
  return rest;
}

/// The best mode of a part of a fit, from the modes of the whole.
LocalMode mode_of_part(const LogPosterior& part, const PosteriorFit& whole) {
  std::vector<Eigen::VectorXd> starts;
  for (const auto& m : whole.modes) starts.push_back(m.q);
  auto modes = find_modes(part, starts);
  if (modes.empty()) throw NumericsError("no mode was found without some of the gauges");
  return std::move(modes[0]);
}

}  // namespace

PartFit fit_without(const PosteriorFit& fit, const PosteriorFit& errors, const Fold& fold) {
  const LogPosterior part = part_of(fit, errors.hypotheses, rows_without(fold, fit.errors->grid()));
  const LocalMode m = mode_of_part(part, fit);
  return {.log_evidence = log_evidence(part, m),
          .prediction = fit.coefficients * part.emulator().features(m.at.u, m.at.beyond),
          .history = fit.history(m.at.u, m.at.beyond)};
}

namespace {

/// The fold's rows that are of one observation.
std::vector<Eigen::Index> rows_in(const Fold& fold, const Decimation& grid, std::size_t observation) {
  const auto at = Eigen::Index(grid.offset(observation)), end = at + Eigen::Index(grid.windows(observation).size());
  return {std::lower_bound(fold.rows.begin(), fold.rows.end(), at), std::lower_bound(fold.rows.begin(), fold.rows.end(), end)};
}

}  // namespace

double misfit_of(const Fold& fold, const Decimation& grid, const Eigen::VectorXd& prediction, const Eigen::VectorXd& data) {
  double sum = 0, records = 0;
  for (std::size_t i = 0; i < grid.observations(); ++i) {
    const auto rows = rows_in(fold, grid, i);
    if (rows.empty()) continue;
    const auto at = Eigen::Index(grid.offset(i)), n = Eigen::Index(grid.windows(i).size());
    const double size = std::min(data.segment(at, n).norm() / std::sqrt(double(n)), greatest_amplitude(data.segment(at, n)));
    sum += (prediction - data)(rows).norm() / (size * std::sqrt(double(rows.size())));
    ++records;
  }
  return sum / records;
}

double misfit_of_all(const Decimation& grid, const Eigen::VectorXd& prediction, const Eigen::VectorXd& data) {
  std::vector<std::size_t> all(grid.observations());
  std::iota(all.begin(), all.end(), 0);
  return misfit_of(fold_of(grid, all), grid, prediction, data);
}

void keep_held_out(const Fold& fold, const Decimation& grid, const Problem& problem, const Eigen::VectorXd& history, std::vector<double>& into) {
  if (into.empty()) into.assign(std::size_t(history.size()), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < grid.observations(); ++i) {
    const auto rows = rows_in(fold, grid, i);
    if (rows.empty()) continue;
    const auto& o = problem.observations[i];
    const auto& windows = grid.windows(i);
    const std::size_t at = problem.shape.at(o.condition, o.sensor, 0), first = std::size_t(rows.front()) - grid.offset(i),
                      last = std::size_t(rows.back()) - grid.offset(i);
    const double infinity = std::numeric_limits<double>::infinity();
    const double begin = first == 0 ? -infinity : 0.5 * (windows[first - 1].time + windows[first].time);
    const double end = last + 1 == windows.size() ? infinity : 0.5 * (windows[last].time + windows[last + 1].time);
    for (std::size_t t = 0; t < problem.shape.times.size(); ++t)
      if (problem.shape.times[t] >= begin && problem.shape.times[t] < end) into[at + t] = history[Eigen::Index(at + t)];
  }
}

HeldOut::HeldOut(const Problem& problem, const PosteriorFit& base, const GaugePlaces& places)
    : problem_(problem), base_(base), folds_(folds_by_face(problem, base.errors->grid(), places)) {
  base_fit_ = left_out(base);
  std::ranges::fill(base_fit_.log_bayes_factor, 0.0);
}

HeldOutFit HeldOut::left_out(const PosteriorFit& fit) const {
  const Decimation& grid = base_.errors->grid();
  HeldOutFit out;
  for (const auto& f : folds_) {
    const PartFit part = fit_without(fit, fit, f);
    out.misfit.push_back(misfit_of(f, grid, part.prediction, base_.errors->data()));
    out.log_bayes_factor.push_back(part.log_evidence);
    keep_held_out(f, grid, problem_, part.history, out.history);
  }
  return out;
}

HeldOutFit HeldOut::by(const PosteriorFit& fit) const {
  HeldOutFit out = left_out(fit);
  for (std::size_t i = 0; i < folds_.size(); ++i) out.log_bayes_factor[i] -= fit_without(base_, fit, folds_[i]).log_evidence;
  return out;
}

HeldOutFit HeldOut::by(const LinearBeside& linear) const {
  const Decimation& grid = base_.errors->grid();
  HeldOutFit out;
  for (const auto& f : folds_) {
    const PartFit part = fit_without_fold(linear, f);
    out.misfit.push_back(misfit_of(f, grid, part.prediction, base_.errors->data()));
    out.log_bayes_factor.push_back(part.log_evidence - fit_without(base_, linear.fit, f).log_evidence);
    keep_held_out(f, grid, problem_, part.history, out.history);
  }
  return out;
}

std::pair<double, double> HeldOut::beginning(const LinearBeside& linear) const {
  const Decimation& grid = base_.errors->grid();
  Fold f;
  for (std::size_t i = 0; i < grid.observations(); ++i) {
    const auto& windows = grid.windows(i);
    for (std::size_t k = 0; k < windows.size(); ++k)
      if (windows[k].time < windows.front().time + (windows.back().time - windows.front().time) / 4) f.rows.push_back(Eigen::Index(grid.offset(i) + k));
  }
  const Eigen::VectorXd& data = base_.errors->data();
  return {misfit_of(f, grid, fit_without(linear.fit, linear.fit, f).prediction, data), misfit_of(f, grid, fit_without_fold(linear, f).prediction, data)};
}

PartFit HeldOut::fit_without_fold(const LinearBeside& linear, const Fold& f) const {
  const Decimation& grid = base_.errors->grid();
  const auto rows = rows_without(f, grid);
  const LogPosterior with = part_of(linear.fit, linear.with, rows), without = part_of(linear.fit, linear.without, rows);
  const LocalMode m = mode_of_part(with, linear.fit);
  const AddedDirections of_rows{.by_number = linear.directions.by_number(rows, Eigen::all), .prior_sd = linear.directions.prior_sd};
  const Eigen::VectorXd numbers = numbers_beside(without, m.at, of_rows, with.likeliest(m.at));
  const Eigen::VectorXd change = linear.rest + linear.effects * numbers;
  return {.log_evidence = log_evidence(with, m),
          .prediction = linear.fit.coefficients * with.emulator().features(m.at.u, m.at.beyond) + grid.apply(change),
          .history = linear.fit.history(m.at.u, m.at.beyond) + change};
}

std::vector<HeldOutCondition> HeldOut::by_condition(const PosteriorFit* named) const {
  std::vector<HeldOutCondition> all;
  const auto& conditions = problem_.shape.conditions;
  const Decimation& grid = base_.errors->grid();
  for (std::size_t c = 0; c < conditions.size() && conditions.size() > 1; ++c) {
    std::vector<std::size_t> observations;
    for (std::size_t i = 0; i < problem_.observations.size(); ++i)
      if (problem_.observations[i].condition == c) observations.push_back(i);
    if (observations.empty() || observations.size() == problem_.observations.size()) continue;
    const Fold fold = fold_of(grid, observations);
    const auto misfit = [&](const PosteriorFit& fit) { return misfit_of(fold, grid, fit_without(fit, fit, fold).prediction, base_.errors->data()); };
    const double before = misfit(base_);
    all.push_back({conditions[c], before, named ? misfit(*named) : before});
  }
  return all;
}

double HeldOut::mean(const std::vector<double>& by_fold) const {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < folds_.size(); ++i) {
    sum += by_fold[i] * folds_[i].records;
    count += folds_[i].records;
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace calomel
