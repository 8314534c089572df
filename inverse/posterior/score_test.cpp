#include "inverse/posterior/score_test.hpp"

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>

#include "base/json.hpp"
#include "base/linear_algebra.hpp"
#include "base/not_finite.hpp"

namespace calomel {

namespace {

constexpr double nothing = 1e-4;  ///< of a direction's own length, or of the greatest singular value: what is left of it is rounding

/// Orthonormal columns that span those of `m`, (rows, rank): its left singular vectors by the eigenvectors of m^T m. Of columns down to `nothing` of the
/// greatest singular value they are orthonormal to 1e-16 / nothing^2; a second pass takes that to rounding.
Eigen::MatrixXd span_of(const Eigen::MatrixXd& m) {
  Eigen::MatrixXd span = m;
  for (int pass = 0; pass < 2 && span.cols() > 0; ++pass) {
    const SymmetricEigen eigen = symmetric_eigen(span.transpose() * span);  // ascending
    const Eigen::VectorXd squares = eigen.values.reverse();
    Eigen::Index rank = 0;
    while (rank < squares.size() && squares[rank] > 0 && squares[rank] > nothing * nothing * squares[0]) ++rank;
    const Eigen::MatrixXd vectors = eigen.vectors.rowwise().reverse().leftCols(rank);
    span = span * vectors * squares.head(rank).cwiseSqrt().cwiseInverse().asDiagonal();
  }
  return span;
}

class Tests {
 public:
  Tests(const LogPosterior& posterior, const LogPosterior::Point& at, const Decimation& grid, const Eigen::MatrixXd& nothing_missing)
      : posterior_(posterior), at_(at), grid_(grid), errors_(posterior.likeliest(at)), fitted_(span_of(posterior.whiten(posterior.jacobian(at), at, errors_))) {
    residual_ = beside(posterior.whitened_residual(at, errors_));
    freedom_ = double(residual_.size() - fitted_.cols());
    if (nothing_missing.cols() > 0) others_ = beside(posterior.whiten(nothing_missing, at, errors_));
  }
  [[nodiscard]] double scale() const { return residual_.squaredNorm() / freedom_; }

  [[nodiscard]] ScoreTest of(const MechanismDirections& l) const {
    ScoreTest out{.name = l.name, .counts = !l.like_the_mesh};
    expect(std::size_t(l.directions.cols()) == l.keys.size() && l.off.size() == l.keys.size(), "every direction has a key");
    const Eigen::MatrixXd whitened = posterior_.whiten(grid_.apply(l.directions), at_, errors_), free = beside(whitened);
    std::vector<Eigen::Index> seen;
    for (Eigen::Index k = 0; k < free.cols(); ++k)
      if (free.col(k).norm() > nothing * whitened.col(k).norm() && whitened.col(k).norm() > 0) seen.push_back(k);
    if (seen.empty()) return out;
    // Each in its own unit, so that small numbers of a key do not count as nothing.
    const Eigen::VectorXd length = free(Eigen::all, seen).colwise().norm();
    const Eigen::MatrixXd unit = free(Eigen::all, seen) * length.cwiseInverse().asDiagonal();
    const Eigen::MatrixXd span = span_of(unit);
    out.directions = int(span.cols());
    out.chi2_drop = (span.transpose() * residual_).squaredNorm();
    const double rest = residual_.squaredNorm() - out.chi2_drop, of_rest = freedom_ - out.directions;
    if (!(rest > 0) || !(of_rest > 0)) return out;
    out.f = ratio(span, residual_);
    if (others_.cols() > 0) {
      out.f_of_runs = 0;
      for (Eigen::Index i = 0; i < others_.cols(); ++i) out.f_of_runs += ratio(span, others_.col(i)) / double(others_.cols());
    }
    out.p_value = boost::math::cdf(boost::math::complement(boost::math::fisher_f(out.directions, of_rest), out.f / std::max(1.0, out.f_of_runs)));
    if (out.directions < unit.cols()) return out;  // its keys are not distinguished
    const Eigen::MatrixXd inverse = inverse_symmetric(unit.transpose() * unit);
    const Eigen::VectorXd best = inverse * (unit.transpose() * residual_);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const auto k = Eigen::Index(i);
      const double off = l.off[std::size_t(seen[i])];
      out.keys.push_back({l.keys[std::size_t(seen[i])], off + best[k] / length[k], std::sqrt(rest / of_rest * inverse(k, k)) / length[k]});
    }
    return out;
  }

 private:
  /// F of a whitened residual in the span.
  [[nodiscard]] double ratio(const Eigen::MatrixXd& span, const Eigen::VectorXd& r) const {
    const double part = (span.transpose() * r).squaredNorm(), of_part = double(span.cols());
    return part / of_part / ((r.squaredNorm() - part) / (freedom_ - of_part));
  }
  [[nodiscard]] Eigen::MatrixXd beside(const Eigen::MatrixXd& m) const { return m - fitted_ * (fitted_.transpose() * m); }
  const LogPosterior& posterior_;
  const LogPosterior::Point& at_;
  const Decimation& grid_;
  const std::size_t errors_;  ///< the likeliest hypothesis about them
  Eigen::MatrixXd fitted_;
  Eigen::VectorXd residual_;
  Eigen::MatrixXd others_;  ///< whitened residuals at which nothing was missing, (values, k)
  double freedom_ = 0;
};

}  // namespace

const ScoreTest* ScoreTests::first() const {
  const auto at = std::find_if(mechanisms.begin(), mechanisms.end(), [](const auto& m) { return m.counts; });
  return at == mechanisms.end() ? nullptr : &*at;
}

std::size_t ScoreTests::counted() const {
  return std::size_t(std::count_if(mechanisms.begin(), mechanisms.end(), [](const auto& m) { return m.counts; }));
}

ScoreTests score_tests(const LogPosterior& posterior, const LogPosterior::Point& at, const Decimation& grid, const std::vector<MechanismDirections>& left_out,
                       const Eigen::MatrixXd& nothing_missing) {
  const Tests test(posterior, at, grid, nothing_missing);
  ScoreTests out{.scale = test.scale(), .with_runs = nothing_missing.cols() > 0};
  for (const auto& l : left_out) out.mechanisms.push_back(test.of(l));
  std::stable_sort(out.mechanisms.begin(), out.mechanisms.end(), [](const auto& a, const auto& b) { return a.p_value < b.p_value; });
  const ScoreTest* first = out.first();
  if (!first) return out;
  out.p_value = std::min(1.0, double(out.counted()) * first->p_value);
  out.stands_out = out.p_value < least_score_p;
  return out;
}

MechanismDirections gauge_gains(const Problem& problem, const std::vector<double>& history) {
  const auto n = Eigen::Index(problem.shape.times.size());
  MechanismDirections out{.name = gauge_gains_name};
  out.directions = Eigen::MatrixXd::Zero(Eigen::Index(history.size()), Eigen::Index(problem.observations.size()));
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const auto& o = problem.observations[i];
    const auto at = Eigen::Index(problem.shape.at(o.condition, o.sensor, 0));
    out.directions.col(Eigen::Index(i)).segment(at, n) = Eigen::Map<const Eigen::VectorXd>(history.data() + at, n);
    out.keys.push_back(problem.shape.sensors[o.sensor] + (problem.shape.conditions.size() > 1 ? " " + problem.shape.conditions[o.condition] : "")),
        out.off.push_back(1);
  }
  return out;
}

Json score_tests_json(const ScoreTests& s, const std::string& sentence) {
  Json all = Json::array();
  for (const auto& m : s.mechanisms) {
    Json keys = Json::object();
    for (const auto& k : m.keys) keys[k.name] = {{"value", number(k.value)}, {"sd", number(k.sd)}};
    all.push_back({{"name", m.name},
                   {"directions", m.directions},
                   {"chi2_drop", number(m.chi2_drop)},
                   {"f", number(m.f)},
                   {"f_of_runs", number(m.f_of_runs)},
                   {"p_value", number(m.p_value)},
                   {"counts", m.counts},
                   {"keys", keys}});
  }
  return {{"scale", number(s.scale)}, {"p_value", number(s.p_value)}, {"stands_out", s.stands_out}, {"sentence", sentence}, {"mechanisms", all}};
}

}  // namespace calomel
