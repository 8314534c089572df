// Two strain gauges on a steel bar: what the first one measured drives a 3-D bar, and the second one must come out.
//
//   hopkinson_bar prepare RECORD DIR                  the record -> DIR/end_stress.csv and DIR/recordings.csv
//   hopkinson_bar residual RECORD OUT [expected.csv]  what OUT, made by `calomel study`, leaves unexplained, in mV
//
// The record counts the compressive pulse as positive volts. What a bridge gives per strain is not known, so 1 V is called
// 1e-3 strain; only the ratio of the gauges matters, and a misfit in microstrain reads directly in mV.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/netcdf_file.hpp"
#include "examples/expected.hpp"
#include "inverse/data/recordings.hpp"

using namespace calomel;

namespace {

constexpr std::size_t baseline_samples = 150;
constexpr double strain_per_volt = -1e-3;                     // compression negative
constexpr double window_begin = 250e-6, window_end = 420e-6;  // before anything returns to the second gauge [s]
constexpr double bar_density = 7850;                          // as in case.toml [kg/m^3]

/// The two channels without their baselines [V].
struct Record {
  std::vector<double> time, first, second;
};

Record read_record(const std::filesystem::path& path) {
  const Recordings raw = read_recordings_file(path, "V");
  if (raw.sensors.size() != 2 || raw.time.size() < 2 * baseline_samples)
    throw InputError(
        {.problem = fmt::format("two channels of at least {} samples are expected, {} of {} given", 2 * baseline_samples, raw.sensors.size(), raw.time.size()),
         .file = path.string()});
  const auto channel = [&](std::size_t sensor) {
    std::vector<double> y(raw.values.begin() + std::ptrdiff_t(raw.at(0, sensor, 0, 0)),
                          raw.values.begin() + std::ptrdiff_t(raw.at(0, sensor, 0, 0) + raw.time.size()));
    double baseline = 0;
    for (std::size_t i = 0; i < baseline_samples; ++i) baseline += y[i] / double(baseline_samples);
    for (double& v : y) v -= baseline;
    return y;
  };
  return {raw.time, channel(0), channel(1)};
}

void prepare(const std::filesystem::path& path, const std::filesystem::path& directory) {
  const Record r = read_record(path);
  std::string stress = "# time [s], first gauge [V], tension positive\n", strain = "sensor,pulse,time,strain\n";
  for (std::size_t i = 0; i < r.time.size(); ++i) {
    stress += fmt::format("{:.10g},{:.8g}\n", r.time[i], -r.first[i]);
    strain += fmt::format("S2,1,{:.10g},{:.8g}\n", r.time[i], strain_per_volt * r.second[i]);
  }
  make_directory(directory);
  write_atomically(directory / "end_stress.csv", stress);
  write_atomically(directory / "recordings.csv", strain);
  fmt::print("{} samples, {:.4g} s apart: end_stress.csv and recordings.csv in {}\n", r.time.size(), r.time[1] - r.time[0], directory.string());
}

/// Value at t of samples on even steps, straight lines between them.
double at(std::span<const double> time, std::span<const double> y, double t) {
  const double position = (t - time[0]) / (time[1] - time[0]);
  if (position <= 0) return y[0];
  const auto i = std::min(std::size_t(position), y.size() - 2);
  const double w = std::min(position - double(i), 1.0);
  return (1 - w) * y[i] + w * y[i + 1];
}

/// Root mean square over the window of record - gain x model [mV]; a gain of 0 is fitted by least squares.
struct Residual {
  double rms, gain;
};
template <class Model>
Residual residual_of(const Record& r, const Model& model, double gain = 0) {
  double own = 0, both = 0, squares = 0;
  int n = 0;
  for (const bool fit : {true, false})
    for (std::size_t i = 0; i < r.time.size(); ++i) {
      if (r.time[i] < window_begin || r.time[i] > window_end) continue;
      const double y = r.second[i], x = model(r.time[i]);
      if (fit)
        own += x * x, both += x * y;
      else
        squares += std::pow(y - (gain != 0 ? gain : both / own) * x, 2), ++n;
    }
  return {1e3 * std::sqrt(squares / n), gain != 0 ? gain : both / own};
}

bool residual(const std::filesystem::path& path, const std::filesystem::path& out, const char* expected) {
  const Record r = read_record(path);

  // 1. A one-dimensional bar carries the first gauge's signal on undispersed: delay and gain fitted.
  Residual line{1e300, 0};
  double delay = 0;
  for (int i = 0; i < 1000; ++i) {
    const double d = 215e-6 + 1e-8 * i;
    if (const auto x = residual_of(r, [&](double t) { return at(r.time, r.first, t - d); }); x.rms < line.rms) line = x, delay = d;
  }

  // 2. The 3-D bar at the calibrated and at the nominal parameters.
  const Json summary = read_json(out / "enc.json");
  const NetcdfReader file(out / "enc.nc");
  const auto time = file.doubles("time");
  const auto bar = [&](const char* name) {
    const auto strain = file.doubles(name);
    return residual_of(
               r, [&](double t) { return at(time, strain, t) / strain_per_volt; }, 1.0)
        .rms;
  };
  const auto number = [&](const char* set, const char* name) { return summary.at(set).at(name).get<double>(); };
  const auto speed = [&](const char* set) { return std::sqrt(number(set, "young") / bar_density); };
  const double calibrated = bar("calibrated");
  fmt::print("residual at the second gauge over {:.0f} to {:.0f} us [mV rms]\n", 1e6 * window_begin, 1e6 * window_end);
  fmt::print("  {:<50} {:>6.2f}   delay {:.2f} us, gain {:.4f}\n", "1-D bar, computed here", line.rms, 1e6 * delay, line.gain);
  fmt::print("  {:<50} {:>6.2f}   c {:.0f} m/s, nu {:.3f}, gain {:.4f}\n", "3-D bar, nominal", bar("nominal"), speed("nominal"), number("nominal", "poisson"),
             number("nominal", "gauge_ratio"));
  fmt::print("  {:<50} {:>6.2f}   c {:.0f} m/s, nu {:.3f}, gain {:.4f}\n", "3-D bar, calibrated", calibrated, speed("theta"), number("theta", "poisson"),
             number("theta", "gauge_ratio"));
  fmt::print("measured independently on the same record and window:\n");
  for (const auto& [name, rms] : {std::pair{"1-D bar", 27.4},
                                  {"1-D bar with a lag of the sensor", 25.5},
                                  {"1-D bar with viscous attenuation", 23.7},
                                  {"Love rod (lateral inertia), nu 0.303", 17.4},
                                  {"Pochhammer-Chree first mode, nu 0.285", 16.1}})
    fmt::print("  {:<50} {:>6.1f}\n", name, rms);

  std::map<std::string, double> found{{"1-D bar [mV]", line.rms},          {"3-D bar nominal [mV]", bar("nominal")}, {"3-D bar calibrated [mV]", calibrated},
                                      {"bar speed [m/s]", speed("theta")}, {"poisson", number("theta", "poisson")},  {"gain", number("theta", "gauge_ratio")}};
  return expected == nullptr || examples::as_expected(found, expected);
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string verb = argc > 3 ? argv[1] : "";
  if (verb == "prepare" && argc == 4) return prepare(argv[2], argv[3]), 0;
  if (verb == "residual") return residual(argv[2], argv[3], argc > 4 ? argv[4] : nullptr) ? 0 : 1;
  fmt::print(stderr, "hopkinson_bar prepare RECORD DIR\nhopkinson_bar residual RECORD OUT [expected.csv]\n");
  return 2;
} catch (const std::exception& e) {
  fmt::print(stderr, "{}\n", e.what());
  return 2;
}
