#pragma once
/// Meshes for other programs: what `kind = "mesh"` reads back.
#include <filesystem>

#include "forward/mesh/mesh.hpp"

namespace calomel {

/// Element sets "steel" and "mercury" with the nodes of wetted faces shared, node sets "symmetry_x", "_y", "_z", side sets
/// "outer", "wetted", "rear", "loaded", as far as they hold anything. Elements in mesh order, double precision. In the
/// Abaqus file the type is C3D8 and numbers have at most 20 characters, so that the last digit of a small coordinate may be
/// rounded. Errors: InputError when the file cannot be written.
void write_abaqus_mesh(const Mesh& mesh, const std::filesystem::path& path);
void write_exodus_mesh(const Mesh& mesh, const std::filesystem::path& path);
/// By the ending, as read_mesh_file takes it. Errors: InputError on another ending.
void write_mesh(const Mesh& mesh, const std::filesystem::path& path);

}  // namespace calomel
