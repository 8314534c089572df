#include "inverse/mesh_pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.hpp"
#include "forward/campaign/campaign.hpp"

namespace calomel {

namespace {

constexpr double same_place = 1e-3;       ///< in units of the bounds
constexpr double told_apart = 0.01;       ///< likewise: nearer points teach a first round nothing
constexpr std::size_t good_runs = 10;     ///< of the campaign, from which the first pairs are drawn

void append(Eigen::MatrixXd& m, const Eigen::VectorXd& column) {
  m.conservativeResize(column.size(), m.cols() + 1);
  m.col(m.cols() - 1) = column;
}

/// "density -1.2 %, tensile_cutoff +3.0 %": from the answer without the shift to the one with it.
std::string moves(const ModelShape& shape, const std::vector<double>& from, const std::vector<double>& to) {
  std::vector<std::string> words;
  for (std::size_t k = 0; k < from.size(); ++k)
    words.push_back(from[k] != 0 ? fmt::format("{} {:+.1f} %", shape.parameters[k].name, 100 * (to[k] / from[k] - 1))
                                 : fmt::format("{} {:+.4g}", shape.parameters[k].name, to[k]));
  return join(words);
}

}  // namespace

Eigen::VectorXd values_of(const std::vector<float>& history) { return Eigen::Map<const Eigen::VectorXf>(history.data(), Eigen::Index(history.size())).cast<double>(); }

double relative_difference(const Problem& problem, const Eigen::VectorXd& difference, std::span<const double> history) {
  const auto n = Eigen::Index(problem.shape.times.size());
  double sum = 0;
  for (const auto& o : problem.observations) {
    const auto at = Eigen::Index(problem.shape.at(o.condition, o.sensor, 0));
    sum += difference.segment(at, n).norm() / Eigen::Map<const Eigen::VectorXd>(history.data() + at, n).norm();
  }
  return sum / double(problem.observations.size());
}

FieldInfo mesh_pairs_info() {
  return {.range = between(0, 20),
          .doc = "at most so many pairs of runs, on the case's mesh and on one of half the element size (8 times as costly, 16 in three dimensions): they tell the mesh's error, "
                 "which is added to every prediction; 0 as published"};
}

FieldInfo mesh_beyond_info() {
  return {.range = between(0, 3),
          .doc = "how far beyond the finer mesh predictions are carried, in units of (finer - working): 0 on it, 1 at vanishing elements where errors fall with the element size, "
                 "at the price of the differences' own scatter"};
}

RunSource without_journal(const ForwardModel& working, const ForwardModel* finer, int threads) {
  RunSource source{.run = {}, .has_finer = finer != nullptr};
  source.run = [&working, finer, threads](const Eigen::MatrixXd& thetas, const std::vector<bool>& with_fine) {
    std::vector<AddedRun> runs(with_fine.size());
    parallel_for(runs.size(), threads, [&](std::size_t i) {
      AddedRun& r = runs[i];
      r.theta.assign(thetas.col(Eigen::Index(i)).data(), thetas.col(Eigen::Index(i)).data() + thetas.rows());
      r.working = evaluate_run(working, r.theta, false);
      if (finer && with_fine[i]) r.fine = evaluate_run(*finer, r.theta, false);
    });
    return runs;
  };
  return source;
}

void farthest_first(std::vector<Proposal>& chosen, const std::vector<Proposal>& pool, std::size_t n, const Bounds& bounds) {
  while (chosen.size() < n) {
    const Proposal* next = nullptr;
    double farthest = told_apart;
    for (const auto& p : pool) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& c : chosen) nearest = std::min(nearest, distance(p, c, bounds));
      if (nearest > farthest) next = &p, farthest = nearest;
    }
    if (!next) return;
    chosen.push_back(*next);
  }
}

std::vector<Proposal> ranked_runs(const Archive& archive, const std::function<double(std::span<const double>, std::span<const double>)>& cost) {
  std::vector<Proposal> ranked;
  for (const auto i : archive.completed()) {
    const auto column = Eigen::Index(i);
    const Eigen::VectorXd theta = archive.theta.col(column), values = archive.mean.col(column).cast<double>();
    Proposal p{cost({theta.data(), std::size_t(theta.size())}, {values.data(), std::size_t(values.size())}), {theta.begin(), theta.end()}};
    if (std::isfinite(p.cost)) ranked.push_back(std::move(p));
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
  return ranked;
}

std::vector<std::vector<double>> first_pair_points(const std::vector<std::vector<double>>& given, const std::vector<Proposal>& ranked, std::size_t n, const Bounds& bounds) {
  std::vector<Proposal> all;
  for (const auto& g : given) all.push_back({0, g});
  auto chosen = spread_out(all, n, same_place, bounds);
  farthest_first(chosen, {ranked.begin(), ranked.begin() + std::ptrdiff_t(std::min(good_runs, ranked.size()))}, n, bounds);
  std::vector<std::vector<double>> points;
  for (auto& c : chosen) points.push_back(std::move(c.theta));
  return points;
}

MeshPairs::MeshPairs(const ModelShape& shape, const RunSource& source, const RememberingModel& memory, int wanted, double beyond)
    : shape_(shape), source_(source), memory_(memory), wanted_(source.run && source.has_finer ? wanted : 0), beyond_(beyond) {}

std::vector<AddedRun> MeshPairs::add(const std::vector<std::vector<double>>& points, std::size_t pairs) {
  Eigen::MatrixXd thetas(Eigen::Index(shape_.parameters.size()), Eigen::Index(points.size()));
  std::vector<bool> with_fine(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    thetas.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXd>(points[i].data(), thetas.rows());
    with_fine[i] = i < pairs && left() > 0;
    if (with_fine[i]) ++asked_, asked_at_.push_back(points[i]);
  }
  const Clock clock;
  auto runs = source_.run(thetas, with_fine);
  seconds_ += clock.seconds();
  for (const auto& r : runs) {
    if (r.fine) failed_ += !r.done();
    memory_.learn(r.theta, {.ok = r.working.done, .message = r.working.message, .mean = {r.working.mean.begin(), r.working.mean.end()}}, true);
    if (!r.working.done) continue;
    const Eigen::VectorXd theta = Eigen::Map<const Eigen::VectorXd>(r.theta.data(), thetas.rows()), working = values_of(r.working.mean);
    append(theta_, theta), append(working_, working);
    if (r.paired()) append(pair_theta_, theta), append(pair_working_, working), append(difference_, values_of(r.fine->mean) - working);
  }
  if (pair_theta_.cols() >= 2) mesh_ = MeshError(shape_.parameters, pair_theta_, difference_, {.mean = beyond_});
  return runs;
}

void MeshPairs::run_unknown(std::span<const Proposal> points, std::size_t n) {
  std::vector<std::vector<double>> unknown;
  for (const auto& p : points.first(std::min(n, points.size())))
    if (!memory_.knows(p.theta)) unknown.push_back(p.theta);
  if (!unknown.empty()) add(unknown, 0);
}

std::vector<LeftOutPair> MeshPairs::left_out() const {
  std::vector<LeftOutPair> out;
  const Eigen::Index n = pair_theta_.cols();
  for (Eigen::Index j = 0; n >= 3 && j < n; ++j) {
    std::vector<Eigen::Index> rest;
    for (Eigen::Index i = 0; i < n; ++i)
      if (i != j) rest.push_back(i);
    out.push_back({{pair_theta_.col(j).begin(), pair_theta_.col(j).end()},
                   pair_working_.col(j) + (1 + beyond_) * difference_.col(j),
                   MeshError(shape_.parameters, pair_theta_(Eigen::all, rest), difference_(Eigen::all, rest), {.mean = beyond_})});
  }
  return out;
}

bool MeshPairs::paired(const std::vector<double>& theta) const {
  const Bounds bounds = bounds_of(shape_);
  return std::any_of(asked_at_.begin(), asked_at_.end(), [&](const auto& a) { return distance({0, a}, {0, theta}, bounds) < same_place; });
}

void MeshPairs::describe(Calibration& out, const Problem& problem) const {
  MeshCorrection& m = out.mesh;
  m.wanted = wanted_, m.pairs = int(difference_.cols()), m.failed = failed_, m.beyond = beyond_;
  if (wanted_ == 0) return;
  if (!m.used()) {
    m.sentence = fmt::format("the mesh's error is not taken into account: {} of {} pairs of runs failed", failed_, asked_);
    out.warnings.push_back(m.sentence);
    return;
  }
  const auto without_shift = [&](const std::vector<double>& theta, const std::vector<double>& values) {
    const Eigen::VectorXd shift = mesh_.shift(theta);
    std::vector<double> own = values;
    for (std::size_t i = 0; i < own.size(); ++i) own[i] -= shift[Eigen::Index(i)];
    return own;
  };
  if (!out.nominal_values.empty()) m.nominal_values = without_shift(out.nominal, out.nominal_values), m.at_nominal = score(problem, m.nominal_values);
  m.sentence = fmt::format("{} pairs of runs tell what half the element size changes, {} times which is added to every prediction here", m.pairs, 1 + m.beyond);
  if (!out.calibrated.empty()) {
    m.calibrated = without_shift(out.theta, out.calibrated), m.best = score(problem, m.calibrated);
    m.difference = relative_difference(problem, mesh_.difference(out.theta), m.calibrated);
    m.sentence += fmt::format("; at the answer that is {:.2g} % of the histories", 100 * (1 + m.beyond) * m.difference);
  }
  if (!m.without.empty()) m.sentence += fmt::format("; against the answer without it: {}", moves(problem.shape, m.without, out.theta));
}

}  // namespace calomel
