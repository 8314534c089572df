#include "uq/diagnosis/held_out.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace calomel {

namespace {

constexpr double on_face = 1e-4;  ///< [m]

}  // namespace

std::vector<Fold> folds_by_face(const Problem& problem, const Eigen::MatrixXd& positions) {
  std::vector<Fold> alone;
  std::map<int, Fold> by_face;
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    alone.push_back({i});
    if (positions.rows() == 0) continue;
    const auto s = Eigen::Index(problem.observations[i].sensor);
    int face = 6;  // the first of the outermost planes that the gauge sits on: z, x, y
    for (const int axis : {1, 0, 2})
      for (const bool upper : {true, false}) {
        const double edge = upper ? positions.col(axis).maxCoeff() : positions.col(axis).minCoeff();
        if (positions.col(axis).maxCoeff() - positions.col(axis).minCoeff() > on_face && std::abs(positions(s, axis) - edge) < on_face) face = 2 * axis + upper;
      }
    by_face[face].push_back(i);
  }
  if (by_face.size() < 3) return alone;
  std::vector<Fold> folds;
  for (auto& [face, fold] : by_face) folds.push_back(std::move(fold));
  return folds;
}

PartFit fit_without(const PosteriorFit& fit, const std::vector<std::pair<Eigen::Index, double>>& held, const Fold& fold) {
  const Decimation& grid = fit.errors->grid();
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < grid.observations(); ++i) {
    if (std::find(fold.begin(), fold.end(), i) != fold.end()) continue;
    for (std::size_t k = 0; k < grid.windows(i).size(); ++k) rows.push_back(Eigen::Index(grid.offset(i) + k));
  }
  std::vector<RecordErrors> errors;
  for (const auto& h : fit.hypotheses)
    errors.push_back({Eigen::MatrixXd(h.errors.covariance()(rows, rows)), Eigen::VectorXd(h.errors.data()(rows)), h.errors.freedom(), h.log_weight});
  const LogPosterior& all = *fit.posterior;
  const LogPosterior part(all.box(), all.emulator(), Eigen::MatrixXd(fit.coefficients(rows, Eigen::all)), errors, Eigen::MatrixXd(fit.noise(rows, rows)), all.priors(), all.beyond_prior());
  const auto mode_of = [](const LogPosterior& posterior, const std::vector<LocalMode>& known) {
    std::vector<Eigen::VectorXd> starts;
    for (const auto& m : known) starts.push_back(posterior.q(m.at.theta, m.at.beyond));
    auto modes = find_modes(posterior, starts);
    if (modes.empty()) throw NumericsError("no mode was found without some of the gauges");
    return modes[0];
  };
  PartFit out;
  const auto predicted = [&](const LocalMode& m) { return Eigen::VectorXd(fit.coefficients * all.emulator().features(m.at.u, m.at.beyond)); };
  const LocalMode full = mode_of(part, fit.modes);
  out.log_evidence = log_evidence(part, full), out.prediction = predicted(full), out.history = fit.history(full.at.u, full.at.beyond);
  if (held.empty()) return out;
  const LogPosterior nested = part.held(held);
  const LocalMode without = mode_of(nested, fit.nested_modes);
  out.nested_log_evidence = log_evidence(nested, without), out.nested_prediction = predicted(without);
  return out;
}

double misfit_of(const Fold& fold, const Decimation& grid, const Eigen::VectorXd& prediction, const Eigen::VectorXd& data) {
  double sum = 0;
  for (const std::size_t i : fold) {
    const auto at = Eigen::Index(grid.offset(i)), n = Eigen::Index(grid.windows(i).size());
    sum += (prediction - data).segment(at, n).norm() / data.segment(at, n).norm();
  }
  return sum / double(fold.size());
}

void keep_held_out(const Fold& fold, const Problem& problem, const Eigen::VectorXd& history, std::vector<double>& into) {
  if (into.empty()) into.assign(std::size_t(history.size()), std::numeric_limits<double>::quiet_NaN());
  for (const std::size_t i : fold) {
    const auto& o = problem.observations[i];
    const std::size_t at = problem.shape.at(o.condition, o.sensor, 0);
    std::copy_n(history.begin() + std::ptrdiff_t(at), problem.shape.times.size(), into.begin() + std::ptrdiff_t(at));
  }
}

}  // namespace calomel
