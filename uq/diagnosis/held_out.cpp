#include "uq/diagnosis/held_out.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace calomel {

namespace {

constexpr double on_face = 1e-4;  ///< [m]
constexpr std::size_t parts = 4;   ///< of a record that is the only one

using Gauges = std::vector<std::size_t>;  ///< observations

std::vector<Gauges> gauges_by_face(const Problem& problem, const Eigen::MatrixXd& positions) {
  std::vector<Gauges> alone;
  std::map<int, Gauges> by_face;
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
  std::vector<Gauges> folds;
  for (auto& [face, fold] : by_face) folds.push_back(std::move(fold));
  return folds;
}

}  // namespace

std::vector<Fold> folds_by_face(const Problem& problem, const Decimation& grid, const Eigen::MatrixXd& positions) {
  std::vector<Fold> folds;
  if (grid.observations() == 1) {
    const std::size_t n = grid.size();
    for (std::size_t p = 0; p < parts && n >= 2 * parts; ++p) {
      Fold& f = folds.emplace_back();
      f.records = 1.0 / parts;
      for (std::size_t k = n * p / parts; k < n * (p + 1) / parts; ++k) f.rows.push_back(Eigen::Index(k));
    }
    return folds;
  }
  for (const auto& gauges : gauges_by_face(problem, positions)) {
    Fold& f = folds.emplace_back();
    f.records = double(gauges.size());
    for (const std::size_t i : gauges)
      for (std::size_t k = 0; k < grid.windows(i).size(); ++k) f.rows.push_back(Eigen::Index(grid.offset(i) + k));
  }
  return folds;
}

PartFit fit_without(const PosteriorFit& fit, const std::vector<std::pair<Eigen::Index, double>>& held, const Fold& fold) {
  const Decimation& grid = fit.errors->grid();
  std::vector<Eigen::Index> rows;
  for (Eigen::Index k = 0; k < Eigen::Index(grid.size()); ++k)
    if (!std::binary_search(fold.rows.begin(), fold.rows.end(), k)) rows.push_back(k);
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
  out.log_evidence = log_evidence(part, full), out.prediction = predicted(full);
  if (held.empty()) return out;
  const LogPosterior nested = part.held(held);
  const LocalMode without = mode_of(nested, fit.nested_modes);
  out.nested_log_evidence = log_evidence(nested, without), out.nested_prediction = predicted(without);
  return out;
}

double misfit_of(const Fold& fold, const Decimation& grid, const Eigen::VectorXd& prediction, const Eigen::VectorXd& data) {
  double sum = 0, records = 0;
  for (std::size_t i = 0; i < grid.observations(); ++i) {
    const auto at = Eigen::Index(grid.offset(i)), n = Eigen::Index(grid.windows(i).size());
    std::vector<Eigen::Index> rows;
    for (const auto k : fold.rows)
      if (k >= at && k < at + n) rows.push_back(k);
    if (rows.empty()) continue;
    sum += (prediction - data)(rows).norm() / (data.segment(at, n).norm() * std::sqrt(double(rows.size()) / double(n))), ++records;
  }
  return sum / records;
}

}  // namespace calomel
