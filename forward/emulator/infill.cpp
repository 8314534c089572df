#include "forward/emulator/infill.hpp"

#include "base/errors.hpp"
#include "forward/campaign/design.hpp"

namespace calomel {

InfillPoints infill(const MultilevelRegression& emulator, const Eigen::MatrixXd& draws, int coarse, int fine) {
  expect(draws.cols() > 0, "there are points to choose from");
  InfillPoints out;
  MultilevelRegression now = emulator;
  std::vector<Eigen::Index> chosen;
  const int runs = coarse + fine;
  for (int i = 0; i < runs; ++i) {
    const int level = emulator.levels() > 1 && i >= fine ? 1 : 0;  // the dear ones first, where most is unknown
    Eigen::Index best = 0;
    double most = -1;
    for (Eigen::Index k = 0; k < draws.cols(); ++k) {
      const Eigen::VectorXd u = draws.col(k);
      // What a run there takes off its own level's variance.
      const double v = now.variance(now.level_features(u, level));
      if (v > most) most = v, best = k;
    }
    now = now.with_run(draws.col(best), level);
    chosen.push_back(best), out.level.push_back(level);
  }
  out.u.resize(draws.rows(), Eigen::Index(chosen.size()));
  for (std::size_t i = 0; i < chosen.size(); ++i) out.u.col(Eigen::Index(i)) = draws.col(chosen[i]);
  return out;
}

Eigen::MatrixXd first_design(Eigen::Index parameters, int n, std::uint64_t seed) {
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(parameters, n);
  if (n > 1) u.rightCols(n - 1) = (2 * sobol_points(std::size_t(parameters), std::size_t(n - 1), seed).array() - 1).matrix();
  return u;
}

}  // namespace calomel
