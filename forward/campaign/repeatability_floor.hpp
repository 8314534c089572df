#pragma once
/// The repeatability floor as it is kept: in floor.json, in campaign.json and as arrays of campaign.nc. forward/repeatability.hpp measures it.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "forward/model.hpp"

namespace calomel {

class NetcdfWriter;

/// `[floor]` of a case file.
struct FloorOptions {
  int members = 8;
  double mesh_jitter = 0.15;
  double window = 50e-6;
  int single_runs = 4;
  double single_run_shift = 1e-6;
  bool finer_mesh = true;
  int finer_elements = 200000;
  bool precisions = true;
  template <class V>
  void visit(V& v) {
    v("members", members,
      {.range = between(3, 1000), .doc = "ensemble means on jittered meshes, with the viscosity halved and doubled and other pulse energies"});
    v("mesh_jitter", mesh_jitter, {.range = between(0, 0.3), .doc = "nodes move by up to this share of the shortest edge there"});
    v("window", window, {.unit = "s", .range = above(0), .doc = "stretch of the record over which the scatter is averaged"});
    v("single_runs", single_runs, {.range = between(0, 1000), .doc = "single runs whose parameters differ by single_run_shift, at least 2; 0 leaves them out"});
    v("single_run_shift", single_run_shift, {.range = between(0, 0.1), .doc = "greatest relative change of each parameter in those"});
    v("finer_mesh", finer_mesh, {.doc = "compare with the ensemble mean on elements of half the size"});
    v("finer_elements", finer_elements, {.range = between(1, 1e9), .doc = "greatest mesh on which that is done"});
    v("precisions", precisions, {.doc = "compare single with double precision"});
  }
  void validate() const;
};

/// One jitter and what it changed.
struct FloorMember {
  double viscosity_factor = 1;  ///< 1/2, 1, 2 in turn
  double energy_shift = 0.5;    ///< the energies are the quantiles (i + shift) / m
  bool ok = true;
  std::string message;
};

/// What else moves the answer, beside the floor: relative root mean squares over the whole record.
struct FloorComparison {
  std::string name;              ///< "single_runs", "finer_mesh", "precision"
  std::string what;              ///< in words
  std::string message;           ///< why there are no numbers; empty when there are
  std::vector<double> relative;  ///< (condition, sensor) [-]; or empty
  double mean = 0, worst = 0;    ///< over `relative`
};

/// Scatter of the ensemble mean over the members.
struct RepeatabilityFloor {
  std::vector<FloorMember> members;
  std::vector<std::string> conditions, sensors;
  std::vector<double> window_begin, window_end;  ///< [s]
  std::vector<double> sd;                        ///< (condition, sensor, window): root mean square over the window of the sd over the members [-]
  std::vector<double> signal;                    ///< the same shape: root mean square of the members' mean [-]
  std::vector<double> relative;                  ///< (condition, sensor): whole record, sd over signal, both root mean squares [-]
  /// Largest over the sensors of `relative`, and their mean.
  double worst = 0, mean = 0;
  std::vector<FloorComparison> comparisons;
};

/// The floor as JSON, for floor.json and campaign.json.
Json floor_json(const RepeatabilityFloor& floor);
/// The floor of such a JSON. Errors: InputError when it is of another form.
RepeatabilityFloor read_floor(const Json& json);

/// Adds the floor to campaign.nc, whose dimensions `sensor` and, with several conditions, `condition` exist: floor_sd and floor_signal([condition,] sensor,
/// window) in `units`, floor_relative and a floor_NAME for each comparison ([condition,] sensor).
void write_floor(NetcdfWriter& file, const RepeatabilityFloor& floor, const std::string& units);

}  // namespace calomel
