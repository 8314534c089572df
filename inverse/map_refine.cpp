#include "inverse/map_refine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/linear_algebra.hpp"
#include "base/random.hpp"
#include "inverse/map_lessons.hpp"
#include "inverse/mesh_pairs.hpp"
#include "inverse/pair_validation.hpp"
#include "inverse/refined_model.hpp"

namespace calomel {

namespace {

constexpr std::size_t first_round = 6, later_round = 3;
constexpr double not_ruled_out = 150;  ///< log posterior below the best at which a model of the wrong mesh may still be the right one
constexpr std::uint64_t refinement_stream = 4711;
constexpr double reach = 3;  ///< posterior sds of the draws of later rounds: runs that stand about the optimum tell more than runs beside it

double apart(const Eigen::VectorXd& a, const Eigen::VectorXd& b, const Eigen::VectorXd& box) { return (a - b).cwiseQuotient(box).cwiseAbs().maxCoeff(); }

/// Greedy: each further point of the pool is the one farthest from those chosen, in units of the box.
void spread_over(std::vector<Eigen::VectorXd>& chosen, const std::vector<Eigen::VectorXd>& pool, std::size_t wanted, const Eigen::VectorXd& box) {
  while (chosen.size() < wanted) {
    double farthest = 0.01;
    const Eigen::VectorXd* next = nullptr;
    for (const auto& p : pool) {
      double nearest = 1e9;
      for (const auto& c : chosen) nearest = std::min(nearest, apart(p, c, box));
      if (nearest > farthest) farthest = nearest, next = &p;
    }
    if (!next) return;
    chosen.push_back(*next);
  }
}

/// The first round: the optima, then points of the design that are not ruled out, far from one another.
std::vector<Eigen::VectorXd> first_points(MapSearch& search, const std::vector<Optimum>& optima, const Likelihood& likelihood, const Eigen::MatrixXd& design,
                                          const Eigen::VectorXd& box) {
  const SearchSpace& space = search.space();
  std::vector<Eigen::VectorXd> chosen, pool;
  for (const auto& o : optima)
    if (chosen.size() < first_round / 2 && std::all_of(chosen.begin(), chosen.end(), [&](const auto& c) { return apart(c, o.x, box) > 0.03; })) chosen.push_back(o.x);
  const Eigen::VectorXd l = search.scan(likelihood, design);
  std::vector<Eigen::Index> order;
  for (Eigen::Index i = 0; i < l.size(); ++i)
    if (std::isfinite(l[i])) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return l[a] > l[b]; });
  for (std::size_t i = 0; i < order.size(); ++i)
    if (i < 2 * first_round || l[order[i]] > optima[0].log_posterior - not_ruled_out)
      pool.push_back(space.from({design.col(order[i]).data(), std::size_t(design.rows())}));
  spread_over(chosen, pool, first_round, box);
  return chosen;
}

/// A later round: the optimum, and draws from its posterior at which `unsure` is greatest, each apart from the others.
std::vector<Eigen::VectorXd> later_points(const Optimum& best, const SearchSpace& space, RandomStream& random,
                                          const std::function<double(const Eigen::VectorXd&)>& unsure) {
  const Eigen::MatrixXd root = Cholesky(best.covariance).lower();
  const Eigen::VectorXd sd = best.covariance.diagonal().cwiseSqrt();
  std::vector<Eigen::VectorXd> chosen{best.x};
  std::vector<std::pair<double, Eigen::VectorXd>> pool;
  for (int i = 0; i < 60; ++i) {
    Eigen::VectorXd z(best.x.size());
    for (auto& value : z) value = reach * random.normal();
    const Eigen::VectorXd x = (best.x + root * z).cwiseMax(space.low()).cwiseMin(space.high());
    pool.emplace_back(unsure(x), x);
  }
  std::stable_sort(pool.begin(), pool.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [value, x] : pool)
    if (value >= 0 && chosen.size() < later_round && std::all_of(chosen.begin(), chosen.end(), [&](const auto& c) { return apart(c, x, sd) > 1; })) chosen.push_back(x);
  return chosen;
}

/// Standard deviations of the optimum by the repeatability floor alone, (n), in posterior sds: how far another run as good as each would move it.
/// G C_floor G' with the gain G = C J' L^-1 of the linearised mode.
Eigen::VectorXd sd_by_roughness(MapSearch& search, MapModels& current, const Likelihood& likelihood, const Optimum& best) {
  const SearchSpace& space = search.space();
  const Eigen::VectorXd sd = best.covariance.diagonal().cwiseSqrt();
  const PosteriorMode mode(search.model(), likelihood, space, 1);
  const auto at = mode.linearise(best.x, Eigen::MatrixXd(space.secant_widths(best.x, search.secant() * sd, search.secant()).asDiagonal()));
  if (!at) return Eigen::VectorXd::Zero(sd.size());
  const auto theta = space.theta(best.x);
  const Eigen::MatrixXd with = search.likelihood(theta, true).covariance();
  const Eigen::VectorXd smooth = Eigen::VectorXd::Zero(Eigen::Index(search.model().shape().values()));
  const Eigen::VectorXd floor = std::exchange(current.floor_variance, smooth);
  const Eigen::MatrixXd rough = with - search.likelihood(theta, true).covariance();
  current.floor_variance = floor;
  const auto& errors = likelihood.errors();
  const Eigen::MatrixXd gain = best.covariance * at->jacobian.transpose(), whitened = errors.whiten(errors.whiten(rough).transpose());
  return (gain * whitened * gain.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt().cwiseQuotient(sd);
}

/// Whether the optimum stays: it moved by less than `stable`, or in each of the last two rounds by less than the roughness of a run moves it.
bool settled(const std::vector<RefinementRound>& rounds, double stable) {
  const auto within = [](const RefinementRound& r) { return r.moved < r.roughness; };
  const std::size_t n = rounds.size();
  return n > 1 && (rounds[n - 1].moved < stable || (n > 2 && within(rounds[n - 1]) && within(rounds[n - 2])));
}

}  // namespace

std::vector<Optimum> refine_search(MapSummary& out, MapSearch& search, MapModels& current, const MapModels& models, const Eigen::MatrixXd& design,
                                   std::vector<Optimum> optima, std::optional<Likelihood>& likelihood, std::uint64_t seed, const CalibrationProgress& progress) {
  const SearchSpace& space = search.space();
  const MapOptions& options = search.options();
  const Eigen::VectorXd box = space.high() - space.low();
  MapRefinement& record = out.refinement;
  record.before = space.theta(optima[0].x);
  RandomStream random(seed, refinement_stream);
  std::vector<AddedRun> runs;
  std::vector<Eigen::VectorXd> points = first_points(search, optima, *likelihood, design, box);
  const int pairs_wanted = models.has_finer ? options.mesh_pairs : 0;
  int pairs = 0, failed = 0;
  while (int(runs.size()) < options.added_runs || pairs < pairs_wanted) {
    // 1. The runs of this round; the finer mesh with those that come first.
    const int left = std::max(options.added_runs, pairs_wanted) - int(runs.size());
    if (left <= 0) break;
    points.resize(std::min(points.size(), std::size_t(left)));
    Eigen::MatrixXd thetas(space.size(), Eigen::Index(points.size()));
    std::vector<bool> with_fine;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto t = space.theta(points[i]);
      thetas.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXd>(t.data(), space.size());
      with_fine.push_back(pairs < pairs_wanted);
      pairs += with_fine.back();
    }
    for (auto& r : models.add_runs(thetas, with_fine)) failed += !r.done(), runs.push_back(std::move(r));

    // 2. What they teach.
    teach(current, models, runs, search);
    if (current.refined) record.base_ratio = current.refined->base_ratio();

    // 3. The search anew, from the old optima too.
    std::vector<Eigen::VectorXd> also;
    for (const auto& o : optima) also.push_back(o.x);
    const Eigen::VectorXd before = optima[0].x;
    if (models.unknown_directions && record.rounds.size() < 2) current.unknowns = models.unknown_directions(space.theta(before));
    likelihood.emplace(search.likelihood(space.theta(before), true));
    if (auto found = search.global(likelihood, design, also, progress); !found.empty()) optima = std::move(found);
    const Eigen::VectorXd sd = optima[0].covariance.diagonal().cwiseSqrt();
    Eigen::Index farthest = 0;
    const double moved = (optima[0].x - before).cwiseQuotient(sd).cwiseAbs().maxCoeff(&farthest);
    record.rounds.push_back({int(runs.size()), pairs, failed, space.theta(optima[0].x), moved, sd_by_roughness(search, current, *likelihood, optima[0])[farthest]});
    record.stable = settled(record.rounds, options.stable);
    if (record.stable) break;
    points = later_points(optima[0], space, random, [&](const Eigen::VectorXd& x) {
      const auto t = space.theta(x);
      if (!models.surrogate->evaluate(t).ok) return -1.0;  // a run there is likely to fail
      return (current.mesh.empty() ? 0 : current.mesh.kriging().variance_factor(t)) + (current.refined ? current.refined->kriging().variance_factor(t) : 0);
    });
  }
  record.validation = validate_pairs(search, current, models, runs, optima);
  if (record.validation.inflation > 1) out.warnings.push_back(record.validation.sentence);
  if (!record.stable && !record.rounds.empty())
    out.warnings.push_back(fmt::format("the optimum still moved by {:.2g} standard deviations with the last of {} added runs, where the roughness of one run accounts for {:.2g}: {}",
                                       record.rounds.back().moved, runs.size(), record.rounds.back().roughness,
                                       record.rounds.back().moved < record.rounds.back().roughness ? "it may have settled, one round more would tell (map.added_runs)"
                                                                                                     : "allow more (map.added_runs, map.mesh_pairs)"));
  return optima;
}

void judge_mesh(MapSummary& out, const Problem& problem, const MeshError& mesh, const Likelihood& likelihood, const MeshEvidence& at) {
  MapRefinement& record = out.refinement;
  const Eigen::VectorXd d = mesh.difference(out.theta);
  record.mesh_difference = relative_difference(problem, d, at.history);
  const auto& errors = likelihood.errors();
  const Eigen::VectorXd halved = errors.whiten(likelihood.grid().apply(Eigen::VectorXd(-0.5 * d)));
  const Eigen::VectorXd move = -at.covariance * (at.jacobian.transpose() * halved);
  record.next_halving = move.cwiseQuotient(at.covariance.diagonal().cwiseSqrt());
  Eigen::Index worst = 0;
  const double most = record.next_halving.cwiseAbs().maxCoeff(&worst);
  const auto name = [&](Eigen::Index k) { return problem.shape.parameters[std::size_t(k)].name; };
  record.sentence = most > 1 ? fmt::format("the next halving of the element size would still move {} by {:.2g} of its standard deviations: the mesh is too coarse for these records", name(worst), most)
                             : fmt::format("the next halving of the element size would move no parameter by more than {:.2g} of its standard deviations ({})", most, name(worst));
  if (most > 1) out.warnings.push_back(record.sentence);
  const Eigen::MatrixXd gain = at.sharp * at.jacobian.transpose();
  const Eigen::MatrixXd whitened = errors.whiten(errors.whiten(at.mesh_covariance).transpose());
  const Eigen::VectorXd shares = (gain * whitened * gain.transpose()).diagonal().cwiseQuotient(at.sharp.diagonal());
  std::string list;
  for (Eigen::Index k = 0; k < shares.size(); ++k) list += fmt::format("{}{} {:.0f} %", k == 0 ? "" : ", ", name(k), 100 * shares[k]);
  record.sentence += "; of their variances the mesh makes up: " + list;
}

}  // namespace calomel
