#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <set>
#include <unordered_map>

#include "base/errors.hpp"
#include "forward/mesh/file_order.hpp"
#include "forward/mesh/mesh_file.hpp"

namespace calomel {
namespace {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> words;
  for (std::size_t begin = 0;;) {
    const auto comma = line.find(',', begin);
    auto word = lower_case(std::string_view(line).substr(begin, comma == std::string::npos ? comma : comma - begin));
    if (word.size() >= 2 && word.front() == '"' && word.back() == '"') word = word.substr(1, word.size() - 2);
    words.push_back(std::move(word));
    if (comma == std::string::npos) break;
    begin = comma + 1;
  }
  while (!words.empty() && words.back().empty()) words.pop_back();  // a line may end with a comma
  return words;
}

std::optional<std::int64_t> whole_number(const std::string& word) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() ? std::optional(value) : std::nullopt;
}

/// Decimal, also with the D exponent of Fortran; NaN and infinity are read as such.
std::optional<double> decimal(std::string word) {
  std::replace(word.begin(), word.end(), 'd', 'e');
  if (word.starts_with('+')) word.erase(0, 1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() ? std::optional(value) : std::nullopt;
}

/// A keyword line: "*ELEMENT, TYPE=C3D8, ELSET=wall".
struct Keyword {
  std::string name;
  std::map<std::string, std::string> parameters;
  int line = 0;
  [[nodiscard]] std::string get(const std::string& key) const {
    const auto found = parameters.find(key);
    return found == parameters.end() ? "" : found->second;
  }
};

/// A number, or the name of another set, and the line that holds it; with a side for surfaces.
struct Entry {
  std::string word;
  int line;
  int face = -1;
};
using Sets = std::map<std::string, std::vector<Entry>>;

class AbaqusReader {
 public:
  explicit AbaqusReader(const std::filesystem::path& path) : in_(path) {
    mesh_.path = path;
    if (!in_ || !std::filesystem::is_regular_file(path)) fail(0, "the file does not exist", "check geometry.file; relative paths start at the case file");
  }

  MeshFile read() {
    std::string line;
    bool data_expected = false;
    for (int number = 1; std::getline(in_, line); ++number) {
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (line.starts_with("**") || line.find_first_not_of(" \t") == std::string::npos) continue;
      if (line.find('\0') != std::string::npos) fail(number, "this is no text", "Abaqus input is expected; Exodus II files end in .exo or .e");
      const auto first = line.find_first_not_of(" \t");
      if (line[first] == '*') {
        finish_element();
        begin(parse_keyword(line.substr(first + 1), number));
        data_expected = true;
      } else if (!data_expected) {
        fail(number, "a keyword that begins with * is expected before the first data", "is this Abaqus input?");
      } else {
        data(line, number);
      }
    }
    finish_element();
    if (in_.bad()) fail(0, "the file cannot be read to its end", "");
    if (mesh_.elements.empty()) fail(0, "the file holds no elements", "*ELEMENT, TYPE=C3D8 lists hexahedra");
    resolve();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(int line, const std::string& problem, const std::string& suggestion, const std::string& value = "",
                         const std::string& range = "") const {
    throw InputError({.problem = problem, .value = value, .range = range, .suggestion = suggestion, .file = mesh_.path.string(), .line = line});
  }

  /// Keyword and parameters; a list that goes on in the next line after a comma is refused.
  Keyword parse_keyword(const std::string& text, int number) const {
    if (const auto last = text.find_last_not_of(" \t"); last != std::string::npos && text[last] == ',')
      fail(number, "a keyword line that continues in the next line is not supported", "write it in one line");
    Keyword k;
    k.line = number;
    const auto words = split(text);
    k.name = words.empty() ? "" : words[0];
    for (std::size_t i = 1; i < words.size(); ++i) {
      const auto equals = words[i].find('=');
      auto value = equals == std::string::npos ? "" : lower_case(std::string_view(words[i]).substr(equals + 1));
      if (value.size() >= 2 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
      k.parameters[lower_case(std::string_view(words[i]).substr(0, equals))] = value;
    }
    return k;
  }

  void begin(Keyword k) {
    static const std::set<std::string> parts{"part", "instance", "assembly"};
    static const std::set<std::string> generated{"ngen", "nfill", "ncopy", "nmap", "elgen", "elcopy", "system"};
    static const std::set<std::string> ties{"tie", "equation", "mpc", "contact pair", "rigid body", "kinematic coupling", "coupling", "boundary"};
    if (parts.contains(k.name))
      fail(k.line, "parts and instances are not read",
           "write a flat file: in Abaqus/CAE set the model's attribute noPartsInputFile, or export the mesh as orphan mesh", "*" + k.name);
    if (k.name == "include") fail(k.line, "files within files are not read", "paste the included lines in place of this one", "*include");
    if (generated.contains(k.name)) fail(k.line, "nodes and elements that are generated are not read", "write every node and element out", "*" + k.name);
    if (ties.contains(k.name) && told_.insert(k.name).second)
      mesh_.notes.push_back(fmt::format("{}: *{} in line {} is not read: parts are joined by shared nodes, and geometry.sets names symmetry planes",
                                        mesh_.path.filename().string(), k.name, k.line));
    if (k.name == "element") {
      static const std::set<std::string> hexahedra{"c3d8", "c3d8r", "c3d8i"};
      const std::string type = k.get("type");
      if (!hexahedra.contains(type))
        fail(k.line, type.empty() ? "*ELEMENT has no TYPE" : "elements of this type are not read",
             type.starts_with("c3d") ? "mesh with linear hexahedra"
                                     : "leave them out of the file (mesh generators often write the faces and edges of a volume, too)",
             type.empty() ? "" : "TYPE=" + type, "C3D8, C3D8R, C3D8I");
      current_elset_ = k.get("elset");
    }
    if (k.name == "elset" || k.name == "nset") {
      set_name_ = k.get(k.name);
      if (set_name_.empty()) fail(k.line, fmt::format("*{} has no name", k.name), fmt::format("add {}=NAME", k.name));
      (k.name == "elset" ? elsets_ : nsets_)[set_name_];
      if (k.name == "nset" && !k.get("elset").empty()) nodes_of_elset_.push_back({set_name_, k.get("elset"), k.line});
    }
    if (k.name == "surface") {
      set_name_ = k.get("name");
      const std::string type = k.get("type");
      if (set_name_.empty()) fail(k.line, "*SURFACE has no NAME", "add NAME=...");
      if (!type.empty() && type != "element" && type != "node") fail(k.line, "a surface of this type is not read", "", "TYPE=" + type, "ELEMENT, NODE");
      (type == "node" ? nsets_ : surfaces_)[set_name_];
    }
    if (k.name == "solid section" && !k.get("elset").empty() && !k.get("material").empty()) sections_.push_back({k.get("material"), k.get("elset"), k.line});
    keyword_ = std::move(k);
  }

  void data(const std::string& line, int number) {
    if (keyword_.name == "node") return node(split(line), number);
    if (keyword_.name == "element") return element(split(line), number);
    if (keyword_.name == "elset") return entries(elsets_, split(line), number);
    if (keyword_.name == "nset") return entries(nsets_, split(line), number);
    if (keyword_.name != "surface") return;
    const auto words = split(line);
    if (keyword_.get("type") == "node") {
      nsets_[set_name_].push_back({words.empty() ? "" : words[0], number});
      return;
    }
    const auto side = words.size() == 2 && words[1].size() == 2 && words[1][0] == 's' ? file_order::face_of(file_order::abaqus_side, words[1][1] - '0') : -1;
    if (side < 0) fail(number, "an element (or element set) and one of its sides are expected", "", '"' + line + '"', "S1 to S6");
    surfaces_[set_name_].push_back({words[0], number, side});
  }

  void node(const std::vector<std::string>& words, int number) {
    const auto label = words.empty() ? std::nullopt : whole_number(words[0]);
    if (words.size() < 4 || !label) fail(number, "number, x, y and z of a node are expected", "three-dimensional coordinates are needed", join(words));
    Vec3 x{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto value = decimal(words[1 + k]);
      if (!value) fail(number, fmt::format("coordinate {} of node {} is no number", "xyz"[k], *label), "", words[1 + k]);
      if (!std::isfinite(*value))
        fail(number, fmt::format("coordinate {} of node {} is not finite", "xyz"[k], *label), "a finite number is expected", words[1 + k]);
      x[k] = *value;
    }
    if (!node_of_.try_emplace(*label, NodeId(mesh_.nodes.size())).second) fail(number, fmt::format("node {} is given twice", *label), "renumber the nodes");
    if (const auto set = keyword_.get("nset"); !set.empty()) nsets_[set].push_back({words[0], number});
    mesh_.nodes.push_back(x);
    mesh_.node_label.push_back(*label);
  }

  void element(const std::vector<std::string>& words, int number) {
    if (pending_.empty()) pending_line_ = number;
    for (const auto& w : words) {
      const auto value = whole_number(w);
      if (!value) fail(number, "whole numbers are expected: an element and its 8 nodes", "", w);
      pending_.push_back(*value);
    }
    if (pending_.size() > 9) fail(pending_line_, fmt::format("element {} has {} nodes", pending_[0], pending_.size() - 1), "", "", "8 nodes");
    if (pending_.size() < 9) return;
    if (!element_of_.try_emplace(pending_[0], std::int32_t(mesh_.elements.size())).second)
      fail(pending_line_, fmt::format("element {} is given twice", pending_[0]), "renumber the elements");
    std::array<std::int64_t, 8> labels{};
    std::copy(pending_.begin() + 1, pending_.end(), labels.begin());
    corners_.push_back(labels);
    if (!current_elset_.empty()) elsets_[current_elset_].push_back({std::to_string(pending_[0]), pending_line_});
    mesh_.elements.emplace_back();
    mesh_.element_label.push_back(pending_[0]);
    mesh_.element_line.push_back(pending_line_);
    pending_.clear();
  }
  void finish_element() const {
    if (!pending_.empty())
      fail(pending_line_, fmt::format("element {} has only {} nodes", pending_[0], pending_.size() - 1),
           "the file is cut short, or the element is no hexahedron", "", "8 nodes");
  }

  void entries(Sets& sets, const std::vector<std::string>& words, int number) {
    auto& set = sets[set_name_];
    if (!keyword_.parameters.contains("generate")) {
      for (const auto& w : words)
        if (!w.empty()) set.push_back({w, number});
      return;
    }
    std::array<std::int64_t, 3> range{0, 0, 1};
    bool good = words.size() == 2 || words.size() == 3;
    for (std::size_t i = 0; good && i < words.size(); ++i) {
      const auto value = whole_number(words[i]);
      good = value.has_value();
      if (good) range[i] = *value;
    }
    if (!good || range[2] < 1 || range[1] < range[0] || (range[1] - range[0]) / range[2] > 1 << 28)
      fail(number, "first, last and step are expected with GENERATE", "", join(words));
    for (auto i = range[0]; i <= range[1]; i += range[2]) set.push_back({std::to_string(i), number});
  }

  /// Members of `name`, sets within sets followed.
  template <class Id>
  std::vector<Id> members(const Sets& sets, const std::unordered_map<std::int64_t, Id>& known, const std::string& name, const char* kind,
                          std::vector<std::string> within = {}) const {
    std::vector<Id> out;
    within.push_back(name);
    for (const auto& entry : sets.at(name))
      if (const auto label = whole_number(entry.word)) {
        const auto found = known.find(*label);
        if (found == known.end()) fail(entry.line, fmt::format("set \"{}\" names {} {}, which is not in the file", name, kind, *label), "", entry.word);
        out.push_back(found->second);
      } else {
        if (!sets.contains(entry.word)) unknown_set(sets, entry, kind);
        if (std::find(within.begin(), within.end(), entry.word) != within.end())
          fail(entry.line, fmt::format("set \"{}\" contains itself", entry.word), "", entry.word);
        const auto inner = members(sets, known, entry.word, kind, within);
        out.insert(out.end(), inner.begin(), inner.end());
      }
    return out;
  }
  [[noreturn]] void unknown_set(const Sets& sets, const Entry& entry, const char* kind) const {
    std::vector<std::string> names;
    for (const auto& [name, unused] : sets) names.push_back(name);
    fail(entry.line, fmt::format("there is no {} set of this name", kind), name_suggestion(entry.word, names), '"' + entry.word + '"');
  }

  void resolve() {
    for (std::size_t e = 0; e < corners_.size(); ++e)
      for (std::size_t a = 0; a < 8; ++a) {
        const auto found = node_of_.find(corners_[e][a]);
        if (found == node_of_.end())
          fail(mesh_.element_line[e], fmt::format("element {} names node {}, which is not in the file", mesh_.element_label[e], corners_[e][a]),
               "the file is cut short, or its *NODE block is missing");
        mesh_.elements[e][file_order::corner[a]] = found->second;
      }
    for (const auto& [name, entries] : elsets_) mesh_.element_sets[name] = members(elsets_, element_of_, name, "element");
    for (const auto& [name, entries] : nsets_) mesh_.node_sets[name] = members(nsets_, node_of_, name, "node");
    for (const auto& [material, elset, line] : sections_) {
      if (!mesh_.element_sets.contains(elset)) unknown_set(elsets_, {elset, line}, "element");
      if (elsets_.contains(material)) continue;  // a set of its own
      auto& set = mesh_.element_sets[material];
      const auto& section = mesh_.element_sets[elset];
      set.insert(set.end(), section.begin(), section.end());
    }
    for (const auto& [name, elset, line] : nodes_of_elset_) {
      if (!mesh_.element_sets.contains(elset)) unknown_set(elsets_, {elset, line}, "element");
      for (const auto e : mesh_.element_sets[elset])
        for (const NodeId n : mesh_.elements[std::size_t(e)]) mesh_.node_sets[name].push_back(n);
    }
    for (const auto& [name, entries] : surfaces_)
      for (const auto& entry : entries) {
        auto& set = mesh_.side_sets[name];
        if (const auto label = whole_number(entry.word)) {
          const auto found = element_of_.find(*label);
          if (found == element_of_.end())
            fail(entry.line, fmt::format("surface \"{}\" names element {}, which is not in the file", name, *label), "", entry.word);
          set.push_back(6 * found->second + entry.face);
        } else {
          if (!mesh_.element_sets.contains(entry.word)) unknown_set(elsets_, entry, "element");
          for (const auto e : mesh_.element_sets[entry.word]) set.push_back(6 * e + entry.face);
        }
      }
  }

  struct Alias {
    std::string name, elset;
    int line;
  };

  std::ifstream in_;
  MeshFile mesh_;
  Keyword keyword_;
  std::string current_elset_, set_name_;
  std::vector<std::int64_t> pending_;  ///< an element that goes on in the next line
  int pending_line_ = 0;
  std::vector<std::array<std::int64_t, 8>> corners_;
  std::unordered_map<std::int64_t, NodeId> node_of_;
  std::unordered_map<std::int64_t, std::int32_t> element_of_;
  Sets elsets_, nsets_, surfaces_;
  std::vector<Alias> sections_, nodes_of_elset_;
  std::set<std::string> told_;
};

}  // namespace

MeshFile read_abaqus_mesh(const std::filesystem::path& path) { return AbaqusReader(path).read(); }

}  // namespace calomel
