#pragma once
/// The data of the report that come from the case and from the model, not from the artefacts.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "forward/mesh/mesh.hpp"
#include "forward/parameter.hpp"

namespace calomel {

/// Quadrilaterals for the three-dimensional picture.
struct ReportSurface {
  std::vector<Vec3> vertices;                      ///< [m]
  std::vector<std::array<std::int32_t, 4>> quads;  ///< indices into `vertices`
  [[nodiscard]] bool empty() const { return quads.empty(); }
};

/// A sensor of the case and its place in the mesh.
struct ReportSensor {
  std::string name;
  Vec3 declared{};          ///< position in the case file [m]
  Vec3 placed{};            ///< position at which the simulation reads it [m]
  Vec3 direction{};         ///< direction of the measured strain, unit vector
  double moved = 0;         ///< distance from declared to placed [m]
  double gauge_length = 0;  ///< [m]
};

/// The case as the report shows it. None of this is in the artefacts.
struct ReportInput {
  std::string case_name;
  std::string case_file;              ///< path in the user's words, for the commands that the page suggests
  Json options = Json::object();      ///< resolved options of the case, by table
  std::vector<Parameter> parameters;  ///< in declared order, with bounds, key, nominal value and unit
  std::string unit = "strain";        ///< unit of the data; strain is shown in microstrain, any other unit as it is
  double time_end = 0;                ///< end of the simulation [s]; long simulations are shown in ms or s
  ReportSurface outer;                ///< outer steel surface; empty for an external model
  ReportSurface wetted;               ///< mercury surface; may be empty
  std::vector<ReportSensor> sensors;
  std::string load_policy;                 ///< a sentence: how p0 follows the parameters
  std::optional<double> deposited_energy;  ///< [J]
  std::optional<double> slice_thickness;   ///< thickness of the slice that holds the energy, in plane strain [m]
  std::uint64_t seed = 1;
  std::vector<std::string> warnings;
};

}  // namespace calomel
