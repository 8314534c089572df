#include "forward/mesh/mesh_file.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"

namespace calomel {

std::string lower_case(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
  if (first == std::string_view::npos) return "";
  std::string s(text.substr(first, last - first + 1));
  for (char& c : s)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return s;
}

std::string MeshFile::element_text(std::size_t element) const {
  return fmt::format("element {}", element_label[element]) + (element_line.empty() ? "" : fmt::format(" (line {})", element_line[element]));
}

MeshFormat mesh_format(const std::filesystem::path& path) {
  const std::string ending = lower_case(path.extension().string());
  if (ending == ".inp") return MeshFormat::abaqus;
  for (const char* exodus : {".exo", ".e", ".ex2", ".exoii", ".g", ".gen"})
    if (ending == exodus) return MeshFormat::exodus;
  throw InputError({.problem = "the ending gives the format of a mesh file",
                    .key = "file",
                    .value = '"' + path.filename().string() + '"',
                    .range = ".exo, .e, .ex2, .exoII, .g, .gen for Exodus II, .inp for Abaqus",
                    .suggestion = "convert it, e.g. with meshio"});
}

MeshFile read_mesh_file(const std::filesystem::path& path) { return mesh_format(path) == MeshFormat::abaqus ? read_abaqus_mesh(path) : read_exodus_mesh(path); }

}  // namespace calomel
