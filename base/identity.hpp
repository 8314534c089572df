#pragma once
/// The identity of an existing artefact, by the present definition.
#include <string>

#include "base/options.hpp"

namespace calomel {

/// Provenance::identity of a provenance as an artefact holds it; solver.booking, now solver.energy_balance, which once was part of it in every stage, counts in
/// simulate alone, solver.checkpoint, which was too, nowhere.
std::string identity_of(const Json& written);

}  // namespace calomel
