#include "inverse/map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/nan.hpp"
#include "inverse/finer_scores.hpp"
#include "inverse/map_discrepancy.hpp"
#include "inverse/map_judgement.hpp"
#include "inverse/map_refine.hpp"
#include "inverse/polish.hpp"

namespace calomel {

namespace {

/// One calibration, step by step; what a step leaves to the next ones are members.
class MapRun {
 public:
  MapRun(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options, const MapModels& models, const MapOptions& options,
         std::uint64_t seed, int threads, const CalibrationProgress& progress)
      : problem_(problem), models_(models), options_(options), seed_(seed), threads_(threads), progress_(progress), physical_(options.product == "physical"),
        space_(physical_ ? with_handbook_priors(problem.shape.parameters) : problem.shape.parameters), current_(models),
        search_(problem, recordings, recording_options, current_, options, space_, threads) {
    out_.objective = {"log_posterior", true, {}};
    out_.product = options.product;
    out_.nominal = nominal(problem.shape);
    out_.warnings = problem.warnings;
  }

  MapSummary run() {
    find_optima();
    if (!optima_.empty()) refine();
    choose_likelihood();
    decide();
    if (out_.best.objective_model) {
      settle_on_model();
      judge();
    }
    show_on_finer_mesh();
    return std::move(out_);
  }

 private:
  void find_optima();
  void refine();
  void choose_likelihood();
  void decide();
  void settle_on_model();
  void take_polished(const Polished& p);
  void judge();
  void show_on_finer_mesh();
  [[nodiscard]] double curvature_seen() const;
  /// What the mesh's error is of the likelihood's covariance at the answer, (values, values).
  [[nodiscard]] Eigen::MatrixXd mesh_covariance();

  const Problem& problem_;
  const MapModels& models_;
  const MapOptions& options_;
  std::uint64_t seed_;
  int threads_;
  const CalibrationProgress& progress_;
  bool physical_;
  Clock clock_;
  MapSummary out_;
  SearchSpace space_;
  MapModels current_;  ///< as it is refined
  MapSearch search_;
  Eigen::MatrixXd design_;
  std::optional<Likelihood> likelihood_;  ///< that of the search
  std::vector<Optimum> optima_;
  FinerScores finer_{problem_, current_.mesh};
  std::optional<Likelihood> of_model_;           ///< that of the true model, where it has the last word
  const Likelihood* final_likelihood_ = nullptr;
  std::optional<PosteriorMode> on_search_;       ///< the final likelihood on the search's model
  PosteriorPoint point_;                         ///< the answer
  Eigen::VectorXd x_;                            ///< and its coordinates
  std::optional<Linearisation> at_;              ///< the last secants
  Eigen::MatrixXd covariance_;                   ///< of x
  std::vector<std::pair<Eigen::VectorXd, double>> known_;  ///< points that the model was run at, and the log posterior there
};

/// The optima, by the likelihood as it is at the nominal point, then as it is at the best explanation.
void MapRun::find_optima() {
  design_ = search_.design(seed_);
  likelihood_.emplace(search_.likelihood(out_.nominal, true));
  optima_ = search_.global(likelihood_, design_, {}, progress_);
}

/// Runs of the true model, and of the finer mesh, where they tell most, until the optimum stays; the unknowns and the discrepancy at it.
void MapRun::refine() {
  if (search_.on_surrogate() && models_.add_runs) optima_ = refine_search(out_, search_, current_, models_, design_, std::move(optima_), likelihood_, seed_, progress_);
  if (models_.unknown_directions) {
    current_.unknowns = models_.unknown_directions(space_.theta(optima_[0].x));
    likelihood_.emplace(search_.likelihood(space_.theta(optima_[0].x), true));
    std::vector<Eigen::VectorXd> starts;
    for (const auto& o : optima_) starts.push_back(o.x);
    const std::vector<Eigen::VectorXd> widths(starts.size(), 0.5 * optima_[0].covariance.diagonal().cwiseSqrt());
    if (auto again = search_.optima(*likelihood_, starts, widths, progress_); !again.empty()) optima_ = std::move(again);
  }
  if (physical_) likelihood_.emplace(choose_discrepancy(out_, search_, problem_, *likelihood_, models_, options_, optima_));
  if (search_.on_surrogate()) out_.gradient = exact_slope(search_.model(), *likelihood_, space_, optima_[0]);
}

/// The final likelihood, that of the model which has the last word.
void MapRun::choose_likelihood() {
  final_likelihood_ = &*likelihood_;
  if (options_.polish && search_.on_surrogate() && !optima_.empty()) {
    of_model_.emplace(search_.likelihood(space_.theta(optima_[0].x), false));
    if (physical_) of_model_.emplace(with_discrepancy(*of_model_, problem_, models_, options_.discrepancy, out_.discrepancy_scale));
    final_likelihood_ = &*of_model_;
  }
  on_search_.emplace(search_.model(), *final_likelihood_, space_, threads_);
}

/// The candidates, and what the true model says of them.
void MapRun::decide() {
  const Bounds bounds = bounds_of(problem_.shape);
  std::vector<Proposal> ranked = proposals(optima_, space_);
  for (auto& p : ranked) p.cost = -on_search_->at(space_.from(p.theta)).log_posterior;
  ranked = well_separated(std::move(ranked), std::size_t(3 * options_.candidates), options_.separation, bounds);
  if (!search_.on_surrogate())
    for (auto& p : ranked) p.cost = nan;
  out_.search_s = clock_.seconds();
  const double at_nominal = search_.on_surrogate() ? -on_search_->at(space_.from(out_.nominal)).log_posterior : nan;
  decide_by_true_model(out_, problem_, models_.true_model, ranked, std::size_t(options_.candidates), at_nominal, threads_, progress_,
                       [&](std::span<const double> theta, std::span<const double> values, const Score&) {
                         finer_.see(theta, values);
                         return final_likelihood_->log_likelihood(theta, values) + space_.log_prior(theta);
                       });
  out_.evaluations = search_.evaluations() + on_search_->evaluations();
}

/// The true model itself: polishing, and secants for the covariance.
void MapRun::settle_on_model() {
  const Clock model_clock;
  const PosteriorMode on_model(models_.true_model, *final_likelihood_, space_, threads_);
  point_ = {out_.theta, out_.calibrated, *out_.best.objective_model};
  x_ = space_.from(point_.theta);
  const Eigen::VectorXd box = space_.high() - space_.low();
  covariance_ = optima_.empty() ? Eigen::MatrixXd((0.01 * box.array().square()).matrix().asDiagonal()) : optima_[0].covariance;
  const Eigen::VectorXd widths = space_.secant_widths(x_, search_.secant() * covariance_.diagonal().cwiseSqrt(), options_.secant);
  for (const auto& c : out_.candidates)
    if (c.objective_model) known_.emplace_back(space_.from(c.theta), *c.objective_model);
  if (of_model_)
    take_polished(polish(on_model, space_, point_, covariance_, widths, options_.polish_runs,
                         [&](int done) { if (progress_) progress_("polishing runs", std::size_t(done), std::size_t(options_.polish_runs)); }));
  if (!at_) at_ = (of_model_ || !search_.on_surrogate() ? on_model : *on_search_).linearise(x_, widths.asDiagonal());
  out_.model_runs += on_model.evaluations();
  out_.model_s += model_clock.seconds();
}

void MapRun::take_polished(const Polished& p) {
  out_.polish_steps = p.steps;
  at_ = p.at;
  for (const auto& t : p.tried) known_.emplace_back(space_.from(t.theta), t.log_posterior);
  if (p.steps == 0) return;
  point_ = p.point, x_ = p.x;
  Candidate c{.theta = point_.theta, .objective_surrogate = on_search_->at(x_).log_posterior, .objective_model = point_.log_posterior};
  c.score = score(problem_, point_.history), finer_.see(point_.theta, point_.history);
  out_.best = c, out_.theta = point_.theta, out_.calibrated = point_.history;
  out_.candidates.insert(out_.candidates.begin(), std::move(c));
}

double MapRun::curvature_seen() const {
  Eigen::MatrixXd points(space_.size(), Eigen::Index(known_.size()));
  Eigen::VectorXd seen(points.cols());
  for (std::size_t i = 0; i < known_.size(); ++i) points.col(Eigen::Index(i)) = known_[i].first, seen[Eigen::Index(i)] = known_[i].second;
  return seen_curvature(points, seen, x_, point_.log_posterior, covariance_);
}

Eigen::MatrixXd MapRun::mesh_covariance() {
  const Eigen::MatrixXd with = search_.likelihood(point_.theta, false).covariance();
  const MeshError mesh = std::exchange(current_.mesh, {});
  const double relative = std::exchange(current_.mesh_relative, 0);
  const Eigen::MatrixXd without = search_.likelihood(point_.theta, false).covariance();
  current_.mesh = mesh, current_.mesh_relative = relative;
  return with - without;
}

/// Scores and histories as the calibrations that correct for the mesh have them.
void MapRun::show_on_finer_mesh() {
  finer_.put_into(out_);
}

/// What the answer is worth.
void MapRun::judge() {
  judge_fit(out_, *final_likelihood_, final_likelihood_->residual(point_.theta, point_.history), std::size_t(space_.size()), options_.widen);
  bool limited = true;
  Eigen::MatrixXd sharp = covariance_;
  Eigen::MatrixXd data = Eigen::MatrixXd::Zero(space_.size(), space_.size());
  if (at_) {
    const PosteriorMode on_model(models_.true_model, *final_likelihood_, space_, threads_);
    data = final_likelihood_->errors().weight(at_->chi2) * at_->jacobian.transpose() * at_->jacobian;
    covariance_ = covariance_of(on_model.curvature(*at_), space_, x_, limited);
    sharp = covariance_;
  } else {
    out_.warnings.push_back("the model fails beside the optimum: the covariance is the search's");
  }
  if (at_ && std::size_t(at_->jacobian.rows()) == out_.values) {
    std::vector<LeftOut> left_out{gauge_gains(problem_, point_.history)};
    if (models_.left_out)
      for (auto& l : models_.left_out(point_.theta)) left_out.push_back(std::move(l));
    take_screening(out_, screen(*final_likelihood_, final_likelihood_->residual(point_.theta, point_.history), at_->jacobian, left_out, out_.refinement.validation.residuals));
  }
  out_.log_likelihood = final_likelihood_->log_likelihood(point_.theta, point_.history);
  out_.log_prior = log_prior(space_.priors(), point_.theta);
  out_.log_evidence_laplace = search_.log_evidence({x_, point_.log_posterior, covariance_});
  if (at_) {
    for (Eigen::Index i = 0; i < at_->points.cols(); ++i) known_.emplace_back(at_->points.col(i), at_->log_posteriors[i]);
    out_.curvature_seen = curvature_seen();
  }
  const Eigen::MatrixXd between = spread_of_rivals(out_, space_, x_, point_.log_posterior);
  const double flatter = std::max(out_.refinement.validation.inflation, 1 / std::clamp(out_.curvature_seen, 0.01, 1.0));
  covariance_ *= out_.widening * flatter * (1 + std::max(0.0, out_.scale_spread));
  const Eigen::MatrixXd moves = spread_of_rounds(out_.refinement, space_, x_);
  out_.refinement.moves_share = moves.diagonal().cwiseQuotient((covariance_ + between + moves).diagonal());
  covariance_ += between + moves;
  const Eigen::VectorXd by_x = space_.slope(x_);
  out_.covariance = by_x.asDiagonal() * covariance_ * by_x.asDiagonal();
  const Eigen::MatrixXd data_own = by_x.cwiseInverse().asDiagonal() * data * by_x.cwiseInverse().asDiagonal();
  out_.identification =
      identify(problem_.shape.parameters, point_.theta, data_own, out_.covariance, space_.prior_sd(x_).cwiseProduct(by_x), out_.widening * flatter);
  if (!current_.mesh.empty() && at_)
    judge_mesh(out_, problem_, current_.mesh, *final_likelihood_, {at_->jacobian, sharp, covariance_, mesh_covariance(), point_.history});
  out_.shares = final_likelihood_->shares();
  out_.energy_sd = final_likelihood_->noise().energy_sd, out_.split_half = final_likelihood_->noise().split_half;
  for (const auto& s : final_likelihood_->noise().series) out_.noise_time.push_back(s.time);
  out_.message = fmt::format("log posterior {:.6g} in the true model; {}", point_.log_posterior, out_.adequacy);
  warn(out_, space_, x_, covariance_, limited);
}

}  // namespace

MapSummary run_map(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options, const MapModels& models,
                   const MapOptions& options, std::uint64_t seed, int threads, const CalibrationProgress& progress) {
  return MapRun(problem, recordings, recording_options, models, options, seed, threads, progress).run();
}

}  // namespace calomel
