// Element-steps per second of the explicit solver, one and two threads, single and double precision, one run and eight runs
// in the lanes, beside the memory bandwidth measured in the same minutes.
//
//   bench_solver [--jitter SHARE] [CASE.toml ...]      the cases, or without any the plane-strain slice and a half box of about 500 000 elements
//   bench_solver --ratios                              on one thread and a slice of about 20 000 elements: what gauges cost, what eight runs in the lanes save
//
// --jitter moves the nodes at random by up to that share of the shortest edge, so that no element stays a parallelepiped.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <thread>
#include <vector>

#include "forward/built_in_model.hpp"
#include "forward/mesh/deform_mesh.hpp"
#include "forward/mesh/make_mesh.hpp"
#include "forward/solver/kernel.hpp"
#include "forward/solver/packed_mesh.hpp"

using namespace calomel;

namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Read bandwidth [GB/s] over arrays far beyond the caches, best of five.
double read_bandwidth(int threads) {
  const std::size_t size = std::size_t(96) << 20;  // doubles: 768 MB in all
  std::vector<double> a(size, 1.0);
  double best = 0;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const double t0 = now();
    std::vector<double> sums(std::size_t(threads) * 16);
    std::vector<std::jthread> pool;
    for (int t = 0; t < threads; ++t)
      pool.emplace_back([&, t] {
        const double* p = a.data() + size / std::size_t(threads) * std::size_t(t);
        std::array<double, 16> s{};
        for (std::size_t i = 0; i + 16 <= size / std::size_t(threads); i += 16)
          for (std::size_t k = 0; k < 16; ++k) s[k] += p[i + k];
        sums[std::size_t(t) * 16] = std::accumulate(s.begin(), s.end(), 0.0);
      });
    pool.clear();
    const double seconds = now() - t0;
    if (std::accumulate(sums.begin(), sums.end(), 0.0) > 0) best = std::max(best, double(size) * 8 / seconds / 1e9);
  }
  return best;
}

/// Bytes that one element-step must move at least: its geometry, connectivity, and about one node's rows read and written.
double bytes_per_element(const Mesh& mesh, std::size_t real, bool runs) {
  double bytes = 0;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) bytes += double(geometry_terms(mesh.region[e] == Region::mercury, Form::parallelepiped)) * double(real) / (runs ? 8 : 1);
  const double nodes = double(mesh.nodes.size()) / double(mesh.elements.size());
  return bytes / double(mesh.elements.size()) + 16.0 / (runs ? 8 : 1) + nodes * double(real) * (runs ? 3 : 4) * 4;
}

/// The best of a few runs [element-steps/s], by the clock and by processor time (all threads as if none had to wait for others' work).
struct Rate {
  double wall = 0, processor = 0;
  void add(const SolveSummary& s, int threads) {
    wall = std::max(wall, s.element_steps_per_second);
    processor = std::max(processor, s.element_steps_per_second * s.wall_seconds / s.processor_seconds * threads);
  }
};

Mesh mesh_of(const ForwardCase& c, double jitter) {
  RandomStream random(1, 0);
  return jitter > 0 ? jittered(make_mesh(c.geometry), jitter, random) : make_mesh(c.geometry);
}

void measure(const std::string& name, const ForwardCase& c, double jitter, double bandwidth[2], double seconds) {
  const BuiltInModel model(c, {}, 2, mesh_of(c, jitter));
  const Mesh& mesh = model.mesh();
  const bool large = mesh.elements.size() > 2'000'000;  // then one run on all threads only
  std::size_t general = 0;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) general += !hex_geometry(corners_of(mesh, e)).parallelepiped;
  fmt::print("{}: {} elements, {:.1f} % of them general\n", name, mesh.elements.size(), 100.0 * double(general) / double(mesh.elements.size()));
  const ExplicitSolver solver(mesh, LinearElastic::from_young(c.steel.young, c.steel.poisson), 2);
  for (const char* precision : {"single", "double"})
    for (const int threads : {1, 2})
      for (const bool runs : {false, true}) {
        if (large && (runs || threads == 1)) continue;
        RunSetup s = model.setup(c, mesh, 0, runs ? pulse_energies({}) : std::vector<double>{1.0});
        SolveOptions o;
        o.precision = precision, o.threads = threads;
        // As many outputs as fit the time, at least one.
        s.end = s.output_interval;
        const double first = solver.solve(s, {}, o).wall_seconds;
        s.end = s.output_interval * std::max(1.0, std::floor(seconds / std::max(first, 1e-6)));
        Rate best, booked;
        for (int repeat = 0; repeat < 3; ++repeat) best.add(solver.solve(s, {}, o), threads);
        if (!runs) o.booking = true, booked.add(solver.solve(s, {}, o), threads);
        const double bytes = bytes_per_element(mesh, *precision == 's' ? 4 : 8, runs);
        fmt::print("  {:6}  {} thread{}  {:19} {:6.1f} M/s by the clock, {:6.1f} by processor time{}  {:3.0f} B -> {:4.0f} % of {:.0f} GB/s\n", precision, threads, threads > 1 ? "s" : " ",
                   runs ? "8 runs in the lanes" : "one run", best.wall / 1e6, best.processor / 1e6,
                   runs ? std::string(25, ' ') : fmt::format(" (booked {:5.1f}, {:5.1f})", booked.wall / 1e6, booked.processor / 1e6), bytes,
                   100 * best.wall * bytes / 1e9 / bandwidth[threads - 1], bandwidth[threads - 1]);
        std::fflush(stdout);
      }
}

/// A slice of a box, 0.2 m long and 60 mm high, with `gauges` along its top.
ForwardCase slice_of(double element_size, int gauges) {
  ForwardCase slice;
  slice.geometry.kind = "box";
  slice.geometry.length = 0.2, slice.geometry.width = 0.1, slice.geometry.height = 0.06, slice.geometry.wall = 0.005;
  slice.geometry.plane_strain = true, slice.geometry.element_size = element_size;
  slice.load.peak_pressure = 25e6;
  slice.load.profile.center = {0.0, 0.03};
  for (int i = 0; i < gauges; ++i) {
    SensorOptions sensor;
    sensor.name = fmt::format("G{}", i), sensor.position = {0.2 * (i + 1) / (gauges + 1), 0.0, 0.06}, sensor.direction = {1, 0, 0};
    slice.sensors.push_back(sensor);
  }
  return slice;
}

double median(std::vector<double> x) {
  std::sort(x.begin(), x.end());
  return 0.5 * (x[(x.size() - 1) / 2] + x[x.size() / 2]);
}

/// What twelve gauges, read at every output interval, cost, and what eight runs in the lanes save a run: medians of the ratios of neighbouring repetitions
/// that take turns, by processor time. The first ratio is of two equal runs without gauges: it shows what such a measurement can tell.
void measure_ratios() {
  const ForwardCase c = slice_of(0.775e-3, 12);
  const BuiltInModel model(c, {}, 1);
  const ExplicitSolver solver(model.mesh(), LinearElastic::from_young(c.steel.young, c.steel.poisson));
  std::vector<ObservationRow> rows;
  for (const auto& g : model.gauges()) rows.push_back({g.axial.nodes, g.axial.weights});
  fmt::print("slice of {} elements, one thread, output every {:g} us; medians of {} turns by processor time\n", model.mesh().elements.size(), 1e6 * c.time.output_interval, 9);
  for (const char* precision : {"single", "double"}) {
    RunSetup one = model.setup(c, model.mesh(), 0, {1.0}), group = model.setup(c, model.mesh(), 0, pulse_energies({}));
    one.end = 40 * one.output_interval, group.end = 10 * one.output_interval;
    SolveOptions o;
    o.precision = precision;
    const auto seconds_a_run = [&](const RunSetup& s, std::span<const ObservationRow> read) {
      const auto summary = solver.solve(s, read, o);
      return summary.processor_seconds / double(summary.steps) / double(s.energies.size());
    };
    std::vector<double> same, gauges, lanes;
    for (int turn = 0; turn < 9; ++turn) {
      const double bare = seconds_a_run(one, {}), read = seconds_a_run(one, rows), again = seconds_a_run(one, {}), many = seconds_a_run(group, rows);
      same.push_back(again / bare), gauges.push_back(2 * read / (bare + again)), lanes.push_back(read / many);
    }
    fmt::print("  {:6}  without gauges again / without {:.4f}   twelve gauges / none {:.4f}   one run / a run of eight in the lanes {:.2f}\n", precision, median(same),
               median(gauges), median(lanes));
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  double jitter = 0;
  if (argc > 1 && std::string(argv[1]) == "--ratios") {
    measure_ratios();
    return 0;
  }
  if (argc > 2 && std::string(argv[1]) == "--jitter") jitter = std::stod(argv[2]), argc -= 2, argv += 2;
  double bandwidth[2] = {read_bandwidth(1), read_bandwidth(2)};
  fmt::print("kernel {}; read bandwidth {:.1f} / {:.1f} GB/s on one / two threads\n", kernels<float>().name, bandwidth[0], bandwidth[1]);
  for (int i = 1; i < argc; ++i) {
    CaseFile file(argv[i]);
    measure(argv[i], ForwardCase::read(file), jitter, bandwidth, 1.0);
  }
  if (argc > 1) return 0;
  const ForwardCase slice = slice_of(0.001, 1);
  measure("plane-strain slice", slice, jitter, bandwidth, 0.5);
  ForwardCase box = slice;
  box.geometry.plane_strain = false, box.geometry.half = true, box.geometry.element_size = 0.00107;
  measure("half box", box, jitter, bandwidth, 1.5);
  measure_ratios();
}
