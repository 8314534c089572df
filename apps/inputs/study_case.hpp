#pragma once
/// One case file read once, whole: every table that any verb of this program takes, each held against its ranges.
#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/case_file.hpp"
#include "forward/campaign/campaign.hpp"
#include "forward/simulation/simulator.hpp"
#include "forward/simulation/case_tables.hpp"
#include "forward/surrogate/options.hpp"
#include "inverse/enc/enc.hpp"
#include "inverse/map/map.hpp"
#include "inverse/posterior/posterior_setup.hpp"
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

struct StudyCase {
  CaseFile file;
  std::unique_ptr<Simulator> simulator;  ///< the true model
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

  /// `stop`: becomes true when the program is requested to stop; null: never. Errors: InputError with file, line and column for whatever is wrong, a table that
  /// nobody knows included.
  static StudyCase read(const std::filesystem::path& path, std::span<const std::string> overrides, const std::atomic<bool>* stop = nullptr);

  /// The case's own parameters.
  [[nodiscard]] const std::vector<Parameter>& parameters() const { return simulator->shape().parameters; }
  [[nodiscard]] const Capabilities& capabilities() const { return simulator->capabilities(); }
  /// Whether chains and sensitivities run the model itself: its runs are cheap, and the case has no [surrogate].
  [[nodiscard]] bool runs_the_model_itself() const { return capabilities().cheap_runs && !file.has("surrogate"); }
  /// The options that decide the posterior.
  [[nodiscard]] PosteriorSettings posterior_settings() const;
  [[nodiscard]] bool physical() const { return map.product == "physical"; }
  /// The resolved case, table by table.
  [[nodiscard]] Json echo() const;
  /// Path of the recordings. Errors: InputError when the case has no [recordings].
  [[nodiscard]] std::filesystem::path recordings_file() const;
  /// The recordings, compared with the sensors of the model; adds to `warnings` which sensors have no record; what the file itself gives cause to warn of
  /// is in the recordings'. Errors: InputError with its place; see read_recordings, match_sensors.
  [[nodiscard]] Recordings matched_recordings(std::vector<std::string>& warnings) const;
};

/// All tables of a case file, those of stages to come included.
const std::vector<std::string>& known_tables();

}  // namespace calomel
