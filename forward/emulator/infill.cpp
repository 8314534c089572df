#include "forward/emulator/infill.hpp"

#include "base/errors.hpp"
#include "forward/campaign/design.hpp"

namespace calomel {

namespace {

constexpr double apart = 0.2;  ///< of u, whose box is 2 wide

}  // namespace

InfillPoints infill(const MultilevelRegression& emulator, const Eigen::MatrixXd& draws, int coarse, int fine) {
  expect(draws.cols() > 0, "there are points to choose from");
  InfillPoints out;
  MultilevelRegression now = emulator;
  std::vector<Eigen::MatrixXd> taken;  // by level
  for (int l = 0; l < emulator.levels(); ++l) taken.push_back(emulator.points(l));
  std::vector<Eigen::Index> chosen;
  const int runs = coarse + fine;
  for (int i = 0; i < runs; ++i) {
    const int level = emulator.levels() > 1 && i >= fine ? 1 : 0;  // expensive runs first, where the variance is largest
    Eigen::Index best = -1;
    Eigen::MatrixXd& of_level = taken[std::size_t(level)];
    double most = -1;
    for (Eigen::Index k = 0; k < draws.cols(); ++k) {
      const Eigen::VectorXd u = draws.col(k);
      if (of_level.cols() > 0 && (of_level.colwise() - u).colwise().norm().minCoeff() < apart) continue;
      const double v = now.variance(now.level_features(u, level));
      if (v > most) {
        most = v;
        best = k;
      }
    }
    if (best < 0) continue;  // every draw has a run beside it: further runs here give no information
    now = now.with_run(draws.col(best), level);
    of_level.conservativeResize(Eigen::NoChange, of_level.cols() + 1);
    of_level.col(of_level.cols() - 1) = draws.col(best);
    chosen.push_back(best);
    out.level.push_back(level);
  }
  out.u.resize(draws.rows(), Eigen::Index(chosen.size()));
  for (std::size_t i = 0; i < chosen.size(); ++i) out.u.col(Eigen::Index(i)) = draws.col(chosen[i]);
  return out;
}

Eigen::MatrixXd first_design(Eigen::Index parameters, int n, std::uint64_t seed) {
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(parameters, n);
  if (n > 1) u.rightCols(n - 1) = (2 * space_filling_points(std::size_t(parameters), std::size_t(n - 1), seed).array() - 1).matrix();
  return u;
}

}  // namespace calomel
