#include <algorithm>
#include <cmath>
#include <numbers>

#include "forward/campaign/archive.hpp"
#include "forward/campaign/design.hpp"

namespace calomel {

namespace {

double uniform_density(const Eigen::VectorXd&) { return 1; }

/// prod 1 / (pi sqrt(x (1 - x))); at a face, where it has no bound, its value 1e-12 inside.
double arcsine_density(const Eigen::VectorXd& unit) {
  double density = 1;
  for (const double coordinate : unit) {
    const double x = std::clamp(coordinate, 1e-12, 1 - 1e-12);
    density /= std::numbers::pi * std::sqrt(x * (1 - x));
  }
  return density;
}

}  // namespace

const Registry<Design>& designs() {
  static const auto catalogue = [] {
    Registry<Design> all("design");
    all.add("sobol", "Sobol' points under a random digital shift; uniform measure, at most 40 parameters", {"uniform", sobol_points, uniform_density});
    all.add("latin_hypercube", "one point in each of `runs` slices of every parameter; uniform measure", {"uniform", latin_hypercube_points, uniform_density});
    all.add("chebyshev", "Sobol' points carried to the Chebyshev measure, dense at the bounds; at most 40 parameters",
            {"chebyshev", chebyshev_points, arcsine_density});
    return all;
  }();
  return catalogue;
}

double design_density(const std::string& design, const Eigen::VectorXd& unit) { return designs().get(design).density(unit); }

}  // namespace calomel
