#pragma once
/// One case file read once, whole: every table that any verb of this program takes, each held against its ranges.
#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/case_file.hpp"
#include "forward/campaign/campaign.hpp"
#include "forward/external/external_case.hpp"
#include "forward/forward_case.hpp"
#include "forward/line/line_case.hpp"
#include "forward/surrogate/options.hpp"
#include "inverse/enc/enc.hpp"
#include "inverse/map/map.hpp"
#include "inverse/posterior/posterior_fit.hpp"
#include "inverse/data/recordings.hpp"
#include "inverse/spe/options.hpp"
#include "uq/diagnosis/diagnosis.hpp"
#include "uq/posterior_options.hpp"
#include "uq/power/power.hpp"
#include "uq/sampler/sampler.hpp"
#include "uq/sensitivity/sensitivity.hpp"

namespace calomel {

/// `[study]` of a case file.
struct StudyOptions {
  std::vector<std::string> stages{"campaign", "train", "calibrate", "report"};
  std::vector<std::string> methods{"enc"};

  template <class V>
  void visit(V& v) {
    v("stages", stages,
      {.doc = "what `calomel study` does, in this order",
       .choices = {"simulate", "campaign", "train", "calibrate", "sample", "sensitivity", "report"},
       .least_size = 1});
    v("methods", methods,
      {.doc = "how its calibrate stage calibrates, one after another; all = enc, spe, map", .choices = {"enc", "spe", "map", "all"}, .least_size = 1});
  }
};

/// `[fields]` of a case file.
struct FieldOptions {
  std::optional<double> interval;
  template <class V>
  void visit(V& v) {
    v("interval", interval, {.unit = "s", .range = above(0), .doc = "time between pictures in fields.exo (default: end / 50)"});
  }
};

struct StudyCase {
  CaseFile file;
  ForwardCase forward;                   ///< as it is by default where the model is another
  std::optional<LineCase> line;          ///< the model is a line
  std::optional<ExternalCase> external;  ///< the model is outside of the program
  CampaignOptions campaign;
  FloorOptions floor;
  SurrogateOptions surrogate;
  EncOptions enc;
  SpeOptions spe;
  MapOptions map;
  EmulatorOptions emulator;
  ErrorOptions errors;
  PosteriorOptions posterior;
  SamplerOptions sampler;
  DiagnosisOptions diagnosis;
  PowerOptions power;
  SensitivityOptions sensitivity;
  std::optional<RecordingOptions> recordings;  ///< empty when the case has no [recordings]
  StudyOptions study;
  FieldOptions fields;

  /// Errors: InputError with file, line and column for whatever is wrong, a table that nobody knows included.
  static StudyCase read(const std::filesystem::path& path, std::span<const std::string> overrides);

  /// `case.name`, or the file's; when a run ends [s]; and the unit of the records, of whichever model.
  [[nodiscard]] const std::string& name() const { return line ? line->name : external ? external->name : forward.name; }
  [[nodiscard]] double time_end() const {
    return line ? line->time.end : external ? external->time.start + external->time.step * std::max(external->time.count - 1, 0) : forward.time.end;
  }
  [[nodiscard]] std::string unit() const { return line ? line->unit : external ? external->unit : forward.sensor_unit; }
  /// The case's own parameters, of whichever model.
  [[nodiscard]] const std::vector<Parameter>& parameters() const { return line ? line->parameters : external ? external->parameters : forward.parameters; }
  /// Whether the model is a log density, for samplers alone.
  [[nodiscard]] bool is_log_density() const { return external && external->is_log_density(); }
  /// Whether the model is the explicit solver on a mesh.
  [[nodiscard]] bool on_mesh() const { return !line && !external; }
  /// Mechanisms that have a table, by name: where there are any, a diagnosis is offered these alone.
  [[nodiscard]] std::vector<std::string> listed_mechanisms() const;
  /// The resolved case, table by table.
  [[nodiscard]] Json echo() const;
  /// The tables on which the strains of a run depend; of the parameters what the design sees, not the priors.
  [[nodiscard]] Json model_options() const;
  /// Hashes of the files that the model reads, by the case's key.
  [[nodiscard]] std::map<std::string, std::string> model_inputs() const;
  /// Path of the recordings. Errors: InputError when the case has no [recordings].
  [[nodiscard]] std::filesystem::path recordings_file() const;
  /// The recordings, held against the sensors that the model has; adds to `warnings` which sensors have no record; what the file itself gives cause to warn of
  /// is in the recordings'. Errors: InputError with its place; see read_recordings, match_sensors.
  [[nodiscard]] Recordings matched_recordings(std::span<const std::string> sensors, std::vector<std::string>& warnings) const;
};

/// All tables of a case file, those of stages to come included.
const std::vector<std::string>& known_tables();

}  // namespace calomel
