// What the documentation promises and a program can check: the generated page is current, links lead somewhere, every work
// that is cited stands in references.bib, includes follow the layers, and the case file of the walk-through is one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "apps/case_reference.hpp"
#include "apps/inputs/study_case.hpp"
#include "base/artefact.hpp"

namespace calomel {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

const fs::path root = CALOMEL_SOURCE_DIR;

/// README.md and its neighbours, and everything below docs/ and examples/.
std::vector<fs::path> pages() {
  std::vector<fs::path> all;
  for (const auto& entry : fs::directory_iterator(root))
    if (entry.path().extension() == ".md") all.push_back(entry.path());
  for (const char* folder : {"docs", "examples"})
    if (fs::exists(root / folder))
      for (const auto& entry : fs::recursive_directory_iterator(root / folder))
        if (entry.path().extension() == ".md") all.push_back(entry.path());
  std::sort(all.begin(), all.end());
  return all;
}

/// The page without fenced blocks and code between backticks.
std::string prose(const std::string& text) {
  std::istringstream in(text);
  std::string out;
  bool fenced = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("```")) {
      fenced = !fenced;
      continue;
    }
    if (!fenced) out += std::regex_replace(line, std::regex("`[^`]*`"), "code") + '\n';
  }
  return out;
}

/// The names by which headings of a page are linked to: small letters, spaces as hyphens, without punctuation.
std::set<std::string> anchors(const std::string& text) {
  std::set<std::string> all;
  std::istringstream in(text);
  bool fenced = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("```")) fenced = !fenced;
    if (fenced || !line.starts_with('#')) continue;
    line = std::regex_replace(line.substr(line.find_first_not_of('#')), std::regex(R"(\]\([^)]*\))"), "");
    std::string name;
    for (const char c : line.substr(line.find_first_not_of(' '))) {
      const auto u = static_cast<unsigned char>(c);
      if (std::isalnum(u) || c == '-' || c == '_' || u > 127) name += char(std::tolower(u));
      if (c == ' ') name += '-';
    }
    all.insert(name);
  }
  return all;
}

/// Targets of [text](target) that name no existing file, or no heading of an existing page; links to the web are left alone.
std::vector<std::string> broken_links(const std::string& text, const fs::path& folder) {
  std::vector<std::string> broken;
  const std::string plain = prose(text);
  const std::regex link(R"(\]\(([^)\s]+)\))");
  for (std::sregex_iterator it(plain.begin(), plain.end(), link), end; it != end; ++it) {
    std::string target = (*it)[1];
    if (target.starts_with("http://") || target.starts_with("https://")) continue;
    const auto hash = target.find('#');
    const std::string part = hash == std::string::npos ? "" : target.substr(hash + 1);
    target = target.substr(0, hash);
    if (!target.empty() && !fs::exists(folder / target))
      broken.push_back((*it)[1]);
    else if (!part.empty() && (target.empty() || target.ends_with(".md")) && !anchors(target.empty() ? text : read_text(folder / target)).contains(part))
      broken.push_back((*it)[1]);
  }
  return broken;
}

/// Keys of "@article{KEY," in a bibliography.
std::set<std::string> keys_of(const std::string& bibliography) {
  std::set<std::string> keys;
  const std::regex entry(R"(@\w+\{([^,\s]+),)");
  for (std::sregex_iterator it(bibliography.begin(), bibliography.end(), entry), end; it != end; ++it) keys.insert((*it)[1]);
  return keys;
}

/// Keys of [@KEY] in a page that are not in the bibliography.
std::vector<std::string> unknown_citations(const std::string& text, const std::set<std::string>& known) {
  std::vector<std::string> unknown;
  const std::string plain = prose(text);
  const std::regex citation(R"(@([A-Za-z]+\d{4}[a-z]?))");
  for (std::sregex_iterator it(plain.begin(), plain.end(), citation), end; it != end; ++it)
    if (!known.contains((*it)[1])) unknown.push_back((*it)[1]);
  return unknown;
}

/// All ```toml blocks of a page, one after another.
std::string case_file_in(const std::string& text) {
  std::istringstream in(text);
  std::string out;
  bool inside = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("```")) {
      inside = line == "```toml";
      continue;
    }
    if (inside) out += line + '\n';
  }
  return out;
}

/// Layers from the lowest up; a file may include what stands in its own layer and below.
const std::vector<std::string> house{"base", "forward", "inverse", "uq", "apps"};
/// Those of apps/.
const std::vector<std::string> rooms{"apps/inputs", "apps/presentation", "apps/report", "apps/pipeline", "apps/challenge"};
const std::vector<std::string> report_rooms{"apps/report/data", "apps/report/parts", "apps/report/sections"};

/// "FILE includes INCLUDED" for every include of a file at `path` that leads up.
std::vector<std::string> upward_includes(const std::string& path, const std::string& text, const std::vector<std::string>& layers) {
  const auto layer_of = [&](const std::string& file) {
    return std::find_if(layers.begin(), layers.end(), [&](const std::string& folder) { return file.starts_with(folder + '/'); });
  };
  std::vector<std::string> upward;
  const std::regex include(R"rx(#include "([^"]+)")rx");
  for (std::sregex_iterator it(text.begin(), text.end(), include), end; it != end; ++it) {
    const std::string included = (*it)[1];
    if (const auto layer = layer_of(included); layer != layers.end() && layer > layer_of(path)) upward.push_back(path + " includes " + included);
  }
  return upward;
}

/// Numbers of the lines that are longer than `.clang-format` allows, in characters.
std::vector<std::size_t> long_lines(const std::string& text) {
  constexpr std::ptrdiff_t column_limit = 160;
  std::vector<std::size_t> all;
  std::istringstream in(text);
  std::size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (std::count_if(line.begin(), line.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }) > column_limit) all.push_back(number);
  }
  return all;
}

TEST(Layout, LinesAreNoLongerThanItsFileAllows) {
  ASSERT_THAT(read_text(root / ".clang-format"), ::testing::HasSubstr("ColumnLimit: 160"));
  for (const char* folder : {"base", "forward", "inverse", "uq", "apps", "tests"})
    for (const auto& entry : fs::recursive_directory_iterator(root / folder))
      if (const auto type = entry.path().extension(); type == ".cpp" || type == ".hpp")
        EXPECT_THAT(long_lines(read_text(entry.path())), IsEmpty()) << entry.path() << ": run clang-format -i on it";
}

TEST(Layout, LongLinesAreFound) { EXPECT_THAT(long_lines("short\n" + std::string(161, 'x') + "\n" + std::string(160, 'x')), ElementsAre(2u)); }

TEST(CaseReference, IsWhatTheGeneratorWrites) {
  EXPECT_EQ(read_text(root / "docs" / "case_reference.md"), case_reference()) << "run: build/release/apps/case_reference > docs/case_reference.md";
}

TEST(CaseReference, HasAHeadingForEveryTableAndMechanism) {
  const std::string page = case_reference();
  for (const char* heading : {"## `[geometry]`", "## `[material.mercury]`", "## `[[sensor]]`", "## `[enc]`", "### `bubbly_liquid`", "### `static_pressure`"})
    EXPECT_THAT(page, ::testing::HasSubstr(heading));
  EXPECT_THAT(page, ::testing::HasSubstr("| `load.profile.decay` | m | `0.13` | > 0 |"));
}

TEST(Links, LeadToFilesThatExist) {
  ASSERT_GE(pages().size(), 5u);
  for (const auto& page : pages()) EXPECT_THAT(broken_links(read_text(page), page.parent_path()), IsEmpty()) << page;
}

TEST(Links, ToAMissingFileAreFound) {
  EXPECT_THAT(broken_links("[a](CMakeLists.txt) ![b](nowhere.png) [c](https://example.org/x) `[d](code)`\n```\n[e](fenced)\n```\n[f](gone.md#part)", root),
              ElementsAre("nowhere.png", "gone.md#part"));
}

TEST(Links, ToAMissingHeadingAreFound) {
  EXPECT_THAT(broken_links("# What `it` does, on 1 mm\n[a](#what-it-does-on-1-mm) [b](#what-else) [c](README.md#by-hand) [d](README.md#by-foot)", root),
              ElementsAre("#what-else", "README.md#by-foot"));
}

TEST(Layers, IncludeNothingAboveThem) {
  std::size_t files = 0;
  for (const auto& folder : house)
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const auto kind = entry.path().extension();
      if (kind != ".hpp" && kind != ".cpp") continue;
      const std::string path = fs::relative(entry.path(), root).generic_string(), text = read_text(entry.path());
      EXPECT_THAT(upward_includes(path, text, house), IsEmpty());
      EXPECT_THAT(upward_includes(path, text, rooms), IsEmpty());
      EXPECT_THAT(upward_includes(path, text, report_rooms), IsEmpty());
      ++files;
    }
  EXPECT_GT(files, 200u);
}

TEST(Layers, AnIncludeThatLeadsUpIsFound) {
  EXPECT_THAT(upward_includes("apps/inputs/a.hpp", "#include \"apps/pipeline/b.hpp\"\n#include \"apps/inputs/c.hpp\"\n#include \"forward/d.hpp\"\n", rooms),
              ElementsAre("apps/inputs/a.hpp includes apps/pipeline/b.hpp"));
  EXPECT_THAT(upward_includes("forward/a.cpp", "#include \"inverse/b.hpp\"\n#include \"base/c.hpp\"\n", house),
              ElementsAre("forward/a.cpp includes inverse/b.hpp"));
}

TEST(Citations, AreInTheBibliography) {
  const auto known = keys_of(read_text(root / "docs" / "references.bib"));
  ASSERT_GE(known.size(), 10u);
  for (const auto& page : pages()) EXPECT_THAT(unknown_citations(read_text(page), known), IsEmpty()) << page;
}

TEST(Citations, OfUnknownWorksAreFound) { EXPECT_THAT(unknown_citations("[@A2000; @B2001]", {"A2000"}), ElementsAre("B2001")); }

TEST(WalkThrough, IsACaseThatTheProgramReads) {
  const auto folder = fs::temp_directory_path() / ("calomel_docs_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  write_atomically(folder / "case.toml", case_file_in(read_text(root / "docs" / "how-to" / "your_own_target.md")));
  const auto study = StudyCase::read(folder / "case.toml", {});
  EXPECT_EQ(study.parameters().size(), 3u);
  EXPECT_TRUE(study.recordings.has_value());
  fs::remove_all(folder);
}

}  // namespace
}  // namespace calomel
