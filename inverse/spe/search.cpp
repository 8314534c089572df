#include "inverse/spe/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>

#include "base/median.hpp"
#include "base/parallel.hpp"
#include "base/random.hpp"
#include "inverse/spe/unit_box.hpp"

namespace calomel {

namespace {

constexpr double one_optimum =
    0.02;  ///< ends of searches nearer than this, in units of the bounds, are one optimum: well above where a search stops, well below the smoothing width

struct Optimum {
  Eigen::VectorXd x;
  double f;
  int trials;
};

/// The distinct ends of searches, best first.
std::vector<Optimum> distinct(std::vector<DgsTrial> trials) {
  std::stable_sort(trials.begin(), trials.end(), [](const auto& a, const auto& b) { return a.f < b.f; });
  std::vector<Optimum> out;
  for (const auto& t : trials) {
    const auto same = std::find_if(out.begin(), out.end(), [&](const auto& o) { return (o.x - t.x).cwiseAbs().maxCoeff() <= one_optimum; });
    if (same == out.end())
      out.push_back({t.x, t.f, 1});
    else
      ++same->trials;
  }
  return out;
}

/// Median over the surrogates of their predictions at points of the unit box, as a cost.
std::vector<double> median_costs(const std::vector<SparsePolynomial>& surrogates, const Eigen::MatrixXd& units, const std::string& transform) {
  std::vector<std::vector<double>> all(std::size_t(units.cols()));
  std::vector<double> values(all.size());
  for (const auto& s : surrogates) {
    if (!s.ok()) continue;
    s.expansion.evaluate(units, values);
    for (std::size_t i = 0; i < all.size(); ++i) all[i].push_back(restored(transform, values[i]));
  }
  std::vector<double> out;
  for (auto& v : all) out.push_back(upper_median(std::move(v)));
  return out;
}

void expect_one_surrogate(const std::vector<SparsePolynomial>& surrogates, const SpeOptions& options) {
  if (std::any_of(surrogates.begin(), surrogates.end(), [](const auto& s) { return s.ok(); })) return;
  throw InputError(
      {.problem = "every coefficient of every surrogate vanishes (" + surrogates[0].failure + ")",
       .key = "spe.lambdas",
       .range = options.lambda_scale == "absolute" ? fmt::format("well below {:.3g} for this misfit", surrogates[0].lambda_max) : "smaller multiples",
       .suggestion = "the published values belong to a misfit of another size: take spe.lambda_scale = \"cross_validation\""});
}

}  // namespace

void fit_round(SpeSummary& out, const ScatteredData& data, const SpeOptions& options, std::uint64_t seed, int threads, const CalibrationProgress& progress) {
  if (data.values.size() > 0 && data.values.maxCoeff() == data.values.minCoeff())
    throw InputError({.problem = fmt::format("the misfit is {:.6g} at every one of {} runs: it does not depend on the parameters, or too few runs succeeded",
                                             data.values[0], data.values.size()),
                      .key = "parameter",
                      .suggestion = "vary a number of the case that the records see; more runs: campaign.runs, spe.zoom_runs"});
  const Clock clock;
  auto fitted = fit_sparse_polynomials(data, options, seed, threads, [&](std::size_t done, std::size_t total) {
    if (progress) progress("polynomial spaces", done, total);
  });
  out.spaces = std::move(fitted.spaces);
  out.surrogates = std::move(fitted.surrogates);
  out.too_large = std::move(fitted.too_large);
  out.most_terms = options.most_terms;
  expect_one_surrogate(out.surrogates, options);
  out.fit_s += clock.seconds();
}

void search_round(SpeSummary& out, const Bounds& bounds, const Feasibility& feasibility, const SpeOptions& options, std::uint64_t seed, int threads,
                  const CalibrationProgress& progress) {
  const UnitBox box(bounds);
  const Eigen::Index d = bounds.low.size();
  std::vector<std::vector<Optimum>> found(out.surrogates.size());
  std::vector<std::size_t> left_out(found.size());
  std::mutex lock;
  std::size_t finished = 0;
  parallel_for(out.surrogates.size(), threads, [&](std::size_t i) {
    const auto& surrogate = out.surrogates[i];
    if (surrogate.ok()) {
      RandomStream random(seed, i);
      const Eigen::MatrixXd starts = Eigen::MatrixXd::NullaryExpr(d, options.trials, [&] { return random.uniform(); });
      const BatchFunction function = [&](const Eigen::MatrixXd& units, std::span<double> values) { surrogate.expansion.evaluate(units, values); };
      found[i] = distinct(minimise_dgs(function, starts, options.dgs, options.iterations, random()));
      left_out[i] = std::erase_if(found[i], [&](const auto& o) { return !feasibility.feasible(box.theta(o.x)); });
    }
    const std::lock_guard guard(lock);
    if (progress) progress("surrogates", ++finished, out.surrogates.size());
  });
  out.optima.clear(), out.modes.clear();
  out.optima_left_out = std::accumulate(left_out.begin(), left_out.end(), std::size_t{0});
  std::vector<const Optimum*> all;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (out.surrogates[i].ok())
      out.evaluations += std::size_t(options.trials) * (1 + std::size_t(options.iterations) * dgs_evaluations(options.dgs, std::size_t(d)));
    for (const auto& o : found[i]) {
      all.push_back(&o);
      out.optima.push_back({i, box.theta(o.x), out.objective.cost(restored(options.transform, o.f)), o.trials});
    }
  }
  if (all.empty()) return;
  Eigen::MatrixXd pool(d, Eigen::Index(all.size()));
  for (std::size_t i = 0; i < all.size(); ++i) pool.col(Eigen::Index(i)) = all[i]->x;
  for (const auto& m : density_modes(pool, options.bandwidth)) {
    const double cost = median_costs(out.surrogates, m.x, options.transform)[0];
    out.modes.push_back({box.theta(m.x), out.objective.cost(cost), m.density, m.points});
  }
}

std::vector<Proposal> proposals(const SpeSummary& s, const Bounds& bounds, const std::string& transform, const std::vector<std::vector<double>>& thetas) {
  const UnitBox box(bounds);
  std::vector<Proposal> out;
  for (const auto& theta : thetas) {
    const bool inside = box.contains(theta);
    out.push_back({inside ? median_costs(s.surrogates, box.unit(theta), transform)[0] : std::numeric_limits<double>::quiet_NaN(), theta});
  }
  return out;
}

std::vector<Proposal> ranked_proposals(const SpeSummary& s, const Bounds& box, const std::string& transform) {
  std::vector<std::vector<double>> modes, optima;
  for (const auto& m : s.modes) modes.push_back(m.theta);
  for (const auto& o : s.optima) optima.push_back(o.theta);
  auto ranked = proposals(s, box, transform, modes);
  auto rest = proposals(s, box, transform, optima);
  std::stable_sort(rest.begin(), rest.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
  ranked.insert(ranked.end(), rest.begin(), rest.end());
  return ranked;
}

}  // namespace calomel
