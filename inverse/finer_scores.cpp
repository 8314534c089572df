#include "inverse/finer_scores.hpp"

#include <fmt/format.h>

#include "inverse/mesh_pairs.hpp"

namespace calomel {

std::vector<double> FinerScores::finer(std::span<const double> theta, std::span<const double> values) const {
  const Eigen::VectorXd d = mesh_.difference(theta);
  std::vector<double> y(values.begin(), values.end());
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += d[Eigen::Index(i)];
  return y;
}

void FinerScores::see(std::span<const double> theta, std::span<const double> values) {
  if (mesh_.empty()) return;
  Score s = score(problem_, finer(theta, values));
  const std::lock_guard guard(lock_);
  scores_.insert_or_assign({theta.begin(), theta.end()}, std::move(s));
}

void FinerScores::put_into(Calibration& out) const {
  if (mesh_.empty()) return;
  CorrectionReport& m = out.mesh;
  m.used = true, m.scores_on = "half the element size";
  m.best = out.best.score, m.at_nominal = out.at_nominal.score;
  m.calibrated = out.calibrated, m.nominal_values = out.nominal_values;
  if (!out.calibrated.empty()) {
    out.calibrated = finer(out.theta, m.calibrated), out.best.score = score(problem_, out.calibrated);
    m.difference = relative_difference(problem_, mesh_.difference(out.theta), m.calibrated);
  }
  if (!out.nominal_values.empty()) out.nominal_values = finer(out.nominal, m.nominal_values), out.at_nominal.score = score(problem_, out.nominal_values);
  for (auto& c : out.candidates) {
    const auto seen = scores_.find(c.theta);
    c.score = seen == scores_.end() ? Score{} : seen->second;
  }
  m.sentence = fmt::format("accuracy, mae and histories are those on half the element size, as {} pairs of runs tell it; `working_mesh` holds those of the case's own", mesh_.pairs());
}

}  // namespace calomel
