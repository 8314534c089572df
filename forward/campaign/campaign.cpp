#include "forward/campaign/campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "base/artefact.hpp"
#include "base/netcdf_file.hpp"
#include "base/provenance.hpp"
#include "forward/campaign/archive.hpp"
#include "forward/campaign/archive_writer.hpp"

namespace calomel {

namespace {

/// Whether a finished archive of this identity exists. Errors: InputError if one of another identity exists.
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
std::optional<RepeatabilityFloor> floor_of(const FloorSource& source, std::string& message) {
  if (!source) return std::nullopt;
  try {
    return source();
  } catch (const NumericsError& e) {
    message += fmt::format("; {}", e.what());
    return std::nullopt;
  }
}

/// The floor in campaign.json, null without one: the one given, else the one that is there already.
Json floor_to_report(const std::optional<RepeatabilityFloor>& floor, const std::filesystem::path& summary) {
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

Json identity_options(const CampaignOptions& options) {
  Json json = echo(options);
  for (const char* no_run_depends_on_it : {"allowed_failures", "floor"}) json.erase(no_run_depends_on_it);
  return json;
}

Eigen::MatrixXd design_points(const std::string& design, std::span<const Parameter> parameters, std::size_t runs, std::uint64_t seed) {
  if (parameters.empty())
    throw InputError({.problem = "a campaign needs at least one parameter to vary, and the case has none",
                      .key = "parameter",
                      .suggestion = "add [parameter.NAME] with min and max"});
  Eigen::MatrixXd points = designs().get(design, "campaign.design").points(parameters.size(), runs, seed);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const auto& p = parameters[std::size_t(i)];
    points.row(i) = (p.min + (p.max - p.min) * points.row(i).array()).min(p.max).max(p.min);
  }
  return points;
}

CampaignSummary run_campaign(const ModelShape& shape, const CampaignOptions& options, std::uint64_t seed, const Provenance& provenance,
                             const std::filesystem::path& directory, const std::function<Runs&()>& runs_of_model, const CampaignProgress& progress,
                             const FloorSource& floor_source) {
  expect(provenance.seed == seed, "the provenance of a campaign names its seed");
  const auto began = std::chrono::steady_clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(); };
  const auto count = std::size_t(options.runs);
  const Eigen::MatrixXd theta = design_points(options.design, shape.parameters, count, seed);
  CampaignSummary summary;

  // 1. A finished campaign is reused.
  if (archive_stands(directory, provenance)) {
    const auto messages = NetcdfReader(directory / "campaign.nc").strings("message");
    expect(messages.size() == count, "an archive of this identity has the runs of the options");
    judge(summary, messages, options.allowed_failures);
    summary.reused = count;
    const Json floor = floor_to_report(floor_of(floor_source, summary.message), directory / "campaign.json");
    summary.wall_s = seconds();
    write_summary(directory, summary, options, messages, floor, provenance);
    return summary;
  }

  // 2. Runs that are held are taken, the others are made.
  Runs& runs = runs_of_model();
  std::vector<RunRequest> requests;
  std::size_t failed_before = 0;
  for (std::size_t i = 0; i < count; ++i) {
    RunRequest r = request_at(shape.parameters, {theta.col(Eigen::Index(i)).data(), std::size_t(theta.rows())});
    r.wanted.pulses = options.keep_pulses;
    if (runs.store().holds(r)) {
      ++summary.reused;
      failed_before += !runs.store().read(r).done;
    }
    requests.push_back(std::move(r));
  }
  const std::size_t reused_failures = runs.failed();
  const auto report = [&](std::size_t made, std::size_t) {
    if (progress) progress(summary.reused + made, failed_before + runs.failed() - reused_failures, count);
  };
  if (summary.reused == count) report(0, 0);
  runs.make(requests, report);

  // 3. The floor; a kill in it loses none of the runs. Then the archive is assembled in run order.
  std::string no_floor;
  const auto floor = floor_of(floor_source, no_floor);
  const auto messages = write_archive(
      directory / "campaign.nc", shape, options.design, theta, [&](std::size_t i) { return runs.store().read(requests[i]); }, floor ? &*floor : nullptr,
      provenance);
  judge(summary, messages, options.allowed_failures);
  if (const auto lost = std::count_if(requests.begin(), requests.end(), [&](const auto& r) { return runs.store().lost(r); }); lost > 0)
    summary.message += fmt::format("; {} of them got no response: --fresh requests them again", lost);
  summary.message += no_floor;
  summary.wall_s = seconds();
  write_summary(directory, summary, options, messages, floor ? floor_json(*floor) : Json(), provenance);
  return summary;
}

void set_campaign_aside(const std::filesystem::path& directory) {
  set_aside(directory / "campaign.json");
  set_aside(directory / "campaign.nc");
}

}  // namespace calomel
