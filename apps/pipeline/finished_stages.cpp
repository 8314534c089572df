#include "apps/pipeline/finished_stages.hpp"

#include <algorithm>

#include "base/artefact.hpp"
#include "base/errors.hpp"
#include "base/provenance.hpp"

namespace calomel {

bool FinishedStages::to_be_set_aside(const Provenance& now, Requested requested) {
  const bool may = fresh_ && begun_.insert(now.stage).second;
  if (may && requested == Requested::by_user) return true;
  try {
    return reusable(out_ / (now.stage + ".json"), now) == Reuse::nothing_there && may;
  } catch (const InputError&) {
    if (!may) throw;
    return true;
  }
}

bool FinishedStages::due(const Provenance& now, const std::vector<std::string>& files, Requested requested, const std::string& unfinished) {
  if (to_be_set_aside(now, requested)) {
    for (const auto& f : files) set_aside(out_ / f);
    if (!unfinished.empty()) set_aside(out_ / unfinished);
  }
  return !std::all_of(files.begin(), files.end(), [&](const auto& f) { return std::filesystem::exists(out_ / f); });
}

}  // namespace calomel
