#include "apps/challenge/make.hpp"

#include <algorithm>

#include "apps/challenge/child.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/provenance.hpp"

namespace calomel::challenge {

namespace fs = std::filesystem;

namespace {

constexpr int drawing = 2;  ///< raised when the same seed gives other cases than before
constexpr const char* generator_name = "reference_generator";

Provenance provenance_of(const SuiteOptions& options, std::uint64_t seed) {
  return {.stage = "challenge", .options = {{"suite", echo(options)}, {"drawing", drawing}}, .seed = seed};
}

/// One case by way of `work`, an empty folder of its own. False when the generator failed.
bool make_case(const fs::path& spec, const fs::path& work, const fs::path& into, const fs::path& truth, const fs::path& log, const Generate& generate) {
  const fs::path made = work / "case", made_truth = work / "truth.toml";
  const bool whole = generate(spec, made, made_truth, log) && fs::exists(made / "case.toml") && fs::exists(made / "recordings.csv") && fs::exists(made_truth);
  if (!whole) return false;
  for (const char* file : {"case.toml", "recordings.csv"}) sync_to_disk(made / file);
  rename_durably(made_truth, truth);
  if (!fs::exists(into)) rename_durably(made, into);  // last, so that every complete case has its truth
  return true;
}

}  // namespace

MakeSummary make_suite(const SuiteOptions& options, std::uint64_t seed, const fs::path& out, const Generate& generate,
                       const std::function<void(std::size_t, std::size_t, std::size_t)>& done) {
  options.validate();
  const SuiteLock lock(out, "make");
  const auto provenance = provenance_of(options, seed);
  if (reusable(out / "suite.json", provenance) == Reuse::nothing_there) {
    if (fs::exists(out / "cases"))
      throw InputError({.problem = "has cases, but no suite.json that names their suite", .suggestion = "use another --out", .file = out.string()});
    write_json(out / "suite.json", {{"cases", cases_of(options, seed).size()}, {"provenance", provenance.json()}});
  }
  const fs::path truths = out / "truth", work = out / "making";
  make_directory(truths);
  const auto cases = cases_of(options, seed);
  MakeSummary summary{.cases = cases.size()};
  for (std::size_t k = 0; k < cases.size(); ++k)
    if (const fs::path spec = truths / (case_name(k) + ".spec.toml"); !fs::exists(spec)) write_atomically(spec, draw_spec(k, cases[k], seed, options));
  if (!generate) return summary;
  make_directory(out / "cases");
  for (std::size_t k = 0; k < cases.size(); ++k) {
    if (done) done(k, cases.size(), summary.failed.size());
    const std::string name = case_name(k);
    const fs::path into = out / "cases" / name, truth = truths / (name + ".toml");
    if (fs::exists(into) && fs::exists(truth)) continue;
    fs::remove_all(work);
    make_directory(work);
    if (make_case(truths / (name + ".spec.toml"), work, into, truth, truths / (name + ".log"), generate))
      ++summary.made;
    else
      summary.failed.push_back(name);
  }
  fs::remove_all(work);
  if (done) done(cases.size(), cases.size(), summary.failed.size());
  return summary;
}

fs::path find_generator(const fs::path& given, const fs::path& program) {
  const std::string build = "build it with: cmake --build BUILD --target reference_generator, and give --generator PATH";
  if (!given.empty()) {
    if (fs::is_regular_file(given)) return fs::absolute(given);
    throw InputError({.problem = "no program there", .key = "--generator", .value = '"' + given.string() + '"', .suggestion = build});
  }
  const fs::path beside = program.parent_path();
  std::vector<std::string> looked;
  for (const fs::path& place : {beside / generator_name, beside / "../tests/proof" / generator_name, beside / CALOMEL_LIBEXEC_FROM_BIN / generator_name}) {
    if (fs::is_regular_file(place)) return fs::canonical(place);
    looked.push_back(place.lexically_normal().string());
  }
  throw InputError({.problem = "the program that makes the records, reference_generator, is not found (looked for " + join(looked) + ")", .suggestion = build});
}

Generate generate_by(const fs::path& generator, int threads) {
  return [generator, threads](const fs::path& spec, const fs::path& into, const fs::path& truth, const fs::path& log) {
    const std::vector<std::string> words{spec.string(), into.string(), "--truth", truth.string(), "--threads", std::to_string(threads)};
    return run_child(generator, words, log) == 0;
  };
}

std::vector<std::string> cases_in(const fs::path& directory) {
  const std::string suggestion = "make a suite first: calomel challenge make --seed S --out " + directory.string();
  if (!fs::is_directory(directory)) throw InputError({.problem = "there is no such directory", .suggestion = suggestion, .file = directory.string()});
  std::vector<std::string> names;
  if (fs::is_directory(directory / "cases"))
    for (const auto& entry : fs::directory_iterator(directory / "cases"))
      if (fs::exists(entry.path() / "case.toml")) names.push_back(entry.path().filename().string());
  if (names.empty()) throw InputError({.problem = "there is no case in cases/", .suggestion = suggestion, .file = directory.string()});
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace calomel::challenge
