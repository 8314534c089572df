#pragma once
/// A column along x whose nodes move along x only, and the decay rate of its standing waves.
#include <map>

#include "forward/mechanism/mechanism.hpp"
#include "tests/verification/small_runs.hpp"

namespace calomel::testing {

inline Mesh column(int n, double length, Region region) {
  const double h = length / n;
  Mesh m = block({n, 1, 1}, {0, 0, 0}, {length, h, h}, region);
  fix(m, 2 | 4, everywhere());
  return m;
}

/// The values of a mechanism by name; the others have their defaults.
inline MechanismValues values_of(const MechanismEntry& entry, const std::map<std::string, double>& set) {
  MechanismValues v(entry.keys);
  for (const auto& [key, value] : set) *v.find(key) = value;
  return v;
}

struct Decay {
  double rate;          ///< [1/s]
  double energy_error;  ///< error of the energy balance
};

/// Decay rate of the standing wave u = 1e-6 cos(k x) of angular frequency w, from its amplitude over `periods` after the first `skip` periods. Both
/// ends are free, so k = n pi / length. The amplitude is that of the displacement and of the displacement a quarter period later.
inline Decay decay(const Mesh& mesh, RunSetup s, double k, double w, int periods, int skip = 0) {
  const double quarter = M_PI / (2 * w);
  s.output_interval = quarter;
  s.end = 4 * quarter * (skip + periods) + quarter;
  s.initial_displacement = field(mesh, [&](const Vec3& x) { return Vec3{1e-6 * std::cos(k * x[0]), 0, 0}; });
  ObservationRow row;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) row.nodes.push_back(NodeId(n)), row.weights.push_back({std::cos(k * mesh.nodes[n][0]), 0, 0});
  SolveOptions o;
  o.energy_balance = true;
  const auto out = ExplicitSolver(mesh, s.steel).solve(s, std::vector<ObservationRow>{row}, o);
  const auto a = row_of(out, 0);
  const auto amplitude = [&](std::size_t i) { return std::hypot(a[i], a[i + 1]); };
  return {std::log(amplitude(4 * std::size_t(skip)) / amplitude(4 * std::size_t(skip + periods))) / (4 * quarter * periods), out.energy_balance_error};
}

}  // namespace calomel::testing
