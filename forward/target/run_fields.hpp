#pragma once
/// fields.exo of a run that may be cut off and gone on with.
#include <filesystem>
#include <optional>

#include "forward/mesh/exodus_fields.hpp"
#include "forward/mesh/mesh.hpp"
#include "forward/solver/explicit_solver.hpp"

namespace calomel {

/// Fields of the first condition of a run.
class RunFields {
 public:
  /// Every `interval` [s]; hooks itself into `options`, of which it and `mesh` outlive the run.
  RunFields(std::filesystem::path path, const Mesh& mesh, double interval, SolveOptions& options);
  RunFields(const RunFields&) = delete;
  RunFields& operator=(const RunFields&) = delete;

  /// The condition is finished.
  void commit();
  /// The run was stopped: the fields so far remain for the one that goes on.
  void leave();

 private:
  [[nodiscard]] bool committed() const;
  std::filesystem::path path_;
  const Mesh& mesh_;
  std::optional<ExodusFieldWriter> writer_;
};

}  // namespace calomel
