#pragma once
/// The load of a run on a mesh: what mechanisms change of it, and what it needs of the mesh.
#include "forward/target/forward_case.hpp"
#include "forward/mesh/mesh.hpp"
#include "forward/solver/load.hpp"

namespace calomel {

/// The load with what mechanisms change of it, on a target whose outer front face is at x = front [m].
/// Errors: InputError for a beam or a mechanism that only a whole target can have where a part of it is modelled, and for a mechanism of a rear face where
/// there is none.
[[nodiscard]] LoadOptions effective_load(const ForwardCase& at, const Mesh& mesh, double front);

/// The load must find its place on a mesh from outside. Errors: InputError.
void expect_something_moves(const ForwardCase& forward_case, const Mesh& mesh);

/// Errors: InputError for a pulse that heats no mercury.
void expect_heat(const LoadOptions& load, const HeatingShape& heating, const Mesh& mesh);

}  // namespace calomel
