#include "inverse/data/history_file.hpp"

namespace calomel {

HistoryFile::HistoryFile(const std::filesystem::path& path, const Problem& problem, const Provenance& provenance)
    : problem_(problem), file_(path), units_(problem.unit == "strain" ? "1" : problem.unit) {
  const ModelShape& shape = problem.shape;
  file_.attribute("provenance", provenance.json().dump());
  file_.dimension("condition", shape.conditions.size());
  file_.dimension("sensor", shape.sensors.size());
  file_.dimension("time", shape.times.size());
  file_.dimension("record_time", problem.time.size());
  file_.variable("condition", {"condition"}, shape.conditions);
  file_.variable("sensor", {"sensor"}, shape.sensors);
  file_.variable("time", {"time"}, shape.times, {{"units", "s"}});
  file_.variable("record_time", {"record_time"}, problem.time, {{"units", "s"}});
}

void HistoryFile::history(const std::string& name, std::span<const double> values, const std::string& what) {
  if (!values.empty()) file_.variable(name, {"condition", "sensor", "time"}, values, {{"units", units_}, {"long_name", what}});
}

void HistoryFile::commit() {
  const BandArrays bands = band_arrays(problem_);
  const auto record = [&](const std::string& name, const std::vector<double>& values, const std::string& what) {
    file_.variable(name, {"condition", "sensor", "record_time"}, values, {{"units", units_}, {"long_name", what}});
  };
  record("record_mean", bands.mean, "mean of the recorded pulses");
  record("band_low", bands.low, "lower end of the 95 % band");
  record("band_high", bands.high, "upper end of the 95 % band");
  file_.commit();
}

}  // namespace calomel
