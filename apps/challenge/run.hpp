#pragma once
/// All cases of a suite diagnosed, one after another.
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace calomel::challenge {

/// Diagnoses one case: diagnosis.json in the directory `into`. False when it failed.
/// Errors: Interrupted.
using Diagnose = std::function<bool(const std::filesystem::path& case_file, const std::filesystem::path& into)>;

struct RunSummary {
  std::size_t cases = 0;            ///< of the suite
  std::size_t diagnosed = 0;        ///< by this call
  std::vector<std::string> failed;  ///< names of those that could not be
};

/// Diagnoses those cases of `directory` that have no results/case_NNN/diagnosis.json. `discard_runs`: the journal of the runs is deleted once the diagnosis is
/// finished. `say` is called with a sentence about every case. Errors: InputError when there is no case; those of `diagnose`.
RunSummary run_suite(const std::filesystem::path& directory, const Diagnose& diagnose, bool discard_runs, const std::function<void(const std::string&)>& say);

/// `calomel diagnose` as a child process, with these words after its own; what it says goes to diagnose.log beside the diagnosis.
Diagnose diagnose_by(const std::filesystem::path& program, std::vector<std::string> words);

}  // namespace calomel::challenge
