#pragma once
/// The repeatability floor: floor.json.

namespace calomel {

struct StageCall;

/// Measures it, with its runs kept in the run journal, and writes floor.json.
void floor_stage(StageCall& call);

/// floor.json of this model, made first, saying so, where there is none.
void need_floor(StageCall& call);

}  // namespace calomel
