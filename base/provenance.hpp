#pragma once
/// Where artefacts come from, and the identity of a stage (the hash of the options it reads and of its inputs) by which a finished stage is reused or refused.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/json.hpp"

namespace calomel {

/// Where an artefact comes from.
struct Provenance {
  std::string stage;              ///< "campaign", "train", ...
  Json options = Json::object();  ///< resolved options that the stage reads, by table
  std::uint64_t seed = 1;
  std::map<std::string, std::string> inputs;  ///< name -> hash

  /// Hash over stage, options, seed and inputs.
  [[nodiscard]] std::string identity() const;
  /// {program, version, stage, seed, options, inputs, identity}
  [[nodiscard]] Json json() const;
};

enum class Reuse { nothing_there, matches };

/// Compares the summary at `path` (its "provenance") with what would be made now.
/// Errors: InputError naming the keys that changed when the artefact is of another identity.
[[nodiscard]] Reuse reusable(const std::filesystem::path& path, const Provenance& now);

/// The same for a provenance read from elsewhere; `file` is the artefact named in the error.
void expect_same_provenance(const Json& before, const Provenance& now, const std::filesystem::path& file);

/// Dotted keys at which two JSON objects differ.
std::vector<std::string> changed_keys(const Json& before, const Json& now, const std::string& prefix = "");

}  // namespace calomel
