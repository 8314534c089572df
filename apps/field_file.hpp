#pragma once
/// Fields over time as Exodus II, single precision: what ParaView and VisIt open.
#include <filesystem>

#include "forward/mesh/mesh.hpp"
#include "forward/solver/explicit_solver.hpp"

namespace calomel {

/// `[fields]` of a case file.
struct FieldOptions {
  std::optional<double> interval;
  template <class V>
  void visit(V& v) {
    v("interval", interval, {.unit = "s", .range = above(0), .doc = "time between pictures in fields.exo (default: end / 50)"});
  }
};

/// Writes to `path` + ".part"; commit() renames. Blocks "steel" and "mercury"; nodal displacement [m] and velocity [m/s],
/// element pressure and effective stress [Pa]. Errors: InputError when the file cannot be written.
class FieldFile {
 public:
  FieldFile(std::filesystem::path path, const Mesh& mesh);
  ~FieldFile();
  FieldFile(const FieldFile&) = delete;
  FieldFile& operator=(const FieldFile&) = delete;

  void write(const FieldSnapshot& snapshot);
  void commit();

 private:
  std::filesystem::path path_, part_;
  int id_ = -1;
  int steps_ = 0;
  std::size_t nodes_ = 0;
  std::vector<std::vector<std::size_t>> blocks_;  ///< mesh elements of each block, in file order
};

}  // namespace calomel
