#include "forward/campaign/campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>

#include "base/artefact.hpp"
#include "base/netcdf_file.hpp"
#include "base/parallel.hpp"
#include "base/provenance.hpp"
#include "forward/campaign/archive.hpp"
#include "forward/campaign/archive_writer.hpp"
#include "forward/campaign/journal.hpp"

namespace calomel {

namespace {

std::string point_text(const ModelShape& shape, std::span<const double> theta) {
  std::string text;
  for (std::size_t i = 0; i < theta.size(); ++i) text += (i ? ", " : "") + shape.parameters[i].name + " = " + number_text(theta[i]);
  return text;
}

/// Why a prediction cannot be kept; empty when it can.
std::string fault(const ModelShape& shape, const Prediction& p) {
  const auto n = shape.values();
  if (p.mean.size() != n) return fmt::format("the model gave {} values, {} are expected", p.mean.size(), n);
  if (!p.energy_slope.empty() && p.energy_slope.size() != n) return fmt::format("the model gave {} energy slopes, {} are expected", p.energy_slope.size(), n);
  if (!p.scatter.empty() && p.scatter.size() != n) return fmt::format("the model gave {} scatters, {} are expected", p.scatter.size(), n);
  if (!p.pulses.empty() && p.pulses.size() != n * p.energies.size())
    return fmt::format("the model gave {} values of single pulses, {} are expected", p.pulses.size(), n * p.energies.size());
  for (std::size_t i = 0; i < n; ++i)
    if (!std::isfinite(float(p.mean[i]))) {
      const auto sensor = i / shape.times.size() % shape.sensors.size();
      return fmt::format("the value at sensor {}, time {:g} s is not finite", shape.sensors[sensor], shape.times[i % shape.times.size()]);
    }
  return "";
}

std::vector<float> single(const std::vector<double>& values) { return {values.begin(), values.end()}; }

/// Whether a finished archive of this identity stands. Errors: InputError when one of another does.
bool archive_stands(const std::filesystem::path& directory, const Provenance& provenance) {
  const auto file = directory / "campaign.nc";
  if (!std::filesystem::exists(file)) {
    (void)reusable(directory / "campaign.json", provenance);  // a summary of other settings is not written over
    return false;
  }
  const auto text = NetcdfReader(file).attribute("provenance");
  expect_same_provenance(Json::parse(text, nullptr, false).is_object() ? Json::parse(text) : Json::object(), provenance, file);
  return true;
}

void write_summary(const std::filesystem::path& directory, const CampaignSummary& s, const CampaignOptions& options, const std::vector<std::string>& messages,
                   const Json& floor, const Provenance& provenance) {
  Json failures = Json::array();
  for (std::size_t i = 0; i < messages.size() && failures.size() < 20; ++i)
    if (!messages[i].empty()) failures.push_back({{"run", i}, {"message", messages[i]}});
  Json json{{"runs", s.runs},
            {"completed", s.completed},
            {"failed", s.failed},
            {"reused", s.reused},
            {"wall_s", s.wall_s},
            {"trusted", s.status == ExitStatus::done},
            {"message", s.message},
            {"allowed_failures", options.allowed_failures},
            {"design", options.design},
            {"measure", designs().get(options.design).measure},
            {"first_failures", failures}};
  if (!floor.is_null()) json["floor"] = floor;
  json["provenance"] = provenance.json();
  write_json(directory / "campaign.json", json);
}

/// The floor that `source` gives, if any; why it cannot is added to `message`.
std::optional<RepeatabilityFloor> ask(const FloorSource& source, std::string& message) {
  if (!source) return std::nullopt;
  try {
    return source();
  } catch (const NumericsError& e) {
    message += fmt::format("; {}", e.what());
    return std::nullopt;
  }
}

/// What campaign.json tells of the floor, null when nothing: the one given, else the one that it tells already.
Json floor_to_tell(const std::optional<RepeatabilityFloor>& floor, const std::filesystem::path& summary) {
  if (floor) return floor_json(*floor);
  return std::filesystem::exists(summary) ? read_json(summary).value("floor", Json()) : Json();
}

/// Counts, verdict and sentence from the runs' messages (empty where done).
void judge(CampaignSummary& s, const std::vector<std::string>& messages, double allowed) {
  s.runs = messages.size();
  s.failed = std::size_t(std::count_if(messages.begin(), messages.end(), [](const auto& m) { return !m.empty(); }));
  s.completed = s.runs - s.failed;
  s.message = fmt::format("{} of {} runs completed", s.completed, s.runs);
  if (s.failed > 0) {
    const auto first = std::find_if(messages.begin(), messages.end(), [](const auto& m) { return !m.empty(); });
    s.message += fmt::format(", {} failed, the first (run {}): {}", s.failed, first - messages.begin(), *first);
  }
  if (double(s.failed) > allowed * double(s.runs)) {
    s.status = ExitStatus::not_to_be_trusted;
    s.message += fmt::format("; more than the allowed {:g} % failed: narrow the parameters' bounds, or see message(run) in campaign.nc", 100 * allowed);
  }
}

}  // namespace

RunRecord evaluate_run(const ForwardModel& model, std::span<const double> theta, bool keep_pulses) {
  RunRecord record;
  try {
    Prediction p = model.evaluate(theta);
    record.message = p.ok ? fault(model.shape(), p) : p.message.empty() ? "the model gave no reason" : p.message;
    record.done = record.message.empty();
    if (!record.done) return record;
    record.mean = single(p.mean);
    record.energy_slope = single(p.energy_slope);
    record.scatter = single(p.scatter);
    if (keep_pulses) record.pulses = std::move(p.pulses), record.energies = std::move(p.energies);
  } catch (const InputError&) {
    throw;
  } catch (const Interrupted&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    record = {.message = fmt::format("{} (at {})", e.what(), point_text(model.shape(), theta))};
  }
  return record;
}

Json identity_options(const CampaignOptions& options) {
  Json json = echo(options);
  for (const char* no_run_depends_on_it : {"allowed_failures", "floor"}) json.erase(no_run_depends_on_it);
  return json;
}

Eigen::MatrixXd design_points(const std::string& design, std::span<const Parameter> parameters, std::size_t runs, std::uint64_t seed) {
  if (parameters.empty())
    throw InputError({.problem = "a campaign needs at least one parameter to vary, the case has none",
                      .key = "parameter",
                      .suggestion = "add [parameter.NAME] with min and max"});
  Eigen::MatrixXd points = designs().get(design, "campaign.design").points(parameters.size(), runs, seed);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const auto& p = parameters[std::size_t(i)];
    points.row(i) = (p.min + (p.max - p.min) * points.row(i).array()).min(p.max).max(p.min);
  }
  return points;
}

CampaignSummary run_campaign(const ForwardModel& model, const CampaignOptions& options, std::uint64_t seed, int threads, const Provenance& provenance,
                             const std::filesystem::path& directory, const CampaignProgress& progress, const std::atomic<bool>* stop, const FloorSource& floor_source) {
  expect(provenance.seed == seed, "the provenance of a campaign names its seed");
  const auto began = std::chrono::steady_clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(); };
  const auto& shape = model.shape();
  const auto runs = std::size_t(options.runs);
  const Eigen::MatrixXd theta = design_points(options.design, shape.parameters, runs, seed);
  const auto journal_file = directory / "campaign.journal";
  CampaignSummary summary;

  // 1. A finished campaign is reused.
  if (archive_stands(directory, provenance)) {
    const auto messages = NetcdfReader(directory / "campaign.nc").strings("message");
    expect(messages.size() == runs, "an archive of this identity has the runs of the options");
    judge(summary, messages, options.allowed_failures);
    summary.reused = runs;
    const Json floor = floor_to_tell(ask(floor_source, summary.message), directory / "campaign.json");
    summary.wall_s = seconds();
    write_summary(directory, summary, options, messages, floor, provenance);
    std::filesystem::remove(journal_file);  // left by a kill after the archive stood
    return summary;
  }

  // 2. Finished runs come from the journal, the others are run.
  Journal journal(journal_file, provenance);
  std::vector<std::size_t> open;
  std::size_t failed = 0;
  for (std::size_t i = 0; i < runs; ++i)
    if (!journal.contains(i))
      open.push_back(i);
    else
      failed += !journal.read(i).done;
  summary.reused = runs - open.size();
  std::size_t finished = summary.reused;
  std::mutex lock;
  const auto report = [&] {
    if (progress) progress(finished, failed, runs);
  };
  report();
  parallel_for(open.size(), threads, [&](std::size_t k) {
    if (stop && stop->load()) return;
    const auto i = open[k];
    const RunRecord record = evaluate_run(model, {theta.col(Eigen::Index(i)).data(), std::size_t(theta.rows())}, options.keep_pulses);
    journal.append(i, record);
    const std::lock_guard guard(lock);
    ++finished, failed += !record.done;
    report();
  });
  if (journal.size() < runs) throw Interrupted();

  // 3. The floor; a kill in it loses none of the runs. Then the archive is assembled in run order, and the journal has served.
  std::string no_floor;
  const auto floor = ask(floor_source, no_floor);
  const auto messages = write_archive(directory / "campaign.nc", shape, options.design, theta, journal, floor ? &*floor : nullptr, provenance);
  judge(summary, messages, options.allowed_failures);
  summary.message += no_floor;
  summary.wall_s = seconds();
  write_summary(directory, summary, options, messages, floor ? floor_json(*floor) : Json(), provenance);
  journal.remove();
  return summary;
}

void set_campaign_aside(const std::filesystem::path& directory, const Provenance& now) {
  const auto journal = directory / "campaign.journal";
  if (std::filesystem::exists(journal) && journal_identity(journal) != now.identity()) set_aside(journal);
  set_aside(directory / "campaign.json");
  set_aside(directory / "campaign.nc");
}

}  // namespace calomel
