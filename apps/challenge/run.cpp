#include "apps/challenge/run.hpp"

#include <fmt/format.h>

#include "apps/challenge/child.hpp"
#include "apps/challenge/judged_case.hpp"
#include "apps/challenge/make.hpp"
#include "base/artefact.hpp"
#include "base/errors.hpp"

namespace calomel::challenge {

namespace fs = std::filesystem;

RunSummary run_suite(const fs::path& directory, const Diagnose& diagnose, bool discard_runs, const std::function<void(const std::string&)>& say) {
  const auto names = cases_in(directory);
  RunSummary summary{.cases = names.size()};
  for (std::size_t k = 0; k < names.size(); ++k) {
    const fs::path into = directory / "results" / names[k], found = into / "diagnosis.json";
    const std::string which = fmt::format("{} ({} of {})", names[k], k + 1, names.size());
    if (!fs::exists(found)) {
      make_directory(into);
      std::string why;
      try {
        if (diagnose(directory / "cases" / names[k] / "case.toml", into)) {
          const Finding f = read_finding(found);
          ++summary.diagnosed;
          say(fmt::format("{}: {}{}, {} runs", which, text(f.verdict), f.mechanisms.empty() ? "" : ' ' + join(f.mechanisms, " or "), f.runs));
        } else {
          why = last_line(into / "diagnose.log");
          if (why.empty()) why = "without a word";
        }
      } catch (const InputError& e) {  // of what it has written
        why = e.what();
      }
      if (!why.empty()) {
        summary.failed.push_back(names[k]);
        say(fmt::format("{} failed: {}", which, why));
        continue;
      }
    }
    if (discard_runs) fs::remove(into / "runs.journal");
  }
  return summary;
}

Diagnose diagnose_by(const fs::path& program, std::vector<std::string> words) {
  return [program, words = std::move(words)](const fs::path& case_file, const fs::path& into) {
    std::vector<std::string> all{"diagnose", case_file.string(), "--out", into.string()};
    all.insert(all.end(), words.begin(), words.end());
    const int status = run_child(program, all, into / "diagnose.log");
    return status == int(ExitStatus::done) || status == int(ExitStatus::not_to_be_trusted);
  };
}

}  // namespace calomel::challenge
