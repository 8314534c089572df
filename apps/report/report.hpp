#pragma once
/// The report: one self-contained page (report.html) and, on request, every table and trace of it as CSV.
#include <array>
#include <cstdint>
#include <filesystem>
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

/// The part of the mesh that `faces` cover, with only the nodes that it needs.
ReportSurface report_surface(const Mesh& mesh, const std::vector<Face>& faces);

struct ReportSensor {
  std::string name;
  Vec3 declared{};          ///< as the case file gives it [m]
  Vec3 placed{};            ///< where the simulation reads it [m]
  Vec3 direction{};         ///< of the measured strain, unit vector
  double moved = 0;         ///< distance from declared to placed [m]
  double gauge_length = 0;  ///< [m]
};

/// What the app knows and the artefacts do not tell.
struct ReportInput {
  std::string case_name;
  std::string case_file;              ///< as the user gave it, for the commands that the page suggests
  Json options = Json::object();      ///< resolved options of the case, by table
  std::vector<Parameter> parameters;  ///< in declared order; bounds, key, nominal, unit
  std::string unit = "strain";        ///< of the data; strain is shown in microstrain, any other as it is
  double time_end = 0;                ///< of the simulation [s]: long ones are shown in ms or s
  ReportSurface outer;                ///< outer steel surface; empty for an outside model
  ReportSurface wetted;               ///< mercury surface; may be empty
  std::vector<ReportSensor> sensors;
  std::string load_policy;                 ///< in words, how p0 follows the parameters
  std::optional<double> deposited_energy;  ///< [J]
  std::optional<double> slice_thickness;   ///< in plane strain the energy is that of a slice [m]
  std::uint64_t seed = 1;
  std::vector<std::string> warnings;
};

/// Errors: InputError that names the folder and what is to be run first, where no artefact of any stage stands in it.
void expect_something_to_report(const std::filesystem::path& out_dir, const std::string& case_file);

/// Writes out_dir/report.html from the artefacts that stand in `out_dir` (campaign, train, simulate, enc, spe, map, posterior, diagnosis);
/// a section whose artefact is missing says so and names the command that makes it. The page loads nothing from
/// outside and stays below 10 MB: traces and surface are thinned as far as that needs.
/// Errors: InputError when there is no artefact at all, when one cannot be read, or when the page cannot be written.
void write_report(const std::filesystem::path& out_dir, const ReportInput& input);

/// Writes every table and trace, unthinned, to out_dir/report_csv/*.csv (comma, point, one header line; times in
/// seconds, strains in microstrain). Returns the paths. Errors: as write_report.
std::vector<std::filesystem::path> write_tables_csv(const std::filesystem::path& out_dir, const ReportInput& input);

}  // namespace calomel
