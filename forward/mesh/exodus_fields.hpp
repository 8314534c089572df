#pragma once
/// Fields over the mesh as an Exodus II file, which ParaView, VisIt and Sierra read.
#include <filesystem>
#include <span>
#include <vector>

#include "forward/mesh/mesh.hpp"

namespace calomel {

/// Fields at one time. An empty span is a field that is not written; every step of a file has the same fields.
struct FieldStep {
  double time = 0;                           ///< [s]
  std::span<const Vec3> displacement;        ///< per node [m]: displacement_x, _y, _z
  std::span<const Vec3> velocity;            ///< per node [m/s]: velocity_x, _y, _z
  std::span<const double> pressure;          ///< per element, positive in compression [Pa]
  std::span<const double> effective_stress;  ///< per element, von Mises [Pa]
  std::span<const double> time_at_cutoff;    ///< per element, time that the liquid has spent at its cutoff so far [s]
};

/// Writes `path` + ".part" step by step; `commit()` renames it to `path`. Element blocks "steel" and "mercury" (in this
/// order, elements in mesh order within each), node sets "symmetry_x", "_y", "_z", side sets "outer", "wetted", "rear",
/// "loaded", as far as they hold anything. Single precision. As with netCDF, one writer at a time.
class ExodusFieldWriter {
 public:
  /// Errors: InputError when the file cannot be written. The mesh must outlive the writer.
  ExodusFieldWriter(std::filesystem::path path, const Mesh& mesh);
  /// Goes on with the ".part" that an earlier writer left behind, after its first `steps` steps; later ones are written over.
  /// Errors: InputError when there is no such file, or it is of another mesh, or holds fewer steps.
  ExodusFieldWriter(std::filesystem::path path, const Mesh& mesh, int steps);
  ~ExodusFieldWriter();
  ExodusFieldWriter(const ExodusFieldWriter&) = delete;
  ExodusFieldWriter& operator=(const ExodusFieldWriter&) = delete;

  /// Appends a step; times rise. Errors: InputError when the disk is full; contract failure when sizes or fields differ.
  void write_step(const FieldStep& step);
  /// Puts the steps so far on disk, from where they can be gone on with whatever becomes of this process.
  void flush();
  /// Closes the file and leaves it as ".part", to be gone on with.
  void leave();
  /// Closes the file and renames it to its path.
  void commit();

 private:
  void check(int status, const char* doing) const;
  void close();
  void number_elements();
  void write_mesh();
  void write_sets();
  void write_side_set(int id, const char* name, const std::vector<Face>& faces);
  void define_variables();

  std::filesystem::path path_, part_;
  const Mesh& mesh_;
  int id_ = -1;
  int steps_ = 0;
  bool begun_ = false;                              ///< this writer has written a step
  std::array<std::vector<std::int32_t>, 2> block_;  ///< elements of steel and of mercury
  std::vector<std::int32_t> position_;              ///< place of an element in the file, counted from 1
  std::array<bool, 5> written_{};                   ///< which fields the file has
};

}  // namespace calomel
