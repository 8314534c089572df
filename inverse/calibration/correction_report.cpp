#include <fmt/format.h>

#include "forward/emulator/mesh_correction.hpp"
#include "inverse/calibration/calibration.hpp"

namespace calomel {

std::string moves(const ModelShape& shape, const std::vector<double>& from, const std::vector<double>& to) {
  std::vector<std::string> words;
  for (std::size_t k = 0; k < from.size(); ++k)
    words.push_back(from[k] != 0 ? fmt::format("{} {:+.1f} %", shape.parameters[k].name, 100 * (to[k] / from[k] - 1))
                                 : fmt::format("{} {:+.4g}", shape.parameters[k].name, to[k]));
  return join(words);
}

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
  m.scores_on = "the finest mesh of the emulator";
  const auto without = [&](const std::vector<double>& theta, const std::vector<double>& values) {
    const Eigen::VectorXd own = Eigen::Map<const Eigen::VectorXd>(values.data(), Eigen::Index(values.size())) - correction.shift(theta);
    return std::vector<double>(own.begin(), own.end());
  };
  if (!out.nominal_values.empty()) {
    m.nominal_values = without(out.nominal, out.nominal_values);
    m.at_nominal = score(problem, m.nominal_values);
  }
  m.sentence = fmt::format("predictions are corrected for the mesh by {} runs of the emulator", correction.runs());
  if (!out.calibrated.empty()) {
    m.calibrated = without(out.theta, out.calibrated);
    m.best = score(problem, m.calibrated);
    m.difference = relative_difference(problem, correction.shift(out.theta), m.calibrated);
    m.sentence += fmt::format("; at the calibrated point the correction is {:.2g} % of the histories", 100 * m.difference);
  }
  if (!m.without.empty()) m.sentence += fmt::format("; difference from the calibration without it: {}", moves(problem.shape, m.without, out.theta));
  const auto mark = [&](Candidate& c) { c.inside_emulator = correction.inside(c.theta); };
  mark(out.best), mark(out.at_nominal);
  for (auto* list : {&out.candidates, &out.failed})
    for (auto& c : *list) mark(c);
  if (!out.at_nominal.inside_emulator)
    m.sentence += "; the nominal point lies outside the emulator's box, so that its scores are more reliable on the case's own mesh (working_mesh)";
  out.warnings.insert(out.warnings.end(), correction.reservations.begin(), correction.reservations.end());
  if (!out.best.inside_emulator)
    out.warnings.push_back(
        "the answer lies outside the box about the posterior in which the emulator knows the mesh error: its correction is that of the box's nearest point. "
        "See "
        "where `calomel "
        "sample` finds the parameters, and whether they are bounded too widely");
}

}  // namespace calomel
