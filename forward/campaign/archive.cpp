#include "forward/campaign/archive.hpp"

#include <limits>

#include "base/netcdf_file.hpp"
#include "base/provenance.hpp"
#include "forward/campaign/archive_writer.hpp"
#include "forward/campaign/design.hpp"

namespace calomel {

namespace {

constexpr float absent = std::numeric_limits<float>::quiet_NaN();

/// (run, value) of one member of all records, NaN where a run has none; empty when no run has it.
std::vector<float> gather(const std::function<RunRecord(std::size_t)>& read, std::size_t runs, std::size_t values, std::vector<float> RunRecord::*member) {
  std::vector<float> all(runs * values, absent);
  bool any = false;
  for (std::size_t i = 0; i < runs; ++i) {
    const auto record = read(i);
    const auto& column = record.*member;
    if (column.empty()) continue;
    expect(column.size() == values, "all runs of a campaign have the same values");
    std::copy(column.begin(), column.end(), all.begin() + std::ptrdiff_t(i * values));
    any = true;
  }
  if (!any) all.clear();
  return all;
}

template <class Member>
auto of_parameters(const ModelShape& shape, Member member) {
  std::vector<std::decay_t<decltype(member(shape.parameters[0]))>> all;
  for (const auto& p : shape.parameters) all.push_back(member(p));
  return all;
}

}  // namespace

std::vector<std::string> write_archive(const std::filesystem::path& path, const ModelShape& shape, const std::string& design, const Eigen::MatrixXd& theta,
                                       const std::function<RunRecord(std::size_t)>& read, const RepeatabilityFloor* floor, const Provenance& provenance) {
  const std::size_t runs = std::size_t(theta.cols()), values = shape.values();
  std::vector<int> status(runs);
  std::vector<std::string> message(runs);
  std::vector<double> energies;
  for (std::size_t i = 0; i < runs; ++i) {
    auto record = read(i);
    status[i] = int(record.done ? RunStatus::done : RunStatus::failed);
    message[i] = std::move(record.message);
    if (record.pulses.empty()) continue;
    expect(energies.empty() || energies == record.energies, "all runs of a campaign have the same pulse energies");
    energies = std::move(record.energies);
  }

  NetcdfWriter file(path);
  file.attribute("title", "calomel campaign");
  file.attribute("design", design);
  file.attribute("measure", designs().get(design).measure);
  file.attribute("unit", shape.unit);
  file.attribute("provenance", provenance.json().dump());
  file.dimension("run", runs);
  file.dimension("parameter", shape.parameters.size());
  if (shape.conditions.size() > 1) file.dimension("condition", shape.conditions.size());
  file.dimension("sensor", shape.sensors.size());
  file.dimension("time", shape.times.size());
  if (!energies.empty()) file.dimension("pulse", energies.size());

  file.variable("parameter", {"parameter"}, of_parameters(shape, [](const Parameter& p) { return p.name; }));
  file.variable("parameter_key", {"parameter"}, of_parameters(shape, [](const Parameter& p) { return p.key; }));
  file.variable("parameter_min", {"parameter"}, of_parameters(shape, [](const Parameter& p) { return p.min; }));
  file.variable("parameter_max", {"parameter"}, of_parameters(shape, [](const Parameter& p) { return p.max; }));
  file.variable("parameter_nominal", {"parameter"}, of_parameters(shape, [](const Parameter& p) { return p.nominal.value_or(std::nan("")); }));
  if (shape.conditions.size() > 1) file.variable("condition", {"condition"}, shape.conditions);
  file.variable("sensor", {"sensor"}, shape.sensors);
  file.variable("time", {"time"}, shape.times, {{"units", "s"}});
  file.variable("theta", {"run", "parameter"}, std::span<const double>(theta.data(), std::size_t(theta.size())),
                {{"long_name", "parameters of each run, in natural units"}});
  const std::vector<std::string> meanings{"done", "failed"};
  file.flags("status", {"run"}, status, meanings);
  file.variable("message", {"run"}, message);

  std::vector<std::string> dims{"run", "sensor", "time"};
  if (shape.conditions.size() > 1) dims.insert(dims.begin() + 1, "condition");
  const std::string units = shape.unit == "strain" ? "1" : shape.unit;
  const auto put = [&](const std::string& name, std::vector<float> all, const std::string& what) {
    if (!all.empty()) file.variable(name, dims, all, {{"units", units}, {"long_name", what}});
  };
  auto mean = gather(read, runs, values, &RunRecord::mean);
  if (mean.empty()) mean.assign(runs * values, absent);  // every run failed
  put("strain", std::move(mean), "ensemble mean over the pulse energies");
  put("energy_slope", gather(read, runs, values, &RunRecord::energy_slope), "finite difference of the strain by relative pulse energy");
  put("scatter", gather(read, runs, values, &RunRecord::scatter), "standard deviation of the single pulses about mean and slope");
  if (!energies.empty()) {
    file.variable("pulse_energy", {"pulse"}, energies, {{"units", "1"}, {"long_name", "relative energy of each pulse"}});
    dims.insert(dims.begin() + 1, "pulse");
    put("pulse_strain", gather(read, runs, energies.size() * values, &RunRecord::pulses), "single pulses");
  }
  if (floor) write_floor(file, *floor, units);
  file.commit();
  return message;
}

Archive read_archive(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path))
    throw InputError({.problem = "there is no campaign here", .suggestion = "run calomel campaign first", .file = path.string()});
  const NetcdfReader file(path);
  Archive archive;
  const auto shape_of = [&](const std::string& name, const std::vector<std::string>& dims) {
    if (file.dimensions(name) != dims)
      throw InputError({.problem = "\"" + name + "\" is not " + name + "(" + join(dims) + "), so this is no campaign of calomel", .file = path.string()});
    return file.shape(name);
  };
  const auto names = file.strings("parameter"), keys = file.strings("parameter_key");
  const auto low = file.doubles("parameter_min"), high = file.doubles("parameter_max"), nominals = file.doubles("parameter_nominal");
  for (std::size_t i = 0; i < names.size(); ++i) {
    Parameter p{.name = names[i], .key = keys.at(i), .min = low.at(i), .max = high.at(i)};
    if (!std::isnan(nominals.at(i))) p.nominal = nominals[i];
    archive.shape.parameters.push_back(p);
  }
  archive.shape.conditions = file.has("condition") ? file.strings("condition") : std::vector<std::string>{"default"};
  archive.shape.sensors = file.strings("sensor");
  archive.shape.times = file.doubles("time");
  archive.shape.unit = file.attribute("unit");
  archive.design = file.attribute("design");
  (void)designs().get(archive.design);

  const auto runs = shape_of("theta", {"run", "parameter"})[0];
  const auto theta = file.doubles("theta");
  archive.theta = Eigen::Map<const Eigen::MatrixXd>(theta.data(), Eigen::Index(names.size()), Eigen::Index(runs));
  for (const int s : file.integers("status")) archive.status.push_back(s == 0 ? RunStatus::done : RunStatus::failed);
  archive.message = file.strings("message");

  std::vector<std::string> dims{"run", "sensor", "time"};
  if (file.has("condition")) dims.insert(dims.begin() + 1, "condition");
  const auto columns = [&](const std::string& name) -> Eigen::MatrixXf {
    if (!file.has(name)) return {};
    (void)shape_of(name, dims);
    const auto all = file.doubles(name);
    return Eigen::Map<const Eigen::MatrixXd>(all.data(), Eigen::Index(archive.shape.values()), Eigen::Index(runs)).cast<float>();
  };
  (void)file.shape("strain");
  archive.mean = columns("strain");
  archive.energy_slope = columns("energy_slope");
  archive.scatter = columns("scatter");
  return archive;
}

}  // namespace calomel
