#include "inverse/spe.hpp"

#include <algorithm>
#include <cmath>

#include "inverse/spe/known_runs.hpp"
#include "inverse/spe/search.hpp"
#include "inverse/spe/spread.hpp"
#include "inverse/spe/zoom.hpp"

namespace calomel {

namespace {

constexpr std::uint64_t zoom_stream = 0x5a00;

/// The state of a calibration between its rounds.
class SpeRounds {
 public:
  SpeRounds(SpeSummary& out, const Problem& problem, const Archive& archive, const SpeOptions& options, MeshPairs& pairs, std::uint64_t seed)
      : out_(out), problem_(problem), options_(options), pairs_(pairs), known_(problem, archive, out.objective, options, seed), seed_(seed),
        bounds_(bounds_of(problem.shape)), box_(bounds_) {
    out.runs_excluded = known_.excluded(), out.design = archive.design;
  }
  [[nodiscard]] KnownRuns& known() { return known_; }
  [[nodiscard]] const Bounds& box() const { return box_; }

  /// Counts the runs of the first fits. Pairs before them only where no box shrinks: at the nominal point and good runs of the campaign; half of all, or all where no later round can
  /// learn.
  void begin() {
    known_.price({});
    const auto data = known_.data(bounds_, true);
    out_.n_train = data.train.size(), out_.n_validation = data.validation.size(), out_.runs_used = out_.n_train + out_.n_validation;
    all_ = std::size_t(pairs_.left());
    if (all_ == 0 || options_.zoom > 0) return;
    first_ = rounds() > 0 ? std::min(all_, std::max<std::size_t>(3, (all_ + 1) / 2)) : all_;
    learn(pairs_.add(first_pair_points({out_.nominal}, known_.ranked(campaign), first_, bounds_), first_));
  }

  /// Fits and searches; ranked proposals of this round.
  std::vector<Proposal> search(int threads, const CalibrationProgress& progress) {
    known_.price(pairs_.mesh());
    fit_round(out_, known_.data(box_, whole_), options_, seed_, threads, progress);
    search_round(out_, box_, known_.feasibility(), options_, seed_, threads, progress);
    return ranked_proposals(out_, box_, options_.transform);
  }

  /// The true model at the best of a round; where no box shrinks, those that the pairs' share of this round allows on the finer mesh too.
  void ask(const std::vector<Proposal>& ranked, int round) {
    std::vector<std::vector<double>> points;
    for (const auto& p : spread_out(ranked, std::size_t(options_.candidates), options_.separation, box_))
      if (!known_.knows(p.theta)) points.push_back(p.theta);
    const std::size_t by_now = all_ == 0 || options_.zoom > 0 ? 0 : first_ + (all_ - first_) * std::size_t(round + 1) / std::size_t(rounds());
    const auto asked = std::size_t(pairs_.asked());
    const Proposal* before = out_.mesh.rounds.empty() ? nullptr : &best_;
    if (!points.empty()) learn(pairs_.add(points, by_now > asked ? by_now - asked : 0));
    known_.price(pairs_.mesh());
    const Proposal best = known_.ranked(campaign).front();
    if (all_ > 0) {
      const double moved = before ? distance(best, *before, bounds_) : std::numeric_limits<double>::quiet_NaN();
      out_.mesh.rounds.push_back({pairs_.asked(), best.theta, moved});
      out_.mesh.settled = moved < 0.01;
    }
    best_ = best;
  }

  /// A smaller box about what is known, or, after the rounds of zoom, one that goes where the best lies at the edge; and new runs in it where they are
  /// likely to come through.
  void zoom(int round) {
    const bool smaller = round < options_.zoom;
    if (options_.zoom == 0 || (!smaller && !at_edge(bounds_, box_, best_.theta))) return;
    box_ = next_box(bounds_, box_, best_.theta, smaller), whole_ = false;
    const auto feasibility = known_.feasibility();
    const Eigen::MatrixXd drawn = points_in(box_, problem_.shape.parameters, std::size_t(options_.zoom_runs), seed_ + zoom_stream + std::uint64_t(round));
    std::vector<std::vector<double>> points;
    for (Eigen::Index i = 0; i < drawn.cols(); ++i) {
      std::vector<double> theta(drawn.col(i).begin(), drawn.col(i).end());
      if (feasibility.feasible(theta)) points.push_back(std::move(theta));
    }
    const auto every = std::size_t(std::lround(1 / options_.validation_fraction));
    SpeZoom z{.low = {box_.low.begin(), box_.low.end()}, .high = {box_.high.begin(), box_.high.end()}};
    const std::size_t paired = pairs_first(points, round);
    if (!points.empty()) z.made = learn(pairs_.add(points, paired), every);
    known_.price(pairs_.mesh());
    z.runs = std::size_t(known_.data(box_, false).values.size());
    z.best = out_.objective.cost(known_.ranked(campaign).front().cost);
    out_.zooms.push_back(std::move(z));
  }
  /// Rounds after the first.
  [[nodiscard]] int rounds() const { return options_.zoom + options_.refinements; }

  static constexpr std::size_t campaign = 1'000'000;  ///< all runs of it

 private:
  /// Puts those points first that are to be run on the finer mesh too, and how many: from the second box on, an equal share of the pairs in each round of zoom (in the first where it is the only one), at the best run and
  /// at good ones far apart. Pairs that stand about the optimum tell of the mesh there; where they gather at one place, that place is the only one whose misfit knows of the mesh, and wins.
  std::size_t pairs_first(std::vector<std::vector<double>>& points, int round) const {
    if (all_ == 0 || round >= options_.zoom) return 0;
    const std::size_t by_now = options_.zoom == 1 ? all_ : all_ * std::size_t(round) / std::size_t(options_.zoom - 1);
    const auto& paired = pairs_.places();
    if (by_now <= paired.size()) return 0;
    auto given = paired;
    given.push_back(best_.theta);
    auto first = first_pair_points(given, known_.ranked(campaign), by_now, box_);
    std::erase_if(first, [&](const auto& p) { return std::find(paired.begin(), paired.end(), p) != paired.end(); });
    const std::size_t wanted = std::min(first.size(), by_now - paired.size());
    points.insert(points.begin(), first.begin(), first.end());
    return wanted;
  }

  /// Runs join the known ones, each `every`-th held out (0: none); how many did.
  std::size_t learn(const std::vector<AddedRun>& runs, std::size_t every = 0) {
    std::size_t joined = 0;
    for (std::size_t i = 0; i < runs.size(); ++i) joined += known_.add(runs[i], every > 0 && i % every == every - 1, box_);
    return joined;
  }

  SpeSummary& out_;
  const Problem& problem_;
  const SpeOptions& options_;
  MeshPairs& pairs_;
  KnownRuns known_;
  std::uint64_t seed_;
  Bounds bounds_, box_;
  bool whole_ = true;
  std::size_t first_ = 0, all_ = 0;  ///< pairs
  Proposal best_;
};

}  // namespace

SpeSummary run_spe(const Problem& problem, const Archive& archive, const ForwardModel& true_model, const SpeOptions& options, std::uint64_t seed, int threads,
                   const CalibrationProgress& progress, const RunSource* source, const ErrorsAt& errors) {
  expect(archive.shape.values() == problem.shape.values() && true_model.shape().values() == problem.shape.values() &&
             std::size_t(archive.theta.rows()) == problem.shape.parameters.size(),
         "campaign, true model and problem have one shape");
  SpeSummary out{begin_calibration(problem, objectives().get(options.objective, "spe.objective"))};
  const Clock clock;
  const RunSource own = without_journal(true_model, nullptr, threads);
  const RememberingModel model(true_model);
  MeshPairs pairs(problem.shape, source && source->run ? *source : own, model, options.mesh_pairs, options.mesh_beyond);
  SpeRounds rounds(out, problem, archive, options, pairs, seed);

  // 1. Surrogates, their optima, the modes of these; the true misfit there joins the runs, the box shrinks, and again.
  rounds.begin();
  std::vector<Proposal> ranked;
  for (int round = 0;; ++round) {
    ranked = rounds.search(threads, progress);
    if (round == rounds.rounds()) break;
    rounds.ask(ranked, round);
    rounds.zoom(round);
  }
  out.runs_added = rounds.known().added();
  out.warnings.insert(out.warnings.end(), out.fit_warnings.begin(), out.fit_warnings.end());
  if (out.optima.empty()) out.warnings.push_back("runs are likely to fail at every optimum of the last surrogates: candidates are the best runs that were made");

  // 2. Half of the candidates are this round's; the best of the runs that were made before, which cost none, come next, then more of this round.
  const Bounds& box = rounds.box();
  const std::size_t half = std::size_t(options.candidates + 1) / 2;
  std::vector<std::vector<double>> earlier;
  for (const auto& k : rounds.known().ranked(std::size_t(options.known_candidates))) earlier.push_back(k.theta);
  auto candidates = spread_out(ranked, 3 * std::size_t(options.candidates), options.separation, box);
  const auto remembered = proposals(out, box, options.transform, earlier);
  candidates.insert(candidates.begin() + std::ptrdiff_t(std::min(candidates.size(), half)), remembered.begin(), remembered.end());
  candidates = spread_out(candidates, candidates.size(), 0, box);  // each once
  const std::size_t wanted = std::max(std::size_t(options.candidates), half + std::min<std::size_t>(1, remembered.size()));
  for (const auto& theta : earlier) {
    const Eigen::VectorXf& history = rounds.known().history(theta);
    model.learn(theta, {.mean = {history.begin(), history.end()}}, false);
  }
  const double at_nominal = proposals(out, box, options.transform, {out.nominal})[0].cost;
  pairs.run_unknown(candidates, wanted);
  out.mesh.without = rounds.known().best_without_shift();
  out.model_s = pairs.seconds(), out.search_s = clock.seconds() - out.model_s;
  decide_by_true_model(out, problem, ShiftedModel(model, pairs.mesh()), candidates, wanted, at_nominal, threads, progress);
  out.model_runs = model.runs();
  pairs.describe(out, problem);
  if (errors && options.draws > 0 && out.trusted())
    spread_spe(out, problem, rounds.known(), box, pairs, [&] { return errors(out.theta, pairs.mesh(), {}); }, options, seed, threads, progress);
  return out;
}

}  // namespace calomel
