#include "inverse/drawn_errors.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <mutex>

#include "base/linear_algebra.hpp"
#include "base/parallel.hpp"
#include "base/random.hpp"

namespace calomel {

namespace {

constexpr std::uint64_t drawn_stream = 0xd0a50000, batches = 1000, of_shift = 999;

/// A root of a covariance that may be singular; nothing for one that is zero.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& covariance) {
  const double mean = covariance.size() ? covariance.trace() / double(covariance.rows()) : 0;
  if (!(mean > 0)) return {};
  Eigen::MatrixXd c = covariance;
  c.diagonal().array() += 1e-9 * mean;
  const Cholesky factor(c);
  if (!factor.positive_definite()) throw NumericsError("a part of the covariance of the data is not positive definite");
  return factor.lower();
}

Eigen::MatrixXd normals(Eigen::Index rows, Eigen::Index columns, RandomStream& random) {
  Eigen::MatrixXd z(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j)
    for (Eigen::Index i = 0; i < rows; ++i) z(i, j) = random.normal();
  return z;
}

/// Adds to the mean and the band of an observation.
void move(Observation& o, const std::vector<double>& by) {
  for (std::size_t t = 0; t < by.size(); ++t) {
    o.mean[t] += by[t], o.low[t] += by[t], o.high[t] += by[t];  // absent ones stay NaN
    if (o.compared[t]) o.mean_f[t] = float(o.mean[t]);
    if (o.banded[t]) o.low_f[t] = float(o.low[t]), o.high_f[t] = float(o.high[t]);
  }
}

}  // namespace

AnswerErrors answer_errors(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options, const LikelihoodOptions& options,
                           double distance, const MapModels& models, std::span<const double> theta) {
  MapModels shared = models;
  if (!models.mesh.empty()) shared.mesh = models.mesh.with_known_scatter_drawn();
  const auto likelihood = [&](double floor, bool with_surrogate) {
    LikelihoodOptions own = options;
    own.floor = floor;
    return likelihood_at(problem, recordings, recording_options, own, distance, shared, theta, with_surrogate);
  };
  AnswerErrors e{likelihood(0, false), {}, {}, models.mesh};
  e.run = likelihood(options.floor, false).covariance() - e.records.covariance();
  e.surrogate = likelihood(0, true).covariance() - e.records.covariance();
  return e;
}

DrawnErrors::DrawnErrors(const Problem& problem, const AnswerErrors& errors, std::span<const double> theta, std::span<const double> prediction, std::uint64_t seed)
    : problem_(problem), errors_(errors), seed_(seed), residual_(errors.records.without_shift().residual(theta, prediction)),
      records_root_(root_of(errors.records.covariance())), run_root_(root_of(errors.run)), surrogate_root_(root_of(errors.surrogate)) {
  const Eigen::VectorXd within = errors.records.grid().lift(residual_);
  const std::size_t times = problem.shape.times.size();
  for (const auto& o : problem.observations) {
    const std::size_t at = problem.shape.at(o.condition, o.sensor, 0);
    const auto predicted = on_record_times(problem, prediction.subspan(at, times)), lifted = on_record_times(problem, {within.data() + at, times});
    above_.push_back(o.mean);
    for (std::size_t t = 0; t < predicted.size(); ++t) above_.back()[t] -= predicted[t] + lifted[t];
  }
}

DrawnErrors::Records DrawnErrors::records(std::size_t draw) const {
  RandomStream random(seed_, drawn_stream + draw * batches);
  Eigen::VectorXd drawn = records_root_ * normals(residual_.size(), 1, random);
  // A scale that was learnt from few repeats: Student's t is a Gaussian over a random scale.
  const double nu = errors_.records.errors().freedom(), u = std::min(std::max(random.uniform(), 1e-9), 1 - 1e-9);
  if (std::isfinite(nu)) drawn *= std::sqrt(nu / boost::math::quantile(boost::math::chi_squared(nu), u));
  Records r;
  r.moved = drawn - residual_;
  r.moved_surrogate = r.moved;
  if (surrogate_root_.size()) r.moved_surrogate -= surrogate_root_ * normals(residual_.size(), 1, random);
  std::vector<bool> flipped;
  for (std::size_t i = 0; i < above_.size(); ++i) flipped.push_back(random.below(2) == 1);
  r.of_runs = with_records_moved(r.moved, flipped);
  r.of_surrogate = with_records_moved(r.moved_surrogate, flipped);
  return r;
}

Eigen::MatrixXf DrawnErrors::runs(std::size_t draw, std::size_t batch, std::size_t n) const {
  if (run_root_.size() == 0) return Eigen::MatrixXf::Zero(Eigen::Index(problem_.shape.values()), Eigen::Index(n));
  RandomStream random(seed_, drawn_stream + draw * batches + 1 + batch);
  return errors_.records.grid().lift(run_root_ * normals(residual_.size(), Eigen::Index(n), random)).cast<float>();
}

DrawnShift DrawnErrors::shift(std::size_t draw) const {
  if (errors_.mesh.empty()) return std::nullopt;
  RandomStream random(seed_, drawn_stream + draw * batches + of_shift);
  return errors_.mesh.draw(random);
}

Prediction DrawnModel::evaluate(std::span<const double> theta) const {
  Prediction p = model_.evaluate(theta);
  if (p.ok && drawn_) Eigen::Map<Eigen::VectorXd>(p.mean.data(), Eigen::Index(p.mean.size())) += drawn_->at(theta);
  return p;
}

Eigen::MatrixXf DrawnModel::means(const Eigen::MatrixXd& thetas, int threads) const {
  Eigen::MatrixXf y = model_.means(thetas, threads);
  if (drawn_)
    for (Eigen::Index i = 0; i < y.cols(); ++i) y.col(i) += drawn_->at({thetas.col(i).data(), std::size_t(thetas.rows())}).cast<float>();
  return y;
}

Problem DrawnErrors::with_records_moved(const Eigen::VectorXd& coarse, const std::vector<bool>& flipped) const {
  const Eigen::VectorXd history = errors_.records.grid().lift(coarse);
  Problem p = problem_;
  const std::size_t times = p.shape.times.size();
  for (std::size_t i = 0; i < p.observations.size(); ++i) {
    auto& o = p.observations[i];
    auto by = on_record_times(p, {history.data() + p.shape.at(o.condition, o.sensor, 0), times});
    for (std::size_t t = 0; t < by.size(); ++t)
      if (flipped[i]) by[t] -= 2 * above_[i][t];
    move(o, by);
  }
  return p;
}

Problem with_records(const Problem& problem, const Eigen::VectorXd& history) {
  Problem p = problem;
  for (auto& o : p.observations) {
    auto by = on_record_times(p, {history.data() + p.shape.at(o.condition, o.sensor, 0), p.shape.times.size()});
    for (std::size_t t = 0; t < by.size(); ++t) by[t] -= o.mean[t];
    move(o, by);
  }
  return p;
}

void draw_answers(AnswerSpread& spread, const Problem& problem, const std::function<AnswerErrors()>& errors, int draws, const std::vector<double>& theta,
                  std::span<const double> prediction, std::uint64_t seed, int threads, const CalibrationProgress& progress,
                  const std::function<std::vector<double>(const DrawnErrors& errors, std::size_t draw)>& answer,
                  const std::function<std::vector<FoundPair>(const DrawnErrors& errors)>& pairs) {
  const Clock clock;
  spread.wanted = draws;
  try {
    const AnswerErrors e = errors();
    spread.shares = e.records.shares();
    const DrawnErrors drawn(problem, e, theta, prediction, seed);
    std::vector<std::vector<double>> answers(static_cast<std::size_t>(draws));
    std::mutex lock;
    std::size_t done = 0;
    parallel_for(answers.size(), threads, [&](std::size_t k) {
      answers[k] = answer(drawn, k);
      const std::lock_guard guard(lock);
      if (progress) progress("drawn records", ++done, answers.size());
    });
    std::erase_if(answers, [](const auto& a) { return a.empty(); });
    spread.answers.resize(Eigen::Index(theta.size()), Eigen::Index(answers.size()));
    for (std::size_t i = 0; i < answers.size(); ++i)
      spread.answers.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXd>(answers[i].data(), spread.answers.rows());
    summarise(spread, problem.shape.parameters, theta);
    if (pairs && spread.told()) widen(spread, problem.shape.parameters, theta, pairs(drawn));
  } catch (const InputError& error) {
    spread.sentence = std::string("no standard deviations: ") + error.what();
  } catch (const NumericsError& error) {
    spread.sentence = std::string("no standard deviations: ") + error.what();
  }
  spread.seconds = clock.seconds();
}

}  // namespace calomel
