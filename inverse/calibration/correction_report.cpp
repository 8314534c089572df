#include "forward/emulator/mesh_correction.hpp"
#include "inverse/calibration/calibration.hpp"

namespace calomel {

double relative_difference(const Problem& problem, const Eigen::VectorXd& difference, std::span<const double> history) {
  const auto n = Eigen::Index(problem.shape.times.size());
  double sum = 0;
  for (const auto& o : problem.observations) {
    const auto at = Eigen::Index(problem.shape.at(o.condition, o.sensor, 0));
    sum += difference.segment(at, n).norm() / Eigen::Map<const Eigen::VectorXd>(history.data() + at, n).norm();
  }
  return sum / double(problem.observations.size());
}

void report_correction(Calibration& out, const Problem& problem, const MeshCorrection& correction) {
  if (correction.empty()) return;
  CorrectionReport& m = out.mesh;
  m.used = true;
  m.scores_on = ScoredMesh::emulators_finest;
  m.runs = correction.runs();
  const auto without = [&](const std::vector<double>& theta, const std::vector<double>& values) {
    const Eigen::VectorXd own = Eigen::Map<const Eigen::VectorXd>(values.data(), Eigen::Index(values.size())) - correction.shift(theta);
    return std::vector<double>(own.begin(), own.end());
  };
  if (!out.nominal_values.empty()) {
    m.nominal_values = without(out.nominal, out.nominal_values);
    m.at_nominal = score(problem, m.nominal_values);
  }
  if (!out.calibrated.empty()) {
    m.calibrated = without(out.theta, out.calibrated);
    m.best = score(problem, m.calibrated);
    m.difference = relative_difference(problem, correction.shift(out.theta), m.calibrated);
  }
  const auto mark = [&](Candidate& c) { c.inside_emulator = correction.inside(c.theta); };
  mark(out.best);
  mark(out.at_nominal);
  for (auto* list : {&out.candidates, &out.failed})
    for (auto& c : *list) mark(c);
  m.reservations = correction.reservations;
}

}  // namespace calomel
