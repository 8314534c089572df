/// Makes the recordings of an example: make_recordings CASE.toml TRUTH.toml OUT.nc
///
/// Plays the part of the experiment. It takes the target, the load and the gauges from the case, and from the truth file
/// the parameters, a finer mesh, another time step, the pulses that each gauge recorded, the spread of their energies and
/// the noise. Nothing of the truth file reaches the recordings but through the strains.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <map>

#include "base/case_file.hpp"
#include "base/errors.hpp"
#include "base/parallel.hpp"
#include "base/random.hpp"
#include "forward/target/built_in_model.hpp"
#include "forward/solver/kernel.hpp"
#include "inverse/data/recordings.hpp"

namespace {

using namespace calomel;

/// `[experiment]` of a truth file.
struct ExperimentOptions {
  int seed = 0;
  std::string precision;
  double element_size_ratio = 0, time_step_safety = 0;
  double sample_interval = 0;
  double energy_sd = 0;
  double noise_time = 0;
  double resolution = 0;
  double place_sd = 0, gain_sd = 0;
  std::vector<std::string> unlike;
  template <class V>
  void visit(V& v) {
    v("seed", seed, {.range = at_least(0), .doc = "of the pulse energies and the noise", .required = true});
    v("precision", precision, {.doc = "arithmetic of the time loop", .required = true, .choices = {"single", "double"}});
    v("element_size_ratio", element_size_ratio, {.range = between(0.1, 1), .doc = "element size over that of the case", .required = true});
    v("time_step_safety", time_step_safety, {.range = between(0.05, 1), .doc = "share of the stable step that is used", .required = true});
    v("sample_interval", sample_interval, {.unit = "s", .range = above(0), .doc = "time between recorded samples", .required = true});
    v("energy_sd", energy_sd, {.range = between(0, 0.5), .doc = "relative sd of the energy from pulse to pulse", .required = true});
    v("noise_time", noise_time, {.unit = "s", .range = above(0), .doc = "correlation time of the noise", .required = true});
    v("resolution", resolution, {.range = above(0), .doc = "strain of one count of the digitiser", .required = true});
    v("place_sd", place_sd, {.unit = "m", .range = at_least(0), .doc = "sd of a gauge's place, along its direction, about that of the case"});
    v("gain_sd", gain_sd, {.range = between(0, 0.5), .doc = "sd of a channel's gain about 1"});
    v("unlike", unlike, {.doc = "where the experiment is not as the case says: table.key=value each"});
  }
};

/// A table with one required number for each of the given names.
template <class Number>
struct Named {
  std::map<std::string, Number> of;
  Range range;
  const char* doc;
  template <class V>
  void visit(V& v) {
    for (auto& [name, value] : of) v(name.c_str(), value, {.range = range, .doc = doc, .required = true});
  }
};

/// Ornstein-Uhlenbeck noise of standard deviation `sd`, sampled exactly: e_k+1 = r e_k + sd sqrt(1 - r^2) n_k,
/// r = exp(-interval / noise_time) (Gillespie 1996, Phys. Rev. E 54, 2084).
std::vector<double> correlated_noise(std::size_t samples, double sd, double interval, double noise_time, RandomStream& random) {
  const double r = std::exp(-interval / noise_time);
  std::vector<double> e(samples);
  for (std::size_t k = 0; k < samples; ++k) e[k] = k == 0 ? sd * random.normal() : r * e[k - 1] + sd * std::sqrt(1 - r * r) * random.normal();
  return e;
}

/// Moves the gauges of `c` along their directions and returns the gains of their channels, which no case file contains. Their streams
/// are their own: neither pulses nor noise depend on them.
std::vector<double> unknown_channels(ForwardCase& c, const ExperimentOptions& experiment) {
  RandomStream random(std::uint64_t(experiment.seed), std::uint64_t(1) << 40);
  std::vector<double> gains;
  for (auto& s : c.sensors) {
    gains.push_back(1 + experiment.gain_sd * random.normal());
    const double moved = experiment.place_sd * random.normal();
    for (std::size_t k = 0; k < 3; ++k) s.position[k] += moved * s.direction[k];
  }
  return gains;
}

/// Strains of pulses of the given relative energies, shape (pulse, sensor, time) [-]; each pulse is a run of its own. The
/// heating pressure is the one of the case's own parameters, as the policy "fixed" has it.
std::vector<double> true_strains(const BuiltInModel& model, const std::vector<double>& theta, const std::vector<double>& energies) {
  const ForwardCase c = model.forward_case().at(theta);
  const ExplicitSolver solver(model.mesh(), LinearElastic::from_young(c.steel.young, c.steel.poisson), default_threads());
  std::vector<ObservationRow> rows;
  for (const auto& g : model.gauges()) rows.push_back({g.axial.nodes, g.axial.weights});
  SolveOptions options = solve_options(c.solver);
  options.threads = default_threads();
  std::vector<double> strains;
  for (std::size_t first = 0; first < energies.size(); first += run_lanes) {
    const std::size_t last = std::min(first + std::size_t(run_lanes), energies.size());
    const std::vector<double> group(energies.begin() + std::ptrdiff_t(first), energies.begin() + std::ptrdiff_t(last));
    const auto summary = solver.solve(model.setup(c, model.mesh(), 0, group), rows, options);
    strains.insert(strains.end(), summary.observations.begin(), summary.observations.end());
    fmt::print("pulses {} to {}: {} elements, {} steps of {:.4g} s, {:.1f} s\n", first + 1, last, model.mesh().elements.size(), summary.steps,
               summary.time_step, summary.wall_seconds);
    std::fflush(stdout);
  }
  return strains;
}

void make_recordings(const std::string& case_path, const std::string& truth_path, const std::string& out) {
  // 1. The experiment: the case's target with the true parameters, a finer mesh, another step, and the facts that no case file contains.
  CaseFile truth(truth_path);
  ExperimentOptions experiment;
  truth.read("experiment", experiment);
  CaseFile case_file(case_path, experiment.unlike);
  ForwardCase c = case_file.locating([&] { return ForwardCase::read(case_file); });
  Named<double> parameters{.range = any(), .doc = "true value"}, noise{.range = at_least(0), .doc = "sd of the noise [-]"};
  Named<int> pulses{.range = at_least(1), .doc = "recorded pulses"};
  for (const auto& p : c.parameters) parameters.of[p.name] = 0;
  for (const auto& s : c.sensors) pulses.of[s.name] = 0, noise.of[s.name] = 0;
  truth.read("parameter", parameters);
  truth.read("pulses", pulses);
  truth.read("noise", noise);
  truth.expect_all_read({});

  std::vector<double> theta;
  for (const auto& p : c.parameters) theta.push_back(parameters.of[p.name]);
  c.geometry.element_size = experiment.element_size_ratio * c.geometry.resolved().element_size.value();
  if (c.geometry.wall_elements > 0) c.geometry.wall_elements = int(std::lround(c.geometry.wall_elements / experiment.element_size_ratio));
  c.solver.precision = experiment.precision;
  c.solver.time_step_safety = experiment.time_step_safety;
  c.time.output_interval = experiment.sample_interval;
  c.time.validate();
  const std::vector<double> gains = unknown_channels(c, experiment);
  const BuiltInModel model(c);

  // 2. Every pulse has its own energy.
  int count = 0;
  for (const auto& [name, n] : pulses.of) count = std::max(count, n);
  RandomStream energy(std::uint64_t(experiment.seed), 0);
  std::vector<double> energies;
  for (int i = 0; i < count; ++i) energies.push_back(1 + experiment.energy_sd * energy.normal());
  const auto strains = true_strains(model, theta, energies);

  // 3. What the gauges record of it: noise, the zero set at the trigger, whole counts of the digitiser.
  Recordings record;
  record.conditions = {"default"};
  record.time = model.shape().times;
  record.source = "examples/recorder/make_recordings";
  for (int i = 0; i < count; ++i) record.pulses.push_back(i + 1);
  for (const auto& s : c.sensors) {
    expect(s.gain == 1 && s.delay == 0, "the examples' channels are ideal");
    record.sensors.push_back(s.name);
  }
  const std::size_t sensors = record.sensors.size(), samples = record.time.size();
  record.values.assign(sensors * record.pulses.size() * samples, std::nan(""));
  for (std::size_t s = 0; s < sensors; ++s)
    for (std::size_t i = 0; i < std::size_t(pulses.of[record.sensors[s]]); ++i) {
      RandomStream random(std::uint64_t(experiment.seed), 1 + s * record.pulses.size() + i);
      const auto e = correlated_noise(samples, noise.of[record.sensors[s]], experiment.sample_interval, experiment.noise_time, random);
      for (std::size_t k = 0; k < samples; ++k) {
        const double y = gains[s] * strains[(i * sensors + s) * samples + k] + e[k] - e[0];
        record.values[record.at(0, s, i, k)] = experiment.resolution * std::round(y / experiment.resolution);
      }
    }
  write_recordings(out, record);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 4) {
    fmt::print(stderr, "usage: make_recordings CASE.toml TRUTH.toml OUT.nc\n");
    return 2;
  }
  make_recordings(argv[1], argv[2], argv[3]);
  return 0;
} catch (const calomel::InputError& e) {
  fmt::print(stderr, "{}\n", e.what());
  return 2;
} catch (const std::exception& e) {
  fmt::print(stderr, "{}\n", e.what());
  return 3;
}
