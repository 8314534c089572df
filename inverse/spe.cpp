#include "inverse/spe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>

#include "base/parallel.hpp"
#include "base/random.hpp"
#include "inverse/spe/unit_box.hpp"

namespace calomel {

namespace {

/// Runs nearer than this, in units of the bounds, tell the surrogates nothing new.
constexpr double same_place = 1e-3;

/// A model that keeps what it has computed: candidates of one round may stand again in the next.
class RememberingModel final : public ForwardModel {
 public:
  explicit RememberingModel(const ForwardModel& model) : model_(model) {}
  [[nodiscard]] const ModelShape& shape() const override { return model_.shape(); }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override {
    const std::vector<double> key(theta.begin(), theta.end());
    {
      const std::lock_guard guard(lock_);
      if (const auto it = known_.find(key); it != known_.end()) return it->second;
    }
    const Prediction p = model_.evaluate(theta);
    const std::lock_guard guard(lock_);
    return known_.emplace(key, p).first->second;
  }
  [[nodiscard]] std::size_t runs() const { return known_.size(); }

 private:
  const ForwardModel& model_;
  mutable std::mutex lock_;
  mutable std::map<std::vector<double>, Prediction> known_;
};

struct Optimum {
  Eigen::VectorXd x;
  double f;
  int trials;
};

/// The distinct ends of searches, best first.
std::vector<Optimum> distinct(std::vector<DgsTrial> trials, double merge) {
  std::stable_sort(trials.begin(), trials.end(), [](const auto& a, const auto& b) { return a.f < b.f; });
  std::vector<Optimum> out;
  for (const auto& t : trials) {
    const auto same = std::find_if(out.begin(), out.end(), [&](const auto& o) { return (o.x - t.x).cwiseAbs().maxCoeff() <= merge; });
    if (same == out.end())
      out.push_back({t.x, t.f, 1});
    else
      ++same->trials;
  }
  return out;
}

/// Median over the surrogates of what they say at points of the unit box, as a cost.
std::vector<double> median_costs(const std::vector<SparsePolynomial>& surrogates, const Eigen::MatrixXd& units, const std::string& transform) {
  std::vector<std::vector<double>> all(std::size_t(units.cols()));
  std::vector<double> values(all.size());
  for (const auto& s : surrogates) {
    if (!s.ok()) continue;
    s.expansion.evaluate(units, values);
    for (std::size_t i = 0; i < all.size(); ++i) all[i].push_back(restored(transform, values[i]));
  }
  std::vector<double> out;
  for (auto& v : all) {
    const auto middle = v.begin() + std::ptrdiff_t(v.size() / 2);
    std::nth_element(v.begin(), middle, v.end());
    out.push_back(*middle);
  }
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

/// Fits the surrogates to `data` and warns of those that were left out.
void fit_round(SpeSummary& out, const ScatteredData& data, const SpeOptions& options, std::uint64_t seed, int threads, const CalibrationProgress& progress) {
  const Clock clock;
  auto fitted = fit_sparse_polynomials(data, options, seed, threads, [&](std::size_t done, std::size_t total) {
    if (progress) progress("polynomial spaces", done, total);
  });
  out.spaces = std::move(fitted.spaces), out.surrogates = std::move(fitted.surrogates);
  out.fit_warnings = std::move(fitted.warnings);
  expect_one_surrogate(out.surrogates, options);
  const auto fails = [](const auto& s) { return !s.ok(); };
  if (const auto n = std::count_if(out.surrogates.begin(), out.surrogates.end(), fails); n > 0)
    out.fit_warnings.push_back(fmt::format("{} of {} surrogates were left out: {}", n, out.surrogates.size(),
                                           std::find_if(out.surrogates.begin(), out.surrogates.end(), fails)->failure));
  out.fit_s += clock.seconds();
}

/// Many searches of each surrogate, side by side; each has its own random stream. Fills optima and modes.
void search_round(SpeSummary& out, const UnitBox& box, Eigen::Index d, const SpeOptions& options, std::uint64_t seed, int threads,
                  const CalibrationProgress& progress) {
  std::vector<std::vector<Optimum>> found(out.surrogates.size());
  std::mutex lock;
  std::size_t finished = 0;
  parallel_for(out.surrogates.size(), threads, [&](std::size_t i) {
    const auto& surrogate = out.surrogates[i];
    if (surrogate.ok()) {
      RandomStream random(seed, i);
      const Eigen::MatrixXd starts = Eigen::MatrixXd::NullaryExpr(d, options.trials, [&] { return random.uniform(); });
      const BatchFunction function = [&](const Eigen::MatrixXd& units, std::span<double> values) { surrogate.expansion.evaluate(units, values); };
      found[i] = distinct(minimise_dgs(function, starts, options.dgs, options.iterations, random()), options.merge);
    }
    const std::lock_guard guard(lock);
    if (progress) progress("surrogates", ++finished, out.surrogates.size());
  });
  out.optima.clear(), out.modes.clear();
  std::vector<const Optimum*> all;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (out.surrogates[i].ok())
      out.evaluations += std::size_t(options.trials) * (1 + std::size_t(options.iterations) * dgs_evaluations(options.dgs, std::size_t(d)));
    for (const auto& o : found[i]) {
      all.push_back(&o);
      out.optima.push_back({i, box.theta(o.x), out.objective.cost(restored(options.transform, o.f)), o.trials});
    }
  }
  Eigen::MatrixXd pool(d, Eigen::Index(all.size()));
  for (std::size_t i = 0; i < all.size(); ++i) pool.col(Eigen::Index(i)) = all[i]->x;
  for (const auto& m : density_modes(pool, options.bandwidth)) {
    const double cost = median_costs(out.surrogates, m.x, options.transform)[0];
    out.modes.push_back({box.theta(m.x), out.objective.cost(cost), m.density, m.points});
  }
}

/// Points as proposals with what the surrogates say of them.
std::vector<Proposal> proposals(const SpeSummary& s, const UnitBox& box, const std::string& transform, const std::vector<std::vector<double>>& thetas) {
  std::vector<Proposal> out;
  for (const auto& theta : thetas) out.push_back({median_costs(s.surrogates, box.unit(theta), transform)[0], theta});
  return out;
}

/// The modes, densest first, then the optima, best first.
std::vector<Proposal> ranked_proposals(const SpeSummary& s, const UnitBox& box, const std::string& transform) {
  std::vector<std::vector<double>> modes, optima;
  for (const auto& m : s.modes) modes.push_back(m.theta);
  for (const auto& o : s.optima) optima.push_back(o.theta);
  auto ranked = proposals(s, box, transform, modes);
  auto rest = proposals(s, box, transform, optima);
  std::stable_sort(rest.begin(), rest.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
  ranked.insert(ranked.end(), rest.begin(), rest.end());
  return ranked;
}

void add_run(ScatteredData& data, const Eigen::VectorXd& unit, double value) {
  const Eigen::Index n = data.values.size();
  data.train.push_back(std::size_t(n));
  data.units.conservativeResize(Eigen::NoChange, n + 1), data.values.conservativeResize(n + 1), data.weights.conservativeResize(n + 1);
  data.units.col(n) = unit, data.values[n] = value, data.weights[n] = 1;
}

}  // namespace

SpeSummary run_spe(const Problem& problem, const Archive& archive, const ForwardModel& true_model, const SpeOptions& options, std::uint64_t seed, int threads,
                   const CalibrationProgress& progress) {
  expect(archive.shape.values() == problem.shape.values() && true_model.shape().values() == problem.shape.values() &&
             std::size_t(archive.theta.rows()) == problem.shape.parameters.size(),
         "campaign, true model and problem have one shape");
  SpeSummary out{begin_calibration(problem, objectives().get(options.objective, "spe.objective"))};
  const Clock clock;
  const Bounds bounds = bounds_of(problem.shape);
  const UnitBox box(bounds);
  const RememberingModel model(true_model);
  const std::size_t wanted = std::size_t(options.candidates);
  auto data = discrepancies(problem, archive, out.objective, options, seed, &out.runs_excluded);
  out.n_train = data.train.size(), out.n_validation = data.validation.size(), out.runs_used = out.n_train + out.n_validation;
  out.design = archive.design;

  // 1. Surrogates, their optima, the modes of these; the true misfit there joins the runs, and again.
  std::vector<Proposal> known;  // by their true cost
  std::vector<Proposal> ranked;
  for (int round = 0;; ++round) {
    fit_round(out, data, options, seed, threads, progress);
    search_round(out, box, bounds.low.size(), options, seed, threads, progress);
    ranked = ranked_proposals(out, box, options.transform);
    if (round == options.refinements) break;
    const auto asked = spread_out(ranked, wanted, options.separation, bounds);
    const Clock learning;
    std::vector<double> costs(asked.size());
    std::mutex lock;
    std::size_t finished = 0;
    parallel_for(asked.size(), threads, [&](std::size_t i) {
      const auto p = model.evaluate(asked[i].theta);
      costs[i] = out.objective.cost(p.ok ? out.objective.value(score(problem, p.mean)) : std::numeric_limits<double>::quiet_NaN());
      const std::lock_guard guard(lock);
      if (progress) progress("true-model runs to learn from", ++finished, asked.size());
    });
    out.model_s += learning.seconds();
    for (std::size_t i = 0; i < asked.size(); ++i) {
      if (!std::isfinite(costs[i]) || (options.transform == "log" && costs[i] <= 0)) continue;
      const Proposal now{costs[i], asked[i].theta};
      const bool fresh = std::none_of(known.begin(), known.end(), [&](const auto& k) { return distance(k, now, bounds) < same_place; });
      if (fresh) known.push_back(now), add_run(data, box.unit(now.theta), transformed(options.transform, costs[i])), ++out.runs_added;
    }
  }
  out.warnings.insert(out.warnings.end(), out.fit_warnings.begin(), out.fit_warnings.end());

  // 2. Half of the candidates are this round's; the best of earlier rounds, which cost no run, come next, then more of this round.
  std::stable_sort(known.begin(), known.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
  std::vector<std::vector<double>> earlier;
  for (const auto& k : known) earlier.push_back(k.theta);
  auto candidates = spread_out(ranked, 3 * wanted, options.separation, bounds);
  const auto remembered = proposals(out, box, options.transform, earlier);
  candidates.insert(candidates.begin() + std::ptrdiff_t(std::min(candidates.size(), (wanted + 1) / 2)), remembered.begin(), remembered.end());
  candidates = spread_out(candidates, candidates.size(), 0, bounds);  // each once
  const double at_nominal = median_costs(out.surrogates, box.unit(out.nominal), options.transform)[0];
  out.search_s = clock.seconds() - out.model_s;
  decide_by_true_model(out, problem, model, candidates, wanted, at_nominal, threads, progress);
  out.model_runs = model.runs();
  return out;
}

}  // namespace calomel
