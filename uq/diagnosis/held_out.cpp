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

std::vector<Eigen::Index> rows_of(const Decimation& grid, const std::vector<std::size_t>& observations) {
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < grid.observations(); ++i) {
    if (std::find(observations.begin(), observations.end(), i) == observations.end()) continue;
    for (std::size_t k = 0; k < grid.windows(i).size(); ++k) rows.push_back(Eigen::Index(grid.offset(i) + k));
  }
  return rows;
}

LogPosterior part_of(const PosteriorFit& fit, const PosteriorFit& errors, const std::vector<Eigen::Index>& rows) {
  std::vector<RecordErrors> parts;
  for (const auto& h : errors.hypotheses)
    parts.push_back({Eigen::MatrixXd(h.errors.covariance()(rows, rows)), Eigen::VectorXd(h.errors.data()(rows)), h.errors.freedom(), h.log_weight});
  const LogPosterior& all = *fit.posterior;
  return {all.box(), all.emulator(), Eigen::MatrixXd(fit.coefficients(rows, Eigen::all)), parts, Eigen::MatrixXd(fit.noise(rows, rows)), all.priors(), all.beyond_prior()};
}

PartFit fit_without(const PosteriorFit& fit, const PosteriorFit& errors, const Fold& fold) {
  std::vector<std::size_t> rest;
  for (std::size_t i = 0; i < fit.errors->grid().observations(); ++i)
    if (std::find(fold.begin(), fold.end(), i) == fold.end()) rest.push_back(i);
  const LogPosterior part = part_of(fit, errors, rows_of(fit.errors->grid(), rest));
  std::vector<Eigen::VectorXd> starts;
  for (const auto& m : fit.modes) starts.push_back(m.q);
  const auto modes = find_modes(part, starts);
  if (modes.empty()) throw NumericsError("no mode was found without some of the gauges");
  const LocalMode& m = modes[0];
  return {.log_evidence = log_evidence(part, m), .prediction = fit.coefficients * part.emulator().features(m.at.u, m.at.beyond), .history = fit.history(m.at.u, m.at.beyond)};
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
