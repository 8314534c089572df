#include "forward/campaign/added_runs.hpp"

#include <cmath>
#include <cstring>
#include <mutex>

#include "base/netcdf_file.hpp"
#include "base/parallel.hpp"
#include "forward/campaign/campaign.hpp"

namespace calomel {

namespace {

/// One solver run that is not in the journal.
struct Task {
  std::size_t run = 0;
  bool fine = false;
};

std::vector<float> column(const std::vector<AddedRun>& runs, std::size_t values, bool fine) {
  std::vector<float> all;
  all.reserve(runs.size() * values);
  for (const auto& r : runs) {
    const bool there = fine ? r.fine && r.fine->done : r.working.done;
    if (there)
      all.insert(all.end(), (fine ? r.fine->mean : r.working.mean).begin(), (fine ? r.fine->mean : r.working.mean).end());
    else
      all.insert(all.end(), values, std::nanf(""));
  }
  return all;
}

}  // namespace

AddedRuns::AddedRuns(const ForwardModel& working, const ForwardModel* fine, const Provenance& provenance, const std::filesystem::path& directory)
    : working_(working), fine_(fine), provenance_(provenance), journal_(directory / "added_runs.journal", provenance) {}

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

void AddedRuns::write(const std::filesystem::path& directory) const {
  const ModelShape& shape = working_.shape();
  if (all_.empty()) return;
  std::vector<double> theta;
  std::vector<int> working, fine;
  std::vector<std::string> names, message;
  for (const auto& p : shape.parameters) names.push_back(p.name);
  for (const auto& r : all_) {
    theta.insert(theta.end(), r.theta.begin(), r.theta.end());
    working.push_back(r.working.done ? 0 : 1), fine.push_back(!r.fine ? 2 : r.fine->done ? 0 : 1);
    message.push_back(r.working.done ? r.fine ? r.fine->message : "" : r.working.message);
  }
  NetcdfWriter file(directory / "added_runs.nc");
  file.attribute("provenance", provenance_.json().dump());
  file.dimension("run", all_.size());
  file.dimension("parameter", names.size());
  if (shape.conditions.size() > 1) file.dimension("condition", shape.conditions.size());
  file.dimension("sensor", shape.sensors.size());
  file.dimension("time", shape.times.size());
  file.variable("parameter", {"parameter"}, names);
  if (shape.conditions.size() > 1) file.variable("condition", {"condition"}, shape.conditions);
  file.variable("sensor", {"sensor"}, shape.sensors);
  file.variable("time", {"time"}, shape.times, {{"units", "s"}});
  file.variable("theta", {"run", "parameter"}, theta, {{"long_name", "parameters of each run, in natural units"}});
  file.flags("status", {"run"}, working, std::vector<std::string>{"done", "failed"});
  file.flags("status_fine", {"run"}, fine, std::vector<std::string>{"done", "failed", "not_asked"});
  file.variable("message", {"run"}, message);
  std::vector<std::string> dims{"run", "sensor", "time"};
  if (shape.conditions.size() > 1) dims.insert(dims.begin() + 1, "condition");
  const std::string units = shape.unit == "strain" ? "1" : shape.unit;
  file.variable("strain", dims, column(all_, shape.values(), false), {{"units", units}, {"long_name", "ensemble mean on the case's mesh"}});
  if (has_fine())
    file.variable("strain_fine", dims, column(all_, shape.values(), true), {{"units", units}, {"long_name", "ensemble mean with half the element size"}});
  file.commit();
}

}  // namespace calomel
