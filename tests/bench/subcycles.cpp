// What sub-cycling gains and what it changes: processor time, strain and energy balance for 1, 2, 3, 4 and 6 sub-cycles at most, runs
// taken in turn in the same minutes (three of each by default; --lanes: of eight runs in the lanes alone).
//
//   bench_subcycles [--lanes] [--repeats N] [--buffer LAYERS] [--reference STRAINS.csv] CASE.toml [key=value ...]
//
// The reference has a column for each gauge, in the case's own order and times, after one of time.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include "forward/target/built_in_model.hpp"

using namespace calomel;

namespace {

const std::vector<int> allowed{1, 2, 3, 4, 6};

struct Result {
  SolveSummary last;
  std::vector<double> seconds;  ///< of processor time
  std::vector<double> mean;     ///< (gauge, time) mean over the runs of a group
};

double median(std::vector<double> x) {
  std::sort(x.begin(), x.end());
  return x[x.size() / 2];
}

std::vector<double> mean_of(const SolveSummary& s, std::size_t runs) {
  std::vector<double> mean(s.observations.size() / runs);
  for (std::size_t i = 0; i < s.observations.size(); ++i) mean[i % mean.size()] += s.observations[i] / double(runs);
  return mean;
}

/// (gauge, time) from a table with a heading.
std::vector<double> read_reference(const std::string& path) {
  std::ifstream in(path);
  std::string line, cell;
  std::vector<std::vector<double>> columns;
  for (std::getline(in, line); std::getline(in, line);) {
    std::size_t k = 0;
    for (std::stringstream s(line); std::getline(s, cell, ','); ++k) {
      if (k == columns.size()) columns.emplace_back();
      columns[k].push_back(std::stod(cell));
    }
  }
  std::vector<double> out;
  for (std::size_t k = 1; k < columns.size(); ++k) out.insert(out.end(), columns[k].begin(), columns[k].end());
  return out;
}

/// Relative L2 between two records, gauge by gauge.
std::vector<double> differences(const std::vector<double>& a, const std::vector<double>& b, std::size_t times) {
  std::vector<double> out;
  for (std::size_t first = 0; first < a.size(); first += times) {
    double apart = 0, size = 0;
    for (std::size_t i = first; i < first + times; ++i) apart += (a[i] - b[i]) * (a[i] - b[i]), size += b[i] * b[i];
    out.push_back(std::sqrt(apart / size));
  }
  return out;
}

void measure(const BuiltInModel& model, const ExplicitSolver& solver, const std::vector<ObservationRow>& rows, bool lanes, const std::vector<double>& reference,
             int repeats, SolveOptions options) {
  const RunSetup setup = model.setup(model.forward_case(), model.mesh(), 0, lanes ? pulse_energies({}) : std::vector<double>{1.0});
  const std::size_t runs = setup.energies.size();
  std::vector<Result> results(allowed.size());
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (std::size_t i = 0; i < allowed.size(); ++i) {
      options.subcycles = allowed[i];
      Result& r = results[i];
      r.last = solver.solve(setup, rows, options);
      r.seconds.push_back(r.last.processor_seconds);
      r.mean = mean_of(r.last, runs);
    }
  fmt::print("  {}\n", lanes ? "eight runs in the lanes" : "one run");
  for (std::size_t i = 0; i < allowed.size(); ++i) {
    const Result& r = results[i];
    double balance = std::nan("");
    if (!lanes) {
      SolveOptions balanced = options;
      balanced.energy_balance = true;
      balanced.subcycles = allowed[i];
      balance = solver.solve(setup, rows, balanced).energy_balance_error;
    }
    const double seconds = median(r.seconds), rate = double(model.mesh().elements.size() * runs) * double(r.last.steps) / seconds / 1e6;
    const auto d = differences(r.mean, results[0].mean, r.last.times.size());
    options.subcycles = 1;
    const Stepping without = solver.stepping(setup, options);
    options.subcycles = allowed[i];
    const Stepping with = solver.stepping(setup, options);
    const double estimated = without.per_output / (with.per_output * with.work);
    std::string error;
    if (reference.size() == r.mean.size()) {
      const auto e = differences(r.mean, reference, r.last.times.size());
      error = fmt::format("; error {:.2f} %", 100 * std::accumulate(e.begin(), e.end(), 0.0) / double(e.size()));
    }
    fmt::print(
        "    at most {}: {} used, {:6} steps of {:.3e} s, {:8.3f} s, {:6.1f} M/s nominal, {:4.2f} times (estimated {:4.2f}); difference {:5.2f} % (worst "
        "{:5.2f} %); balance {:.1e}{}\n",
        allowed[i], r.last.subcycles, r.last.steps, r.last.time_step, seconds, rate, median(results[0].seconds) / seconds, estimated,
        100 * std::accumulate(d.begin(), d.end(), 0.0) / double(d.size()), 100 * *std::max_element(d.begin(), d.end()), balance, error);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  int buffer = default_subcycle_buffer, repeats = 3;
  bool single_runs = true;
  if (argc > 1 && std::string(argv[1]) == "--lanes") single_runs = false, --argc, ++argv;
  if (argc > 2 && std::string(argv[1]) == "--repeats") repeats = std::stoi(argv[2]), argc -= 2, argv += 2;
  if (argc > 2 && std::string(argv[1]) == "--buffer") buffer = std::stoi(argv[2]), argc -= 2, argv += 2;
  std::vector<double> reference;
  if (argc > 2 && std::string(argv[1]) == "--reference") reference = read_reference(argv[2]), argc -= 2, argv += 2;
  if (argc < 2) return fmt::print("usage: bench_subcycles [--lanes] [--repeats N] [--buffer LAYERS] [--reference STRAINS.csv] CASE.toml [key=value ...]\n"), 2;
  CaseFile file(argv[1], std::vector<std::string>(argv + 2, argv + argc));
  const BuiltInModel model(ForwardCase::read(file));
  const ForwardCase& c = model.forward_case();
  const Mesh& mesh = model.mesh();
  const ExplicitSolver solver(mesh, LinearElastic::from_young(c.steel.young, c.steel.poisson));
  std::size_t steel = 0, slow = 0;
  for (const Region r : mesh.region) steel += r == Region::steel;
  for (const auto s : slow_elements(mesh, buffer)) slow += s;
  const double all = double(mesh.elements.size()) / 100;
  fmt::print("{}: {} elements, {:.0f} % steel, {:.0f} % slow with {} layers between\n", argv[1], mesh.elements.size(), double(steel) / all, double(slow) / all,
             buffer);
  std::vector<ObservationRow> rows;
  for (const auto& g : model.gauges()) rows.push_back({g.axial.nodes, g.axial.weights});
  SolveOptions options = solve_options(c.solver);
  options.subcycle_buffer = buffer;
  if (single_runs) measure(model, solver, rows, false, reference, repeats, options);
  measure(model, solver, rows, true, reference, repeats, options);
}
