#pragma once
/// Steel: linear isotropic elasticity, small strain.
#include "base/options.hpp"

namespace calomel {

/// sigma = lambda tr(epsilon) I + 2 mu epsilon; tension positive [Pa].
struct LinearElastic {
  double lambda;  ///< first Lame constant [Pa]
  double mu;      ///< shear modulus [Pa]

  static LinearElastic from_young(double young, double poisson) { return {young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))}; }
  [[nodiscard]] double young() const { return mu * (3 * lambda + 2 * mu) / (lambda + mu); }
  /// Modulus of plane longitudinal waves, lambda + 2 mu = rho c_L^2 [Pa].
  [[nodiscard]] double longitudinal_modulus() const { return lambda + 2 * mu; }
};

/// `[material.steel]`; the defaults are 316L (physics.md section 2).
struct SteelOptions {
  double density = 7960;  // kg/m^3
  double young = 193e9;   // Pa
  double poisson = 0.29;
  template <class V>
  void visit(V& v) {
    v("density", density, {.unit = "kg/m^3", .range = between(100, 30000), .doc = "density of the steel"});
    v("young", young, {.unit = "Pa", .range = between(1e6, 1e13), .doc = "Young's modulus of the steel"});
    v("poisson", poisson, {.range = strictly_between(-1, 0.49), .doc = "Poisson's ratio of the steel"});
  }
};

}  // namespace calomel
