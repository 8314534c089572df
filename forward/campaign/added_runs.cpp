#include "forward/campaign/added_runs.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>
#include <sstream>

#include "base/errors.hpp"
#include "base/identity.hpp"
#include "base/netcdf_file.hpp"
#include "base/parallel.hpp"
#include "base/provenance.hpp"
#include "forward/campaign/campaign.hpp"

namespace calomel {

namespace {

/// One solver run that is not in the journal.
struct Task {
  std::size_t run = 0;
  bool fine = false;
};

std::vector<float> column(const std::vector<KeptRun>& runs, std::size_t values, bool fine) {
  std::vector<float> all;
  all.reserve(runs.size() * values);
  for (const auto& [r, asked_by] : runs) {
    const bool there = fine ? r.fine && r.fine->done : r.working.done;
    if (there)
      all.insert(all.end(), (fine ? r.fine->mean : r.working.mean).begin(), (fine ? r.fine->mean : r.working.mean).end());
    else
      all.insert(all.end(), values, std::nanf(""));
  }
  return all;
}

RunRecord record_of(const std::vector<double>& values, std::size_t run, std::size_t count, int status, const std::string& message) {
  RunRecord r{.done = status == 0};
  if (r.done)
    r.mean.assign(values.begin() + std::ptrdiff_t(run * count), values.begin() + std::ptrdiff_t((run + 1) * count));
  else
    r.message = message;
  return r;
}

KeptRun* find(std::vector<KeptRun>& runs, const std::vector<double>& theta) {
  const auto at = std::find_if(runs.begin(), runs.end(), [&](const KeptRun& k) { return k.run.theta == theta; });
  return at == runs.end() ? nullptr : &*at;
}

/// Runs of an earlier file of the same model that others than `method` asked for.
std::vector<KeptRun> of_others(const std::filesystem::path& path, const Provenance& provenance, const ModelShape& shape, const std::string& method) {
  if (!std::filesystem::exists(path)) return {};
  if (identity_of(Json::parse(NetcdfReader(path).attribute("provenance"))) != provenance.identity()) return {};
  std::vector<std::string> names;
  std::vector<KeptRun> kept;
  for (auto& k : read_added_runs(path, shape.values(), names)) {
    std::erase(k.asked_by, method);
    if (!k.asked_by.empty()) kept.push_back(std::move(k));
  }
  return kept;
}

}  // namespace

AddedRuns::AddedRuns(const ForwardModel& working, const ForwardModel* fine, const Provenance& provenance, const std::filesystem::path& directory)
    : working_(working), fine_(fine), provenance_(std::make_shared<const Provenance>(provenance)), journal_(directory / "added_runs.journal", provenance) {}

std::size_t AddedRuns::key(std::span<const double> theta, bool fine) {
  std::uint64_t h = 14695981039346656037ull;
  const auto mix = [&](std::uint8_t byte) { h = (h ^ byte) * 1099511628211ull; };
  for (const double t : theta) {
    std::uint8_t bytes[sizeof t];
    std::memcpy(bytes, &t, sizeof t);
    for (const auto b : bytes) mix(b);
  }
  mix(fine);
  return h;
}

std::vector<AddedRun> AddedRuns::run(const Eigen::MatrixXd& thetas, const std::vector<bool>& with_fine, int threads, const Progress& progress,
                                     const std::atomic<bool>* stop) {
  expect(std::size_t(thetas.cols()) == with_fine.size(), "every point says whether it is run on the finer mesh");
  std::vector<AddedRun> runs(with_fine.size());
  std::vector<Task> tasks;
  for (const bool fine : {true, false})  // the costly ones first
    for (std::size_t i = 0; i < runs.size(); ++i) {
      runs[i].theta.assign(thetas.col(Eigen::Index(i)).data(), thetas.col(Eigen::Index(i)).data() + thetas.rows());
      if (fine && !(fine_ && with_fine[i])) continue;
      if (fine) runs[i].fine.emplace();
      if (const auto at = key(runs[i].theta, fine); journal_.contains(at))
        (fine ? *runs[i].fine : runs[i].working) = journal_.read(at), ++reused_;
      else
        tasks.push_back({i, fine});
    }
  std::mutex lock;
  std::size_t done = 0;
  parallel_for(tasks.size(), threads, [&](std::size_t k) {
    if (stop && stop->load()) return;
    AddedRun& r = runs[tasks[k].run];
    RunRecord record = evaluate_run(tasks[k].fine ? *fine_ : working_, r.theta, false);
    journal_.append(key(r.theta, tasks[k].fine), record);
    (tasks[k].fine ? *r.fine : r.working) = std::move(record);
    const std::lock_guard guard(lock);
    ++done, ++made_;
    if (progress) progress(done, tasks.size());
  });
  if (done < tasks.size()) throw Interrupted();
  all_.insert(all_.end(), runs.begin(), runs.end());
  return runs;
}

void AddedRuns::write(const std::filesystem::path& directory, const std::string& method) const {
  const ModelShape& shape = working_.shape();
  if (all_.empty()) return;
  const auto path = directory / "added_runs.nc";
  std::vector<KeptRun> runs = of_others(path, *provenance_, shape, method);
  for (const auto& r : all_) {
    KeptRun* same = find(runs, r.theta);
    if (!same) runs.push_back({r, {}}), same = &runs.back();
    if (r.fine) same->run.fine = r.fine;
    if (std::find(same->asked_by.begin(), same->asked_by.end(), method) == same->asked_by.end()) same->asked_by.push_back(method);
  }
  std::vector<double> theta;
  std::vector<int> working, fine;
  std::vector<std::string> names, message, asked_by;
  for (const auto& p : shape.parameters) names.push_back(p.name);
  bool any_fine = has_fine();
  for (const auto& [r, methods] : runs) {
    theta.insert(theta.end(), r.theta.begin(), r.theta.end());
    working.push_back(r.working.done ? 0 : 1), fine.push_back(!r.fine ? 2 : r.fine->done ? 0 : 1);
    message.push_back(r.working.done ? r.fine ? r.fine->message : "" : r.working.message);
    asked_by.push_back(join(methods, " "));
    any_fine = any_fine || r.fine;
  }
  NetcdfWriter file(path);
  file.attribute("provenance", provenance_->json().dump());
  file.dimension("run", runs.size());
  file.dimension("parameter", names.size());
  if (shape.conditions.size() > 1) file.dimension("condition", shape.conditions.size());
  file.dimension("sensor", shape.sensors.size());
  file.dimension("time", shape.times.size());
  file.variable("parameter", {"parameter"}, names);
  if (shape.conditions.size() > 1) file.variable("condition", {"condition"}, shape.conditions);
  file.variable("sensor", {"sensor"}, shape.sensors);
  file.variable("time", {"time"}, shape.times, {{"units", "s"}});
  file.variable("theta", {"run", "parameter"}, theta, {{"long_name", "parameters of each run, in natural units"}});
  file.variable("asked_by", {"run"}, asked_by, {{"long_name", "calibrations that asked for the run, a space between them"}});
  file.flags("status", {"run"}, working, std::vector<std::string>{"done", "failed"});
  file.flags("status_fine", {"run"}, fine, std::vector<std::string>{"done", "failed", "not_asked"});
  file.variable("message", {"run"}, message);
  std::vector<std::string> dims{"run", "sensor", "time"};
  if (shape.conditions.size() > 1) dims.insert(dims.begin() + 1, "condition");
  const std::string units = shape.unit == "strain" ? "1" : shape.unit;
  file.variable("strain", dims, column(runs, shape.values(), false), {{"units", units}, {"long_name", "ensemble mean on the case's mesh"}});
  if (any_fine) file.variable("strain_fine", dims, column(runs, shape.values(), true), {{"units", units}, {"long_name", "ensemble mean with half the element size"}});
  file.commit();
}

std::vector<KeptRun> read_added_runs(const std::filesystem::path& path, std::size_t values, std::vector<std::string>& names) {
  std::vector<KeptRun> runs;
  if (!std::filesystem::exists(path)) return runs;
  const NetcdfReader file(path);
  names = file.strings("parameter");
  const auto theta = file.doubles("theta"), working = file.doubles("strain");
  const auto status = file.integers("status"), status_fine = file.integers("status_fine");
  const auto message = file.strings("message"), asked_by = file.has("asked_by") ? file.strings("asked_by") : std::vector<std::string>(status.size());
  const auto fine = file.has("strain_fine") ? file.doubles("strain_fine") : std::vector<double>{};
  if (working.size() != status.size() * values) throw InputError({.problem = path.string() + " holds histories of another length than this case's"});
  const auto n = std::ptrdiff_t(names.size());
  for (std::size_t i = 0; i < status.size(); ++i) {
    const auto at = theta.begin() + std::ptrdiff_t(i) * n;
    KeptRun k{{.theta = {at, at + n}, .working = record_of(working, i, values, status[i], message[i])}, {}};
    if (!fine.empty() && status_fine[i] != 2) k.run.fine = record_of(fine, i, values, status_fine[i], message[i]);
    std::istringstream words(asked_by[i]);
    for (std::string word; words >> word;) k.asked_by.push_back(word);
    runs.push_back(std::move(k));
  }
  return runs;
}

}  // namespace calomel
