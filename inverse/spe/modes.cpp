#include "inverse/spe/modes.hpp"

#include <algorithm>

#include "base/errors.hpp"

namespace calomel {

std::vector<DensityMode> density_modes(const Eigen::MatrixXd& points, double bandwidth) {
  expect(bandwidth > 0, "a bandwidth is positive");
  constexpr int most_steps = 1000;
  const double n = double(points.cols());
  const auto kernel = [&](const Eigen::VectorXd& x) -> Eigen::ArrayXd {
    return (-0.5 / (bandwidth * bandwidth) * (points.colwise() - x).colwise().squaredNorm().array()).exp().transpose();
  };
  std::vector<DensityMode> ends;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    Eigen::VectorXd x = points.col(i);
    for (int step = 0; step < most_steps; ++step) {
      const Eigen::ArrayXd k = kernel(x);
      const Eigen::VectorXd next = points * k.matrix() / k.sum();
      const double moved = (next - x).norm();
      x = next;
      if (moved < 1e-6 * bandwidth) break;
    }
    ends.push_back({x, kernel(x).sum() / n, 1});
  }
  std::stable_sort(ends.begin(), ends.end(), [](const auto& a, const auto& b) { return a.density > b.density; });
  std::vector<DensityMode> modes;
  for (auto& e : ends) {
    const auto same = std::find_if(modes.begin(), modes.end(), [&](const auto& m) { return (m.x - e.x).norm() < 0.5 * bandwidth; });
    if (same == modes.end())
      modes.push_back(std::move(e));
    else
      ++same->points;
  }
  return modes;
}

}  // namespace calomel
