#pragma once
/// The whole case held against its rules.
#include "base/errors.hpp"

namespace calomel {

struct StageCall;

/// Reads every table, builds the mesh, places the sensors and holds the recordings against them. Tells on stdout what will be run and its cost, a screenful;
/// with
/// --resolved stdout is the case with all defaults as JSON and the rest goes to stderr, where warnings always are.
/// Runs nothing and writes nothing, but with --floor the ensemble mean on jittered meshes and the other numerical errors, which go to floor.json, and with
/// --write-mesh the mesh.
ExitStatus check_stage(StageCall& call);

}  // namespace calomel
