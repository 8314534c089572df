#pragma once
/// The repeatability floor: floor.json.

namespace calomel {

struct StageCall;

/// Measures it, run by run kept in floor.journal until floor.json stands, which is written over.
void floor_stage(StageCall& call);

/// floor.json of this model, made first, saying so, where there is none.
void need_floor(StageCall& call);

}  // namespace calomel
