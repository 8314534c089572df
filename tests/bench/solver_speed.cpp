// Element-steps per second of the explicit solver, one and two threads, single and double precision, one run and eight runs
// in the lanes, beside the memory bandwidth and the peak arithmetic measured in the same minutes.
//
//   bench_solver [--jitter SHARE] [CASE.toml ...]      the cases, or without any the plane-strain slice and a half box of about 500 000 elements
//   bench_solver --threads                             when a second thread pays, by size
//   bench_solver --kinds                               what an element costs by material and form
//   bench_solver --ratios                              on one thread and a slice of about 20 000 elements: what gauges cost, what eight runs in the lanes save
//
// --jitter moves the nodes at random by up to that share of the shortest edge, so that no element remains a parallelepiped.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <memory>
#include <string_view>
#include <vector>

#include "forward/target/built_in_model.hpp"
#include "forward/mesh/deform_mesh.hpp"
#include "forward/mesh/make_mesh.hpp"
#include "forward/solver/kernel.hpp"
#include "forward/solver/packed_mesh.hpp"
#include "tests/bench/element_work.hpp"
#include "tests/bench/machine.hpp"

using namespace calomel;

namespace {

/// The best that the machine does on one and two threads.
struct Machine {
  std::array<double, 2> bandwidth{read_bandwidth(1), read_bandwidth(2)};                  ///< [GB/s]
  std::array<std::map<int, double>, 2> single = peaks<float>(), twice = peaks<double>();  ///< [GFLOP/s] by bytes of a vector

  template <class R>
  static std::array<std::map<int, double>, 2> peaks() {
    std::array<std::map<int, double>, 2> found;
    for (const int threads : {1, 2})
      for (const int bytes : {16, 32, 64})
        if (const double peak = peak_arithmetic<R>(bytes, threads); peak > 0) found[std::size_t(threads) - 1][bytes] = peak;
    return found;
  }
};

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

/// Bytes of the vectors that hold the elements (or the runs) of a group in this run's kernel: as many lanes as there are, in what the instruction set has.
int vector_bytes(std::string_view isa, std::size_t real, bool runs) {
  return std::min(int(real) * (runs ? run_lanes : real == 4 ? 8 : 4), isa == "baseline" ? 16 : isa == "avx2" ? 32 : 64);
}

void measure(const std::string& name, const ForwardCase& c, double jitter, const Machine& machine, double seconds) {
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
        o.precision = precision;
        o.threads = threads;
        // As many outputs as fit the time, at least one.
        s.end = s.output_interval;
        const double first = solver.solve(s, {}, o).wall_seconds;
        s.end = s.output_interval * std::max(1.0, std::floor(seconds / std::max(first, 1e-6)));
        Rate best, balanced;
        for (int repeat = 0; repeat < 3; ++repeat) best.add(solver.solve(s, {}, o), threads);
        if (!runs) o.energy_balance = true, balanced.add(solver.solve(s, {}, o), threads);
        const std::size_t real = *precision == 's' ? 4 : 8, t = std::size_t(threads) - 1;
        const MeshWork work = mesh_work(mesh, real, runs);
        const auto& peaks = (real == 4 ? machine.single : machine.twice)[t];
        const int width = vector_bytes(kernels<float>().name, real, runs);
        fmt::print("  {:6}  {} thread{}  {:19} {:6.1f} M/s by the clock, {:6.1f} by processor time{}\n", precision, threads, threads > 1 ? "s" : " ",
                   runs ? "8 runs in the lanes" : "one run", best.wall / 1e6, best.processor / 1e6,
                   runs ? "" : fmt::format(" (with energy balance {:5.1f}, {:5.1f})", balanced.wall / 1e6, balanced.processor / 1e6));
        const double rate = best.wall * work.flops / 1e9;
        fmt::print(
            "          {:.0f} flops, {:.0f} B, {:.2f} flops/B: {:.1f} GFLOP/s, {:.0f} % of {:.0f} with vectors of {} bytes, {:.0f} % of {:.0f} with {}; {:.0f} "
            "% of {:.0f} GB/s\n",
            work.flops, work.bytes, work.flops / work.bytes, rate, 100 * rate / peaks.at(width), peaks.at(width), width, 100 * rate / peaks.rbegin()->second,
            peaks.rbegin()->second, peaks.rbegin()->first, 100 * best.wall * work.bytes / 1e9 / machine.bandwidth[t], machine.bandwidth[t]);
        std::fflush(stdout);
      }
}

/// What the elements request, part by part.
void print_element_work() {
  fmt::print("flops of an element: modes, gradients, strain and stress (pressure), hourglass, spread, corners; all; numbers of geometry\n");
  for (const bool liquid : {true, false})
    for (const Form form : {Form::parallelepiped, Form::general}) {
      const ElementWork w = element_work(liquid, form);
      fmt::print("  {:7} {:14} {:4} {:4} {:4} {:4} {:4} {:4}; {:4}; {:3}\n", liquid ? "mercury" : "steel", form == Form::general ? "general" : "parallelepiped",
                 w.to_modes, w.gradients, w.law, w.hourglass, w.spread, w.to_corners, w.total(), geometry_terms(liquid, form));
    }
}

/// A slice of a box, 0.2 m long and 60 mm high, with `gauges` along its top.
ForwardCase slice_of(double element_size, int gauges) {
  ForwardCase slice;
  slice.geometry.kind = "box";
  slice.geometry.length = 0.2;
  slice.geometry.width = 0.1;
  slice.geometry.height = 0.06;
  slice.geometry.wall = 0.005;
  slice.geometry.plane_strain = true;
  slice.geometry.element_size = element_size;
  slice.load.peak_pressure = 25e6;
  slice.load.profile.center = {0.0, 0.03};
  for (int i = 0; i < gauges; ++i) {
    SensorOptions sensor;
    sensor.name = fmt::format("G{}", i);
    sensor.position = {0.2 * (i + 1) / (gauges + 1), 0.0, 0.06};
    sensor.direction = {1, 0, 0};
    slice.sensors.push_back(sensor);
  }
  return slice;
}

double median(std::vector<double> x) {
  std::sort(x.begin(), x.end());
  return 0.5 * (x[(x.size() - 1) / 2] + x[x.size() / 2]);
}

/// What twelve gauges, read at every output interval, cost, and what eight runs in the lanes save a run: medians of the ratios of neighbouring repetitions
/// that take turns, by processor time. The first ratio is of two equal runs without gauges: it shows the resolution of such a measurement.
void measure_ratios() {
  const ForwardCase c = slice_of(0.775e-3, 12);
  const BuiltInModel model(c, {}, 1);
  const ExplicitSolver solver(model.mesh(), LinearElastic::from_young(c.steel.young, c.steel.poisson));
  std::vector<ObservationRow> rows;
  for (const auto& g : model.gauges()) rows.push_back({g.axial.nodes, g.axial.weights});
  fmt::print("slice of {} elements, one thread, output every {:g} us; medians of {} turns by processor time\n", model.mesh().elements.size(),
             1e6 * c.time.output_interval, 9);
  for (const char* precision : {"single", "double"}) {
    RunSetup one = model.setup(c, model.mesh(), 0, {1.0}), group = model.setup(c, model.mesh(), 0, pulse_energies({}));
    one.end = 40 * one.output_interval;
    group.end = 10 * one.output_interval;
    SolveOptions o;
    o.precision = precision;
    const auto seconds_a_run = [&](const RunSetup& s, std::span<const ObservationRow> read) {
      const auto summary = solver.solve(s, read, o);
      return summary.processor_seconds / double(summary.steps) / double(s.energies.size());
    };
    std::vector<double> same, gauges, lanes;
    for (int turn = 0; turn < 9; ++turn) {
      const double bare = seconds_a_run(one, {}), read = seconds_a_run(one, rows), again = seconds_a_run(one, {}), many = seconds_a_run(group, rows);
      same.push_back(again / bare);
      gauges.push_back(2 * read / (bare + again));
      lanes.push_back(read / many);
    }
    fmt::print("  {:6}  without gauges again / without {:.4f}   twelve gauges / none {:.4f}   one run / a run of eight in the lanes {:.2f}\n", precision,
               median(same), median(gauges), median(lanes));
    std::fflush(stdout);
  }
}

/// What an element costs by its kind: a half box all of mercury or all of steel, as made and jittered, one thread, by processor time, taken in turn.
void measure_kinds() {
  ForwardCase c = slice_of(0.0022, 1);
  c.geometry.plane_strain = false;
  c.geometry.half = true;
  struct Kind {
    bool liquid, general;
    std::unique_ptr<Mesh> mesh;
    std::unique_ptr<ExplicitSolver> solver;
  };
  const BuiltInModel model(c, {}, 1);
  std::vector<Kind> kinds;
  for (const bool general : {false, true})
    for (const bool liquid : {true, false}) {
      auto mesh = std::make_unique<Mesh>(mesh_of(c, general ? 0.1 : 0.0));
      std::fill(mesh->region.begin(), mesh->region.end(), liquid ? Region::mercury : Region::steel);
      mesh->slip.clear();
      mesh->rear.clear();
      auto solver = std::make_unique<ExplicitSolver>(*mesh, LinearElastic::from_young(c.steel.young, c.steel.poisson));
      kinds.push_back({liquid, general, std::move(mesh), std::move(solver)});
    }
  fmt::print("half box of {} elements of one kind, one thread: time of an element-step (and run)\n", kinds[0].mesh->elements.size());
  for (const char* precision : {"single", "double"})
    for (const bool runs : {false, true}) {
      std::vector<double> best(kinds.size(), 1e300);
      for (int turn = 0; turn < 7; ++turn)
        for (std::size_t k = 0; k < kinds.size(); ++k) {
          RunSetup s = model.setup(c, *kinds[k].mesh, 0, runs ? pulse_energies({}) : std::vector<double>{1.0});
          s.end = (runs ? 3 : 10) * s.output_interval;
          SolveOptions o;
          o.precision = precision;
          const auto run = kinds[k].solver->solve(s, {}, o);
          best[k] = std::min(best[k], 1e9 * run.processor_seconds / (double(run.steps) * double(kinds[k].mesh->elements.size()) * double(s.energies.size())));
        }
      const std::size_t real = *precision == 's' ? 4 : 8;
      const int width = vector_bytes(kernels<float>().name, real, runs);
      const double peak = real == 4 ? peak_arithmetic<float>(width, 1) : peak_arithmetic<double>(width, 1);
      fmt::print("  {}, {}; peak {:.1f} GFLOP/s with vectors of {} bytes\n", precision, runs ? "8 runs in the lanes" : "one run", peak, width);
      for (std::size_t k = 0; k < kinds.size(); ++k) {
        const MeshWork work = mesh_work(*kinds[k].mesh, real, runs);
        fmt::print("    {:7} {:14} {:6.1f} ns, {:.2f} times general mercury; {:.0f} flops, {:.0f} B: {:5.1f} GFLOP/s, {:4.1f} % of the peak, {:.2f} flops/B\n",
                   kinds[k].liquid ? "mercury" : "steel", kinds[k].general ? "general" : "parallelepiped", best[k], best[k] / best[2], work.flops, work.bytes,
                   work.flops / best[k], 100 * work.flops / best[k] / peak, work.flops / work.bytes);
      }
      std::fflush(stdout);
    }
}

/// Time of a step [us] where nothing disturbs it: the fiftieth part of all stretches between outputs that is done first.
double undisturbed_step(const ExplicitSolver& solver, const RunSetup& s, SolveOptions o, int turns) {
  std::vector<double> stretches;
  double steps = 1;
  for (int turn = 0; turn < turns; ++turn) {
    double before = 0;
    o.on_progress = [&](double) {
      const double t = std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
      if (before > 0) stretches.push_back(t - before);
      before = t;
    };
    steps = double(solver.solve(s, {}, o).steps);
  }
  std::sort(stretches.begin(), stretches.end());
  return 1e6 * stretches[stretches.size() / 50] / (steps * s.output_interval / s.end);
}

/// When two threads pay: slices of growing size, beside the gain that is estimated from the blocks.
void measure_threads() {
  for (const char* precision : {"single", "double"})
    for (const double size : {10e-3, 7e-3, 5e-3, 3.5e-3, 2.5e-3, 2e-3, 1.4e-3, 1e-3, 0.7e-3}) {
      ForwardCase c = slice_of(size, 1);
      const BuiltInModel model(c, {}, 1);
      const ExplicitSolver solver(model.mesh(), LinearElastic::from_young(c.steel.young, c.steel.poisson));
      RunSetup s = model.setup(c, model.mesh(), 0, {1.0});
      SolveOptions o;
      o.precision = precision;
      const double elements = double(model.mesh().elements.size());
      s.end = s.output_interval * std::max(50.0, std::floor(1e6 / elements));
      const double alone = undisturbed_step(solver, s, o, 2);
      o.threads = 2;
      const double together = undisturbed_step(solver, s, o, 3);
      const ThreadChoice choice = solver.useful_threads(s, o, 2);
      fmt::print(
          "  {:6}  {:6.0f} elements: one thread {:5.1f} M/s, a step {:6.1f} us; two threads {:5.1f} M/s, {:6.1f} us, {:.2f} times; chosen {}, estimated {:.2f} "
          "times\n",
          precision, elements, elements / alone, alone, elements / together, together, alone / together, choice.threads, choice.gain);
      std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
  double jitter = 0;
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "--threads") return measure_threads(), 0;
  if (what == "--kinds") return measure_kinds(), 0;
  if (what == "--ratios") return measure_ratios(), 0;
  if (argc > 2 && what == "--jitter") jitter = std::stod(argv[2]), argc -= 2, argv += 2;
  const Machine machine;
  fmt::print("kernel {}; read bandwidth {:.1f} / {:.1f} GB/s on one / two threads\n", kernels<float>().name, machine.bandwidth[0], machine.bandwidth[1]);
  for (const auto& [precision, peaks] : {std::pair{"single", &machine.single}, std::pair{"double", &machine.twice}})
    for (const auto& [bytes, peak] : (*peaks)[0])
      fmt::print("peak arithmetic, {}, vectors of {} bytes: {:.1f} / {:.1f} GFLOP/s on one / two threads\n", precision, bytes, peak, (*peaks)[1].at(bytes));
  print_element_work();
  for (int i = 1; i < argc; ++i) {
    CaseFile file(argv[i]);
    measure(argv[i], ForwardCase::read(file), jitter, machine, 1.0);
  }
  if (argc > 1) return 0;
  const ForwardCase slice = slice_of(0.001, 1);
  measure("plane-strain slice", slice, jitter, machine, 0.5);
  ForwardCase box = slice;
  box.geometry.plane_strain = false;
  box.geometry.half = true;
  box.geometry.element_size = 0.00107;
  measure("half box", box, jitter, machine, 1.5);
  measure_ratios();
}
