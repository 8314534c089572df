#pragma once
/// Meshes as files give them: Exodus II and Abaqus input, before anything is known about steel and mercury.
#include <filesystem>
#include <map>
#include <string>

#include "forward/mesh/topology.hpp"

namespace calomel {

/// Nodes, hexahedra and named sets of a file. Names of sets are in lower case.
struct MeshFile {
  std::filesystem::path path;
  std::vector<Vec3> nodes;                      ///< in the file's unit of length
  std::vector<std::int64_t> node_label;         ///< number of a node in the file
  std::vector<std::array<NodeId, 8>> elements;  ///< corner i + 2j + 4k as in Mesh
  std::vector<std::int64_t> element_label;      ///< number of an element in the file
  std::vector<std::int32_t> element_line;       ///< its line; empty for a binary file
  std::map<std::string, std::vector<std::int32_t>> element_sets;
  std::map<std::string, std::vector<NodeId>> node_sets;
  std::map<std::string, std::vector<FaceId>> side_sets;
  std::vector<std::string> notes;  ///< what was left aside

  /// "element 12 (line 40)"
  [[nodiscard]] std::string element_text(std::size_t element) const;
  /// Line of an element, 0 where the file has none.
  [[nodiscard]] int line_of(std::size_t element) const { return element_line.empty() ? 0 : element_line[element]; }
};

/// ASCII letters in lower case, blanks around cut off.
std::string lower_case(std::string_view text);

enum class MeshFormat { abaqus, exodus };
/// By the ending: .inp Abaqus, .exo .e .ex2 .exoII .g .gen Exodus II. Errors: InputError on another.
MeshFormat mesh_format(const std::filesystem::path& path);

/// Errors: InputError naming file and line, block or element, for whatever cannot be read or is no linear hexahedron.
MeshFile read_mesh_file(const std::filesystem::path& path);

/// Abaqus input, flat: *NODE, *ELEMENT (C3D8, C3D8R, C3D8I), *ELSET and *NSET with GENERATE and sets of sets, *SURFACE of
/// elements and sides S1 to S6, *SOLID SECTION (its material's name then names a set as well). What a mesh does not need is
/// passed over. Errors: as above; *PART, *INSTANCE, *INCLUDE and generated nodes or elements are refused.
MeshFile read_abaqus_mesh(const std::filesystem::path& path);

/// Exodus II with 32 or 64 bit numbers: blocks of HEX or HEX8, element, node and side sets. Sets without a name are called
/// block_ID, element_set_ID, node_set_ID and side_set_ID.
MeshFile read_exodus_mesh(const std::filesystem::path& path);

}  // namespace calomel
