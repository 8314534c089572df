#pragma once
/// Modes of a cloud of points after smoothing it with a Gaussian.
#include <Eigen/Core>
#include <vector>

namespace calomel {

struct DensityMode {
  Eigen::VectorXd x;       ///< in the points' coordinates
  double density = 0;      ///< relative to that of all points in one place
  std::size_t points = 0;  ///< whose ascent ends here
};

/// Local maxima of sum_i exp(-|x - x_i|^2 / (2 h^2)) / n, densest first, by mean shift from every point (Fukunaga and Hostetler 1975; Comaniciu and Meer
/// 2002, IEEE Trans. Pattern Anal. Mach. Intell. 24, 603). Ascents that end within h / 2 of a denser end are one mode.
/// points: (d, n); bandwidth h in their unit.
std::vector<DensityMode> density_modes(const Eigen::MatrixXd& points, double bandwidth);

}  // namespace calomel
