#include "apps/pipeline/stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>

#include "apps/interrupt.hpp"
#include "apps/progress.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"
#include "forward/campaign/archive.hpp"
#include "forward/surrogate/training.hpp"
#include "inverse/enc/enc.hpp"
#include "forward/surrogate/feasibility.hpp"

namespace calomel {

namespace {

/// Progress of a calibration on the display; stops the work when the user asked to.
class CalibrationDisplay {
 public:
  CalibrationDisplay(std::string method, bool quiet) : method_(std::move(method)), style_(progress_style(quiet)) {}
  void operator()(const std::string& what, std::size_t done, std::size_t total) {
    if (stop_requested()) throw Interrupted();
    if (what != what_) display_.reset(), display_.emplace(method_, what, style_, std::cerr), what_ = what;
    display_->update(done, total);
  }

 private:
  std::string method_, what_;
  ProgressDisplay::Style style_;
  std::optional<ProgressDisplay> display_;
};

}  // namespace

Stages::Stages(const CommandLine& command) : command_(command), study_(StudyCase::read(command.case_file, command.overrides)) {
  if (command.verb != "check" && command.verb != "report") make_directory(command.out);  // a place that cannot be written is told before the work
}

const BuiltInModel& Stages::model() {
  if (!model_)
    model_ = study_.file.locating([&] {
      const EnsembleOptions ensemble{.pulses = study_.campaign.pulses, .energy_sd = study_.campaign.pulse_energy_sd};
      const bool alone = command_.verb == "simulate" || command_.verb == "check";  // the other stages run evaluations side by side
      return std::make_unique<BuiltInModel>(study_.forward, ensemble, alone ? command_.threads : 1);
    });
  return *model_;
}

const Problem& Stages::problem() {
  if (!problem_) {
    std::vector<std::string> warnings;
    const auto recordings = study_.matched_recordings(model().shape().sensors, warnings);
    problem_ = study_.file.locating([&] { return make_problem(model().shape(), recordings, *study_.recordings); });
    warnings.insert(warnings.end(), problem_->warnings.begin(), problem_->warnings.end());
    for (const auto& w : warnings) say("warning: " + w);
  }
  return *problem_;
}

CalibrationProgress Stages::stage_progress(const std::string& stage) const {
  const auto display = std::make_shared<CalibrationDisplay>(stage, command_.quiet);
  return [display](const std::string& what, std::size_t done, std::size_t total) { (*display)(what, done, total); };
}

void Stages::say(const std::string& text) const {
  if (!command_.quiet) std::cerr << text << '\n';
}

std::vector<std::string> Stages::physics() {
  const auto d = model().describe();
  std::vector<std::string> lines{"load: " + policy_text(study_.forward.load)};
  if (d.deposited_energy > 0)
    lines.push_back(fmt::format("pulse: {:.4g} J deposited{}; regularising viscosity {:.4g} Pa s{}", d.deposited_energy,
                                model().mesh().plane_strain ? fmt::format(" in a slice {:.3g} mm thick", 1e3 * d.slice_thickness) : "", d.viscosity,
                                d.mesh_decides_viscosity ? " (decided by the mesh)" : ""));
  return lines;
}

Provenance Stages::campaign_provenance() const {
  Json options = study_.model_options();
  options["campaign"] = identity_options(study_.campaign);
  return {.stage = "campaign", .options = std::move(options), .seed = command_.seed, .inputs = study_.model_inputs()};
}

Provenance Stages::train_provenance() const {
  return {.stage = "train",
          .options = {{"surrogate", echo(study_.surrogate)}},
          .seed = command_.seed,
          .inputs = {{"campaign.nc", hash_file(command_.out / "campaign.nc")}}};
}

Provenance Stages::calibration_provenance(const std::string& method) const {
  if (method == "map") {
    Provenance p = posterior_provenance();
    p.stage = "map", p.options["map"] = echo(study_.map), p.options.erase("sampler");
    if (!study_.map.compare_with.empty() && std::filesystem::exists(nested_directory() / "map.json")) p.inputs["map.compare_with"] = hash_file(nested_directory() / "map.json");
    return p;
  }
  const bool spe = method == "spe";
  const std::string learnt_from = spe ? "campaign.nc" : "surrogate.nc";  // SPE learns from the campaign itself
  Provenance p{.stage = method,
               .options = {{method, spe ? echo(study_.spe) : echo(study_.enc)}, {"recordings", echo(*study_.recordings)}},
               .seed = command_.seed,
               .inputs = {{learnt_from, hash_file(command_.out / learnt_from)}, {"recordings", hash_file(study_.recordings_file())}}};
  if (((method == "enc" && study_.enc.mesh_correction) || (spe && study_.spe.mesh_correction)) && corrects_mesh()) {
    const Json posterior = posterior_provenance().options;
    for (const char* key : {"product", "emulator", "errors", "parameter"})
      if (posterior.contains(key)) p.options[key] = posterior[key];
  }
  return p;
}

bool Stages::to_be_set_aside(const Provenance& now, Asked asked) {
  const bool may = command_.fresh && begun_.insert(now.stage).second;
  if (may && asked == Asked::by_user) return true;
  try {
    return reusable(command_.out / (now.stage + ".json"), now) == Reuse::nothing_there && may;
  } catch (const InputError&) {
    if (!may) throw;
    return true;
  }
}

bool Stages::due(const Provenance& now, const std::vector<std::string>& files, Asked asked) {
  if (to_be_set_aside(now, asked))
    for (const auto& f : files) set_aside(command_.out / f);
  return !std::all_of(files.begin(), files.end(), [&](const auto& f) { return std::filesystem::exists(command_.out / f); });
}

ExitStatus Stages::campaign() { return campaign(Asked::by_user); }

ExitStatus Stages::campaign(Asked asked) {
  const auto provenance = campaign_provenance();
  const auto& m = model();
  if (to_be_set_aside(provenance, asked)) set_campaign_aside(command_.out);
  const bool finished = std::filesystem::exists(command_.out / "campaign.nc");
  if (!finished && asked == Asked::upstream) say("no finished campaign in " + command_.out.string() + ": running it first");
  CampaignSummary summary;
  {
    std::optional<ProgressDisplay> display(std::in_place, "campaign", "runs", progress_style(command_.quiet || finished), std::cerr);
    FloorSource floor;
    if (study_.campaign.floor && (asked == Asked::by_user || !finished)) floor = [&] {
      display.reset();
      need_floor();
      return read_floor(read_json(command_.out / "floor.json"));
    };
    summary = study_.file.locating([&] {
      return run_campaign(
          m, study_.campaign, command_.seed, command_.threads, provenance, command_.out, [&]() -> RunStore& { return run_store(); },
          [&](std::size_t done, std::size_t failed, std::size_t runs) { display->update(done, runs, failed ? fmt::format("{} failed", failed) : ""); },
          &stop_requested(), floor);
    });
  }
  if (asked == Asked::by_user || !finished)
    say(fmt::format("campaign: {}{}", summary.message, summary.reused ? fmt::format(" ({} reused)", summary.reused) : ""));
  return summary.status;
}

ExitStatus Stages::train() { return train(Asked::by_user); }

ExitStatus Stages::train(Asked asked) {
  const auto upstream = campaign(Asked::upstream);
  const auto provenance = train_provenance();
  if (!due(provenance, {"train.json", "surrogate.nc"}, asked)) {
    say("train: reused");
    return upstream;
  }
  if (asked == Asked::upstream) say("no trained surrogate in " + command_.out.string() + ": training it first");
  const auto training =
      study_.file.locating([&] { return run_training(read_archive(command_.out / "campaign.nc"), study_.surrogate, command_.seed, command_.threads); });
  training.surrogates.at(0)->save(command_.out / "surrogate.nc");
  write_train_json(command_.out / "train.json", training.summary, provenance);
  for (const auto& s : training.summary.surrogates)
    say(fmt::format("train: {} on {} runs, held out {}: R2 {:.3f}, mean absolute error {:.3g}", s.name, s.n_train, s.n_test, s.test.r2, s.test.mae));
  return upstream;
}

ExitStatus Stages::calibrate(const std::string& method) {
  (void)problem();  // before any long work, so that wrong recordings are told at once
  // The posterior makes what it needs by itself.
  const auto upstream = method == "map" ? ExitStatus::done : method == "spe" ? campaign(Asked::upstream) : train(Asked::upstream);
  const auto provenance = calibration_provenance(method);
  if (!due(provenance, {method + ".json", method + ".nc"}, Asked::by_user)) {
    say(method + ": reused");
    const auto before = read_json(command_.out / (method + ".json"));
    return worse(upstream, before.value("status", "") == "done" ? ExitStatus::done : ExitStatus::not_to_be_trusted);
  }
  const auto summary = calibrated_by(method, provenance);
  for (const auto& w : summary.warnings)  // those of the recordings were said when they were read
    if (std::find(problem().warnings.begin(), problem().warnings.end(), w) == problem().warnings.end()) say("warning: " + w);
  say(fmt::format("{}: {}", method, summary.message));
  return worse(upstream, summary.trusted() ? ExitStatus::done : ExitStatus::not_to_be_trusted);
}

Calibration Stages::calibrated_by(const std::string& method, const Provenance& provenance) {
  const auto progress = stage_progress(method);
  return study_.file.locating([&]() -> Calibration {
    if (method == "spe") return calibrate_spe(provenance, progress);
    if (method == "map") return calibrate_map(provenance, progress);
    const auto surrogate = load_surrogate(command_.out / "surrogate.nc");
    const Archive archive = read_archive(command_.out / "campaign.nc");
    return calibrate_enc(provenance, *surrogate, archive, progress);
  });
}

}  // namespace calomel
