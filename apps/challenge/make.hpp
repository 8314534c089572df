#pragma once
/// A suite on disk: DIR/cases/case_NNN is what a user would have, DIR/truth/case_NNN.toml what is concealed.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/challenge/suite.hpp"

namespace calomel::challenge {

/// Makes one case: reads the SPEC at `spec`, writes case.toml and recordings.csv into the directory `into` and the truth to `truth`. What it has to say goes to
/// `log`. False when it failed.
using Generate = std::function<bool(const std::filesystem::path& spec, const std::filesystem::path& into, const std::filesystem::path& truth,
                                    const std::filesystem::path& log)>;

struct MakeSummary {
  std::size_t cases = 0;            ///< of the suite
  std::size_t made = 0;             ///< by this call
  std::vector<std::string> failed;  ///< names of the cases that could not be made
};

/// Makes those cases of the suite that `out` does not hold, one after another; each is whole or absent at every instant. The SPEC files and what the generator
/// said stand beside the truth, suite.json says what the suite is. Without `generate` the SPEC files are all that is written. `done` is called before the first
/// case and after each. Errors: InputError when the options are not valid, or `out` holds another suite (naming what differs) or is in use; those of
/// `generate`.
MakeSummary make_suite(const SuiteOptions& options, std::uint64_t seed, const std::filesystem::path& out, const Generate& generate,
                       const std::function<void(std::size_t done, std::size_t total, std::size_t failed)>& done = {});

/// The reference generator: `given` where it is not empty, else beside the program at `program`, in its build tree, or in the libexec folder of its install
/// tree. Errors: InputError that says how to build it.
std::filesystem::path find_generator(const std::filesystem::path& given, const std::filesystem::path& program);

/// The reference generator as a child process on `threads` threads.
Generate generate_by(const std::filesystem::path& generator, int threads);

/// Names of the cases in `directory`/cases, in alphabetical order. Errors: InputError when there is no such directory or no case in it.
std::vector<std::string> cases_in(const std::filesystem::path& directory);

}  // namespace calomel::challenge
