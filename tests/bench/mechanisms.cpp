// What each mechanism does to a slice's strains, and what it costs.
//
//   bench_mechanisms CASE.toml [PICTURE.svg]      e.g. examples/02_box_slice/box_slice.toml; 0.3 ms of it in double precision
//
// Differences are those of the ensemble mean of eight energies, with the mechanism less without. Beside them stands what two equally
// good sets of eight energies differ by: less than that is not the mechanism. Cost is processor time, the least of several runs.
#include <fmt/format.h>

#include <cmath>
#include <ctime>

#include "base/artefact.hpp"
#include "forward/target/built_in_model.hpp"
#include "tests/bench/line_plot.hpp"

using namespace calomel;

namespace {

struct Probe {
  std::string name;
  std::vector<std::pair<std::string, std::string>> keys;
};

const std::vector<Probe> probes{{"liquid_viscosity", {{"zeta", "5000.0"}}},
                                {"bubbly_liquid", {{"alpha0", "1e-4"}, {"radius", "1e-4"}, {"ambient_pressure", "3e5"}}},
                                {"structural_damping", {{"mass", "1000.0"}, {"stiffness", "1e-7"}}},
                                {"structural_damping", {{"loss", "0.02"}}},
                                {"beam_profile", {{"offset_z", "3e-3"}, {"width_ratio_z", "1.1"}}},
                                {"rear_reflection", {{"coefficient", "0.3"}}},
                                {"sensor_response", {{"gain", "0.95"}, {"low_pass", "50e3"}, {"delay", "1e-6"}}},
                                {"cavitation_kinetics", {{"growth_time", "10e-6"}, {"collapse_time", "10e-6"}}},
                                {"nonlinear_eos", {{"exponent", "10.8"}}},
                                {"thermal_stress", {{"delta_t", "1.0"}}},
                                {"previous_pulses", {{"left_1", "0.1"}}},
                                {"interface", {{"strength", "0.0"}}},
                                {"wall_thinning", {{"fraction", "0.2"}, {"wall", "top"}}},
                                {"static_pressure", {{"pressure", "1e5"}}}};

ForwardCase read_case(const std::string& path, const Probe* probe) {
  std::vector<std::string> set{"time.end=0.3e-3", "solver.precision=\"double\""};
  if (probe) {
    set.push_back("mechanism." + probe->name + ".enabled=true");
    for (const auto& [key, value] : probe->keys) set.push_back("mechanism." + probe->name + '.' + key + '=' + value);
  }
  CaseFile file(path, set);
  ForwardCase c = ForwardCase::read(file);
  c.parameters.clear();
  return c;
}

double processor_seconds() {
  std::timespec t{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

struct Cost {
  double once = 1e300, lanes = 1e300;  ///< [s] of a single run and of eight in the lanes
};

std::vector<double> mean_of(const BuiltInModel& model) {
  auto p = model.evaluate({});
  if (!p.ok) throw NumericsError(p.message);
  return std::move(p.mean);
}

void measure_cost(const BuiltInModel& once, const BuiltInModel& lanes, Cost& cost) {
  const auto time = [](const BuiltInModel& m, double& least) {
    const double begin = processor_seconds();
    (void)mean_of(m);
    least = std::min(least, processor_seconds() - begin);
  };
  time(once, cost.once);
  time(lanes, cost.lanes);
}

/// Mean over the gauges of the relative L2 difference, over [0, `end`).
double relative(const ModelShape& shape, const std::vector<double>& a, const std::vector<double>& b, double end) {
  double mean = 0;
  for (std::size_t s = 0; s < shape.sensors.size(); ++s) {
    double difference = 0, size = 0;
    for (std::size_t t = 0; t < shape.times.size() && shape.times[t] < end; ++t) {
      const std::size_t i = shape.at(0, s, t);
      difference += std::pow(a[i] - b[i], 2);
      size += b[i] * b[i];
    }
    mean += std::sqrt(difference / size) / double(shape.sensors.size());
  }
  return mean;
}

std::string words(const Probe& p) {
  std::string s = p.name + ':';
  for (const auto& [key, value] : p.keys) s += ' ' + key + ' ' + value;
  return s;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "bench_mechanisms CASE.toml [PICTURE.svg]\n");
    return 2;
  }
  const BuiltInModel base(read_case(argv[1], nullptr), {}), base_once(read_case(argv[1], nullptr), {.pulses = 1});
  const BuiltInModel again(read_case(argv[1], nullptr), {.quantile_shift = 0.3});
  const auto& shape = base.shape();
  const auto plain = mean_of(base), other = mean_of(again);
  const std::size_t gauge = shape.sensors.size() > 1 ? 1 : 0;
  fmt::print("{} elements, {} steps; gauge {} in the picture\n\n", base.describe().elements, base.describe().steps, shape.sensors[gauge]);
  fmt::print("| mechanism | steps | difference, first 100 us | difference, whole | cost, one run | cost, eight in the lanes |\n|---|---|---|---|---|---|\n");
  fmt::print("| none: another set of energies | {} | {:.1f} % | {:.1f} % | 1 | 1 |\n", base.describe().steps, 100 * relative(shape, other, plain, 1e-4),
             100 * relative(shape, other, plain, 1));

  const auto difference = [&](const std::vector<double>& a) {
    std::vector<double> d;
    for (std::size_t t = 0; t < shape.times.size(); ++t) d.push_back(1e6 * (a[shape.at(0, gauge, t)] - plain[shape.at(0, gauge, t)]));
    return d;
  };
  std::vector<double> us;
  for (const double t : shape.times) us.push_back(1e6 * t);
  std::vector<PlotPanel> panels;
  for (const auto& probe : probes) {
    const BuiltInModel with(read_case(argv[1], &probe), {}), with_once(read_case(argv[1], &probe), {.pulses = 1});
    const auto changed = mean_of(with);
    Cost now, before;
    for (int repeat = 0; repeat < 5; ++repeat) measure_cost(with_once, with, now), measure_cost(base_once, base, before);
    fmt::print("| {} | {} | {:.1f} % | {:.1f} % | {:.2f} | {:.2f} |\n", words(probe), with.describe().steps, 100 * relative(shape, changed, plain, 1e-4),
               100 * relative(shape, changed, plain, 1), now.once / before.once, now.lanes / before.lanes);
    std::fflush(stdout);
    panels.push_back({.title = words(probe), .time = us, .solid = difference(changed), .dashed = difference(other)});
  }
  if (argc > 2) write_atomically(argv[2], line_plot("with the mechanism", "other energies", "1e-6", panels));
  return 0;
}
