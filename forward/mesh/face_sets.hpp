#pragma once
/// What the named sets of a mesh file make of its elements and free faces.
#include "forward/mesh/assemble_mesh.hpp"
#include "forward/mesh/geometry_options.hpp"
#include "forward/mesh/mesh_file.hpp"

namespace calomel {

/// Steel or mercury for each element. Errors: InputError on "sets.steel" or "sets.mercury" for a name that is not there, on
/// the file for elements in neither or in both.
std::vector<Region> materials_of(const MeshFile& mesh, const SetOptions& sets);

/// Kinds of the free faces, and the planes of symmetry among them.
struct FreeFaces {
  std::vector<FaceId> face;  ///< free faces in order
  std::vector<BoundaryKind> kind;
  std::vector<bool> symmetric;  ///< by FaceId of the whole file
  std::vector<MirrorPlane> mirrors;
  bool plane_strain = false;
};

/// Errors: InputError on "sets.KEY" for names that are not there, faces inside of the body, symmetry planes that are not normal to their axis, faces
/// in two sets; on the file for mercury that lies bare.
FreeFaces free_faces(const MeshFile& mesh, const SetOptions& sets, std::span<const Region> region, std::span<const FaceId> match);

}  // namespace calomel
