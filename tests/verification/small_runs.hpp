#pragma once
/// Small hand-made meshes, runs on them, and fits of their results.
#include <gmock/gmock.h>

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "forward/mesh/hexahedron.hpp"
#include "forward/solver/explicit_solver.hpp"

namespace calomel::testing {

// 316L and the nominal mercury of the published study (physics.md sections 1 and 2).
inline constexpr double steel_density = 7960, young = 193e9, poisson = 0.29;
inline constexpr double mercury_density = 13500, mercury_speed = 1450;
inline LinearElastic steel() { return LinearElastic::from_young(young, poisson); }
inline double steel_speed() { return std::sqrt(steel().longitudinal_modulus() / steel_density); }

/// Prints a measured number beside its reference and records it as a property of the test.
void measured(const std::string& what, double value);

/// n x n x n equal elements between two corners. Node (i, j, k) is number (k (ny + 1) + j) (nx + 1) + i.
Mesh block(std::array<int, 3> n, const Vec3& low, const Vec3& high, const std::function<Region(const Vec3&)>& region_at);
Mesh block(std::array<int, 3> n, const Vec3& low, const Vec3& high, Region region);

/// Fixes the directions `bits` (1, 2, 4 = x, y, z) of the nodes that `where` names.
void fix(Mesh& mesh, int bits, const std::function<bool(const Vec3&)>& where);
inline auto everywhere() {
  return [](const Vec3&) { return true; };
}
inline auto plane(int axis, double at) {
  return [axis, at](const Vec3& x) { return std::abs(x[std::size_t(axis)] - at) < 1e-9; };
}

/// Gives mercury its own nodes wherever it shares them with steel; the pairs move together along `normals`.
void split(Mesh& mesh, const std::vector<Vec3>& normals);

/// Faces of elements that lie in the plane x[axis] = at, on their high side.
std::vector<Face> faces_at(const Mesh& mesh, int axis, double at);

std::vector<Vec3> field(const Mesh& mesh, const std::function<Vec3(const Vec3&)>& f);

/// Nearest node to a point; of coincident ones the first (the steel one of a pair).
NodeId nearest(const Mesh& mesh, const Vec3& x);

ObservationRow component(NodeId node, int axis, double weight = 1);
/// All nodes, x y z in turn.
std::vector<ObservationRow> all_components(const Mesh& mesh);

/// Elastic steel and a linear liquid without viscosity.
RunSetup linear_setup(double end, double output_interval);

/// Displacements at the last time, (nodes) in mesh order.
std::vector<Vec3> final_displacement(const Mesh& mesh, const SolveSummary& s);
inline std::span<const double> row_of(const SolveSummary& s, std::size_t row) { return {s.observations.data() + row * s.times.size(), s.times.size()}; }

/// Lumped nodal masses, an eighth of each element's.
Eigen::VectorXd masses(const Mesh& mesh, const RunSetup& setup);

/// Accelerations [m/s^2] (3 n + c) of a displacement field at rest, from one step of the solver itself:
/// u1 - u0 = a dt^2 / 2.
Eigen::VectorXd accelerations(const ExplicitSolver& solver, RunSetup setup, const std::vector<Vec3>& displacement, const SolveOptions& options = {});

/// Stiffness matrix [N/m] of a small mesh, column by column from the solver.
Eigen::MatrixXd stiffness(const ExplicitSolver& solver, const RunSetup& setup);

/// Frequency [Hz] within (low, high) of the harmonic (with a mean) that leaves the least residual, by golden section after a scan.
double fitted_frequency(std::span<const double> t, std::span<const double> y, double low, double high);

}  // namespace calomel::testing
