#include "inverse/spe/spe.hpp"

#include <algorithm>
#include <cmath>

#include "forward/campaign/campaign.hpp"
#include "inverse/calibration/remembering_model.hpp"
#include "inverse/spe/known_runs.hpp"
#include "inverse/spe/search.hpp"
#include "inverse/spe/zoom.hpp"

namespace calomel {

namespace {

constexpr std::uint64_t zoom_stream = 0x5a00;

/// The state of a calibration between its rounds.
class SpeRounds {
 public:
  SpeRounds(SpeSummary& out, const Problem& problem, const Archive& archive, const SpeOptions& options, const RememberingModel& memory,
            const MeshCorrection* correction, std::uint64_t seed, int threads, const CalibrationProgress& progress)
      : out_(out),
        problem_(problem),
        options_(options),
        memory_(memory),
        threads_(threads),
        progress_(progress),
        known_(problem, archive, out.objective, options, seed),
        seed_(seed),
        bounds_(bounds_of(problem.shape)),
        box_(bounds_) {
    out.runs_excluded = known_.excluded();
    out.design = archive.design;
    known_.price(correction);
    const auto data = known_.data(bounds_, true);
    out_.n_train = data.train.size();
    out_.n_validation = data.validation.size();
    out_.runs_used = out_.n_train + out_.n_validation;
  }
  [[nodiscard]] const KnownRuns& known() const { return known_; }
  [[nodiscard]] const Bounds& box() const { return box_; }
  /// Rounds after the first.
  [[nodiscard]] int rounds() const { return options_.zoom + options_.refinements; }

  /// Fits and searches; ranked proposals of this round.
  std::vector<Proposal> search() {
    fit_round(out_, known_.data(box_, whole_), options_, seed_, threads_, progress_);
    search_round(out_, box_, known_.feasibility(), options_, seed_, threads_, progress_);
    return ranked_proposals(out_, box_, options_.transform);
  }

  /// The true model at the best of a round.
  void run(const std::vector<Proposal>& ranked) {
    std::vector<std::vector<double>> points;
    for (const auto& p : spread_out(ranked, std::size_t(options_.candidates), options_.separation, box_))
      if (!known_.knows(p.theta)) points.push_back(p.theta);
    learn(points);
  }

  /// A smaller box about what is known, or, after the rounds of zoom, one that goes where the best lies at the edge; and new runs in it where they are
  /// likely to come through.
  void zoom(int round) {
    const bool smaller = round < options_.zoom;
    const auto best = known_.ranked(campaign).front().theta;
    if (options_.zoom == 0 || (!smaller && !at_edge(bounds_, box_, best))) return;
    box_ = next_box(bounds_, box_, best, smaller);
    whole_ = false;
    const auto feasibility = known_.feasibility();
    const Eigen::MatrixXd drawn = points_in(box_, problem_.shape.parameters, std::size_t(options_.zoom_runs), seed_ + zoom_stream + std::uint64_t(round));
    std::vector<std::vector<double>> points;
    for (Eigen::Index i = 0; i < drawn.cols(); ++i) {
      std::vector<double> theta(drawn.col(i).begin(), drawn.col(i).end());
      if (feasibility.feasible(theta)) points.push_back(std::move(theta));
    }
    SpeZoom z{.low = {box_.low.begin(), box_.low.end()}, .high = {box_.high.begin(), box_.high.end()}};
    const auto every = std::size_t(std::lround(1 / options_.validation_fraction));
    z.made = learn(points, std::max<std::size_t>(2, std::min(every, points.size())));  // at least one of them is held out
    z.runs = std::size_t(known_.data(box_, false).values.size());
    z.best = out_.objective.cost(known_.ranked(campaign).front().cost);
    out_.zooms.push_back(std::move(z));
  }

  /// Runs those of the first `n` points that are not known yet; they join nothing.
  void run_unknown(std::span<const Proposal> points, std::size_t n) {
    std::vector<std::vector<double>> unknown;
    for (const auto& p : points.first(std::min(n, points.size())))
      if (!memory_.knows(p.theta)) unknown.push_back(p.theta);
    (void)run(unknown);
  }

 private:
  static constexpr std::size_t campaign = 1'000'000;  ///< all runs of it

  std::vector<Prediction> run(const std::vector<std::vector<double>>& points) {
    if (points.empty()) return {};
    Eigen::MatrixXd thetas(bounds_.low.size(), Eigen::Index(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) thetas.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXd>(points[i].data(), thetas.rows());
    const Clock clock;
    auto runs = memory_.predictions(thetas, threads_, [&](std::size_t done, std::size_t total) {
      if (progress_) progress_("runs of the true model", done, total);
    });
    out_.model_s += clock.seconds();
    return runs;
  }

  /// Runs points, which join the known ones, each `every`-th held out (0: none); how many did.
  std::size_t learn(const std::vector<std::vector<double>>& points, std::size_t every = 0) {
    const auto runs = run(points);
    std::size_t joined = 0;
    for (std::size_t i = 0; i < runs.size(); ++i) joined += known_.add(points[i], runs[i], every > 0 && i % every == every - 1, box_);
    return joined;
  }

  SpeSummary& out_;
  const Problem& problem_;
  const SpeOptions& options_;
  const RememberingModel& memory_;
  int threads_;
  const CalibrationProgress& progress_;
  KnownRuns known_;
  std::uint64_t seed_;
  Bounds bounds_, box_;
  bool whole_ = true;
};

}  // namespace

SpeSummary run_spe(const Problem& problem, const Archive& archive, const ForwardModel& true_model, const SpeOptions& options, std::uint64_t seed, int threads,
                   const CalibrationProgress& progress, const MeshCorrection* correction) {
  expect(archive.shape.values() == problem.shape.values() && true_model.shape().values() == problem.shape.values() &&
             std::size_t(archive.theta.rows()) == problem.shape.parameters.size(),
         "campaign, true model and problem have one shape");
  SpeSummary out{begin_calibration(problem, objectives().get(options.objective, "spe.objective"))};
  const Clock clock;
  const MeshCorrection none, &mesh = correction ? *correction : none;
  const RememberingModel model(true_model);
  SpeRounds rounds(out, problem, archive, options, model, &mesh, seed, threads, progress);

  // 1. Surrogates, their optima, the modes of these; the true misfit there joins the runs, the box shrinks, and again.
  std::vector<Proposal> ranked;
  for (int round = 0;; ++round) {
    ranked = rounds.search();
    if (round == rounds.rounds()) break;
    rounds.run(ranked);
    rounds.zoom(round);
  }
  out.runs_added = rounds.known().added();

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
  rounds.run_unknown(candidates, wanted);
  if (!mesh.empty()) out.mesh.without = rounds.known().best_without_correction();
  out.search_s = clock.seconds() - out.model_s;
  decide_by_true_model(out, problem, CorrectedModel(model, mesh), candidates, wanted, at_nominal, threads, progress);
  out.model_runs = model.runs();
  report_correction(out, problem, mesh);
  return out;
}

}  // namespace calomel
