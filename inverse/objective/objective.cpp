#include "inverse/objective/objective.hpp"

#include <cmath>
#include <limits>

namespace calomel {

double Objective::value(const Score& score) const {
  if (!score.ok) return std::numeric_limits<double>::quiet_NaN();
  return formula(score.accuracy, score.mae, score.nrmse, score.delta1, score.delta2);
}

double Objective::cost(double value) const {
  if (!std::isfinite(value)) return std::numeric_limits<double>::infinity();
  return maximise ? -value : value;
}

std::vector<double> Objective::costs(const Problem& problem, const Eigen::MatrixXf& values) const { return costs(score_batch(problem, values)); }

std::vector<double> Objective::costs(const BatchScore& s) const {
  std::vector<double> out(s.mae.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = cost(formula(s.accuracy[i], s.mae[i], s.nrmse[i], s.delta1[i], s.delta2[i]));
  return out;
}

const Registry<Objective>& objectives() {
  static const Registry<Objective> all = [] {
    Registry<Objective> r("objective");
    const auto add = [&](const char* name, const char* summary, bool maximise, auto formula) { r.add(name, summary, {name, maximise, formula}); };
    add("paper_enc", "accuracy [%] - mae [microstrain], maximised, as published for ENC", true,
        [](double accuracy, double mae, double, double, double) { return accuracy - mae; });
    add("paper_spe", "delta1 + 5 delta2 summed over the sensors, minimised, as published for SPE", false,
        [](double, double, double, double delta1, double delta2) { return delta1 + 5 * delta2; });
    add("rrmse", "relative root-mean-square error, mean over the sensors, minimised", false,
        [](double, double, double nrmse, double, double) { return nrmse; });
    return r;
  }();
  return all;
}

}  // namespace calomel
