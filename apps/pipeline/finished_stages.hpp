#pragma once
/// Which stages are finished in --out and may be reused. The rule of --fresh is here and nowhere else.
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace calomel {

struct Provenance;  // base/provenance.hpp

/// Why a stage is come to: the user named it, or another stage needs it.
enum class Requested { by_user, upstream };

/// Of one call: no artefact that it made itself is ever set aside by it.
class FinishedStages {
 public:
  FinishedStages(std::filesystem::path out, bool fresh) : out_(std::move(out)), fresh_(fresh) {}

  /// Whether the stage's artefacts must be set aside first (--fresh): those of the stage that the user requested, and those upstream that do not match.
  /// Errors: InputError naming the changed keys where they do not match and --fresh was not given.
  [[nodiscard]] bool to_be_set_aside(const Provenance& now, Requested requested);
  /// Whether the stage must be done: false when its summary, STAGE.json, matches `now` and all `files` exist. Sets them aside as above, with them what a call
  /// that was cut off has left: `unfinished`, which may be empty.
  [[nodiscard]] bool due(const Provenance& now, const std::vector<std::string>& files, Requested requested, const std::string& unfinished = {});

 private:
  std::filesystem::path out_;
  bool fresh_;
  std::set<std::string> begun_;  ///< stages that this call has come to: --fresh sets nothing of them aside again
};

}  // namespace calomel
