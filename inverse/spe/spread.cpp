#include "inverse/spe/spread.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "inverse/spe/lasso_system.hpp"
#include "inverse/spe/search.hpp"
#include "base/parallel.hpp"
#include "inverse/spe/unit_box.hpp"
#include "inverse/spe/zoom.hpp"

namespace calomel {

namespace {

constexpr std::size_t most_emulated = 150;   ///< best runs that the emulator learns from
constexpr std::size_t some_surrogates = 5;   ///< that a draw fits
constexpr int trials = 3, iterations = 25;   ///< of the search of one of them
constexpr int least_rounds = 2, most_rounds = 5;
constexpr std::size_t fewest_runs = 8;       ///< in the box, for a fit
constexpr std::uint64_t design_stream = 0x5d00'0000;

Eigen::MatrixXd columns_of(const std::vector<std::vector<double>>& points) {
  Eigen::MatrixXd m(Eigen::Index(points.at(0).size()), Eigen::Index(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) m.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXd>(points[i].data(), m.rows());
  return m;
}

/// Some of the surrogates that stand, spread over their list.
std::vector<const SparsePolynomial*> some_of(const std::vector<SparsePolynomial>& surrogates) {
  std::vector<const SparsePolynomial*> standing, some;
  for (const auto& s : surrogates)
    if (s.ok()) standing.push_back(&s);
  const std::size_t n = std::min(some_surrogates, standing.size());
  for (std::size_t i = 0; i < n; ++i) some.push_back(standing[(2 * i + 1) * standing.size() / (2 * n)]);
  return some;
}

/// The last rounds, over again.
class SpeRedraw {
 public:
  SpeRedraw(const SpeSummary& out, const Problem& problem, const KnownRuns& known, const Bounds& box, const SpeOptions& options, std::uint64_t seed)
      : out_(out), problem_(problem), known_(known), options_(options), seed_(seed), bounds_(bounds_of(problem.shape)), box_(box), some_(some_of(out.surrogates)),
        feasibility_(known.feasibility()) {
    for (const auto& p : known.ranked(most_emulated))
      if (thetas_.size() < most_emulated) thetas_.push_back(p.theta);
    Eigen::MatrixXd histories(Eigen::Index(problem.shape.values()), Eigen::Index(thetas_.size()));
    for (std::size_t i = 0; i < thetas_.size(); ++i) histories.col(Eigen::Index(i)) = known.history(thetas_[i]).cast<double>();
    emulator_.emplace(problem.shape.parameters, columns_of(thetas_), histories);
    known_histories_ = smooth(thetas_);
    last_.trials = std::min(options.trials, trials), last_.iterations = std::min(options.iterations, iterations);
  }
  SpeRedraw(const SpeRedraw&) = delete;

  [[nodiscard]] std::vector<double> prediction(const std::vector<double>& theta, const MeshError& mesh) const {
    Eigen::VectorXd h = smooth({theta}).cast<double>();
    if (!mesh.empty()) h += mesh.shift(theta);
    return {h.begin(), h.end()};
  }

  /// What a shift adds to a history at a point, (values); nothing where it is empty.
  using Shift = std::function<Eigen::VectorXd(const std::vector<double>& theta)>;
  /// Empty where no run has a misfit. The runs' errors are those of draw `draw`.
  [[nodiscard]] std::vector<double> answer(const Problem& records, const Shift& shift, const DrawnErrors& errors, std::size_t draw) const {
    std::vector<Proposal> runs;
    std::size_t batch = 0;
    const auto run = [&](const std::vector<std::vector<double>>& points, Eigen::MatrixXf histories) {
      for (std::size_t i = 0; shift && i < points.size(); ++i) histories.col(Eigen::Index(i)) += shift(points[i]).cast<float>();
      const auto costs = out_.objective.costs(records, histories + errors.runs(draw, batch++, points.size()));
      for (std::size_t i = 0; i < points.size(); ++i)
        if (std::isfinite(costs[i]) && (options_.transform != "log" || costs[i] > 0)) runs.push_back({costs[i], points[i]});
    };
    const auto best = [&] { return *std::min_element(runs.begin(), runs.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; }); };
    run(thetas_, known_histories_);
    if (runs.empty()) return {};
    Bounds box = box_;
    for (int round = 0; round < most_rounds; ++round) {
      centre(box, best().theta);
      std::vector<std::vector<double>> points;
      const Eigen::MatrixXd drawn = points_in(box, problem_.shape.parameters, std::size_t(options_.zoom_runs), seed_ + design_stream + 100 * draw + std::uint64_t(round));
      for (Eigen::Index i = 0; i < drawn.cols(); ++i) points.emplace_back(drawn.col(i).begin(), drawn.col(i).end());
      run(points, smooth(points));
      points.clear();
      for (const auto& p : spread_out(search(runs, box, draw), std::size_t(options_.candidates), options_.separation, box)) points.push_back(p.theta);
      if (!points.empty()) run(points, smooth(points));
      if (round + 1 >= least_rounds && !at_edge(bounds_, box, best().theta)) break;
    }
    return best().theta;
  }

 private:
  /// The box about a point, within the bounds.
  void centre(Bounds& box, const std::vector<double>& middle) const {
    for (Eigen::Index k = 0; k < box.low.size(); ++k) {
      const double side = box_.high[k] - box_.low[k];
      box.low[k] = std::clamp(middle[std::size_t(k)] - side / 2, bounds_.low[k], bounds_.high[k] - side), box.high[k] = box.low[k] + side;
    }
  }

  /// Histories without any shift and without the roughness of runs.
  [[nodiscard]] Eigen::MatrixXf smooth(const std::vector<std::vector<double>>& points) const {
    Eigen::MatrixXf h(Eigen::Index(problem_.shape.values()), Eigen::Index(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) h.col(Eigen::Index(i)) = emulator_->history(points[i]).cast<float>();
    return h;
  }

  /// Candidates of some surrogates that are fitted to the runs inside the box.
  [[nodiscard]] std::vector<Proposal> search(const std::vector<Proposal>& runs, const Bounds& box, std::size_t draw) const {
    const UnitBox units(box);
    std::vector<const Proposal*> inside;
    for (const auto& r : runs)
      if (units.contains(r.theta)) inside.push_back(&r);
    if (inside.size() < fewest_runs) return {};
    ScatteredData data;
    data.units.resize(bounds_.low.size(), Eigen::Index(inside.size()));
    data.values.resize(data.units.cols()), data.weights = Eigen::VectorXd::Ones(data.units.cols());
    for (std::size_t i = 0; i < inside.size(); ++i) data.units.col(Eigen::Index(i)) = units.unit(inside[i]->theta), data.values[Eigen::Index(i)] = transformed(options_.transform, inside[i]->cost);
    data.train.resize(inside.size());
    std::iota(data.train.begin(), data.train.end(), std::size_t{0});
    SpeSummary fitted;
    fitted.objective = out_.objective;
    for (const auto* s : some_)
      if (auto again = refit(*s, data, options_, double(inside.size()) / double(out_.rows_fitted), seed_)) fitted.surrogates.push_back(std::move(*again));
    if (fitted.surrogates.empty()) return {};
    search_round(fitted, box, feasibility_, last_, seed_ + draw, 1, {});
    return ranked_proposals(fitted, box, options_.transform);
  }

  const SpeSummary& out_;
  const Problem& problem_;
  const KnownRuns& known_;
  const SpeOptions& options_;
  std::uint64_t seed_;
  Bounds bounds_, box_;
  std::vector<const SparsePolynomial*> some_;
  Feasibility feasibility_;
  SpeOptions last_ = options_;
  std::vector<std::vector<double>> thetas_;
  std::optional<RunEmulator> emulator_;
  Eigen::MatrixXf known_histories_;
};

}  // namespace

RunEmulator::RunEmulator(const std::vector<Parameter>& parameters, const Eigen::MatrixXd& theta, const Eigen::MatrixXd& histories)
    : kriging_(parameters, theta, histories), histories_(histories) {}

void spread_spe(SpeSummary& out, const Problem& problem, const KnownRuns& known, const Bounds& box, const MeshPairs& pairs, const std::function<AnswerErrors()>& errors,
                const SpeOptions& options, std::uint64_t seed, int threads, const CalibrationProgress& progress) {
  const SpeRedraw redraw(out, problem, known, box, options, seed);
  const MeshError& mesh = pairs.mesh();
  const auto draws = std::size_t(options.draws);
  draw_answers(
      out.spread, problem, errors, options.draws, out.theta, redraw.prediction(out.theta, mesh), seed, threads, progress,
      [&](const DrawnErrors& drawn, std::size_t k) {
        const DrawnShift off = drawn.shift(k);
        SpeRedraw::Shift shift;
        if (!mesh.empty()) shift = [&](const std::vector<double>& theta) -> Eigen::VectorXd { return off ? Eigen::VectorXd(mesh.shift(theta) + off->at(theta)) : mesh.shift(theta); };
        return redraw.answer(drawn.records(k).of_runs, shift, drawn, k);
      },
      [&](const DrawnErrors& drawn) {
        const auto left_out = pairs.left_out();
        std::vector<FoundPair> found(left_out.size());
        parallel_for(left_out.size(), threads, [&](std::size_t j) {
          const auto& pair = left_out[j];
          const auto shift = [&](const std::vector<double>& theta) { return pair.mesh.shift(theta); };
          found[j] = {pair.theta, redraw.answer(with_records(problem, pair.records), shift, drawn, draws + j)};
        });
        std::erase_if(found, [](const auto& f) { return f.found.empty(); });
        return found;
      });
}

}  // namespace calomel
