#include "forward/solver/explicit_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <tuple>

#include "base/parallel.hpp"
#include "forward/mesh/assemble_mesh.hpp"
#include "forward/solver/stable_step.hpp"
#include "forward/solver/time_loop.hpp"

namespace calomel {

SolveOptions solve_options(const SolverOptions& o) {
  SolveOptions s;
  s.precision = o.precision;
  s.kinematics = o.kinematics;
  s.steel_element = o.steel_element;
  s.time_step_safety = o.time_step_safety;
  s.subcycles = o.subcycles;
  s.heated_rear = o.rear_reference == "heated";
  return s;
}

/// Everything that the stable step of a mesh follows from, whatever changed it: a case, a parameter or a mechanism.
struct StepKey {
  std::array<double, 13> numbers;
  bool single, group, parts;
  ElementKind kind;
  int buffer;  ///< of sub-cycling, or none
  bool operator==(const StepKey&) const = default;
};

namespace {

std::array<std::uint8_t, 8> fixed_of(const Mesh& mesh, std::size_t e) {
  std::array<std::uint8_t, 8> f{};
  for (std::size_t k = 0; k < 8; ++k) f[k] = mesh.fixed[std::size_t(mesh.elements[e][k])];
  return f;
}

ElementKind kind_of(const SolveOptions& o) {
  if (o.kinematics != "finite") return o.steel_element == "b_bar" ? ElementKind::b_bar : ElementKind::fast;
  if (o.steel_element == "b_bar")
    throw InputError({.problem = "the B-bar element is one of small strain",
                      .key = "solver.steel_element",
                      .value = "\"b_bar\"",
                      .suggestion = "set solver.kinematics = \"small\""});
  return ElementKind::finite;
}

StepKey step_key(const RunSetup& s, const SolveOptions& o) {
  return {.numbers = {s.steel_density, s.liquid_density, s.steel.lambda, s.steel.mu, s.liquid.bulk_modulus, s.liquid_stiffness(), s.liquid.viscosity,
                      s.collapse_resistance(), s.hourglass, s.steel_stiffness_damping, s.steel_mass_damping, s.wall_film, s.steel_stiffening()},
          .single = o.precision == "single",
          .group = s.energies.size() > 1,
          .parts = faces_may_part(s),
          .kind = kind_of(o),
          .buffer = o.subcycles > 1 ? o.subcycle_buffer : no_subcycles};
}

}  // namespace

struct ExplicitSolver::Parts {
  const Mesh* mesh;
  LinearElastic steel;
  ElementFacts facts;
  std::vector<std::pair<double, double>> stiffest;  ///< eigenvalue / c^2 and size [m] of those liquid elements that none exceeds in both, by falling eigenvalue
  double steel_eigenvalue = 0;                      ///< x density
  NodalVolumes volumes;

  // Made when first needed; the lock only guards the making.
  mutable std::mutex lock;
  using Which = std::tuple<bool, ElementKind, int>;  ///< lanes are runs, elements, layers that take every step
  mutable std::map<Which, std::unique_ptr<PackedMesh<float>>> single;
  mutable std::map<Which, std::unique_ptr<PackedMesh<double>>> twice;
  mutable std::optional<std::pair<StepKey, StableSteps>> last_step;  ///< a case is described and then run: the step is looked for once
  int threads;

  template <class R>
  const PackedMesh<R>& packed(bool runs, ElementKind kind, int buffer) const {
    const std::lock_guard guard(lock);
    auto& slot = [&]() -> auto& {
      if constexpr (std::is_same_v<R, float>)
        return single[{runs, kind, buffer}];
      else
        return twice[{runs, kind, buffer}];
    }
    ();
    if (!slot) {
      const auto slow = buffer == no_subcycles ? std::vector<std::uint8_t>{} : slow_elements(*mesh, buffer);
      slot = std::make_unique<PackedMesh<R>>(*mesh, steel, facts, kind, runs, threads, slow);
    }
    return *slot;
  }

  /// Calls f with a zero of the arithmetic that the options name.
  template <class F>
  static auto in_precision(const SolveOptions& options, F&& f) {
    return options.precision == "single" ? f(float{}) : f(double{});
  }
};

ExplicitSolver::ExplicitSolver(const Mesh& mesh, const LinearElastic& steel, int threads, double softening) : parts_(std::make_unique<Parts>()) {
  Parts& p = *parts_;
  p.mesh = &mesh;
  p.steel = steel;
  p.threads = threads;
  const std::size_t n = mesh.elements.size();
  p.facts.parallelepiped.resize(n);
  p.facts.stiffness.assign(n, 1.0f);
  p.facts.size.assign(n, 0.0f);
  if (softening != 0) {
    const auto reentrant = reentrant_elements(mesh);
    for (std::size_t e = 0; e < n; ++e)
      if (reentrant[e]) p.facts.stiffness[e] = float(1 - softening);
  }
  p.volumes.steel.assign(mesh.nodes.size(), 0);
  p.volumes.liquid.assign(mesh.nodes.size(), 0);
  std::vector<double> volume(n), eigenvalue(n);
  parallel_for((n + 1023) / 1024, threads, [&](std::size_t chunk) {
    for (std::size_t e = chunk * 1024; e < std::min(n, (chunk + 1) * 1024); ++e) {
      const HexGeometry g = hex_geometry(corners_of(mesh, e));
      if (!(g.volume > 0)) throw InputError({.problem = fmt::format("element {} is inverted (volume {:.3g} m^3)", e, g.volume), .key = "geometry"});
      p.facts.parallelepiped[e] = g.parallelepiped;
      volume[e] = g.volume;
      if (mesh.region[e] == Region::mercury) p.facts.size[e] = float(shortest_edge(mesh, e));
      eigenvalue[e] = mesh.region[e] == Region::mercury ? liquid_eigenvalue(g, fixed_of(mesh, e))
                                                        : steel_eigenvalue(g, steel, hourglass_stiffness(g, steel), fixed_of(mesh, e));
    }
  });
  std::vector<std::pair<double, double>> liquids;
  for (std::size_t e = 0; e < n; ++e) {
    const bool liquid = mesh.region[e] == Region::mercury;
    if (liquid)
      liquids.emplace_back(eigenvalue[e], double(p.facts.size[e]));
    else
      p.steel_eigenvalue = std::max(p.steel_eigenvalue, eigenvalue[e]);
    for (const NodeId node : mesh.elements[e]) (liquid ? p.volumes.liquid : p.volumes.steel)[std::size_t(node)] += volume[e] / 8;
  }
  std::sort(liquids.begin(), liquids.end(), std::greater<>());
  for (const auto& liquid : liquids)
    if (p.stiffest.empty() || liquid.second > p.stiffest.back().second) p.stiffest.push_back(liquid);
}
ExplicitSolver::~ExplicitSolver() = default;
ExplicitSolver::ExplicitSolver(ExplicitSolver&&) noexcept = default;
const Mesh& ExplicitSolver::mesh() const { return *parts_->mesh; }

double ExplicitSolver::element_step(const RunSetup& s, bool liquid_alone) const {
  double step = 1e300;
  if (parts_->steel_eigenvalue > 0 && !liquid_alone)
    step = std::min(step, stable_time_step(parts_->steel_eigenvalue * s.steel_stiffening() / s.steel_density, s.steel_stiffness_damping));
  if (!parts_->stiffest.empty()) {
    const double k = s.liquid.bulk_modulus, stiffness = s.liquid_stiffness();
    if (!(k > 0) || !std::isfinite(k)) throw NumericsError(fmt::format("the liquid's bulk modulus vanishes (K = {:.3g} Pa): nothing resists compression", k));
    if (!std::isfinite(stiffness))
      throw NumericsError(fmt::format("the law of the liquid sets no bound to its stiffness ({:.3g} Pa), so no step is stable", stiffness));
    for (const auto& [eigenvalue, size] : parts_->stiffest)
      step = std::min(step, stable_time_step(eigenvalue * std::max(stiffness, s.hourglass * k) / s.liquid_density,
                                             (s.liquid.viscosity + s.collapse_resistance() * size) / k));
  }
  if (s.wall_film != 0 && faces_may_part(s)) step *= std::sqrt(1 - greatest_film);  // a node may lose so much of its mass
  if (!liquid_alone) step = mass_damped_time_step(step, s.steel_mass_damping);
  if (!(step > 1e-12)) throw NumericsError(fmt::format("the stable time step collapses ({:.3g} s)", step));
  return step;
}

double ExplicitSolver::stable_step(const RunSetup& setup, const SolveOptions& options) const { return stable_steps(setup, options).whole; }

StableSteps ExplicitSolver::stable_steps(const RunSetup& setup, const SolveOptions& options) const {
  const double bound = element_step(setup);
  const StepKey key = step_key(setup, options);
  const bool subcycled = key.buffer != no_subcycles && !parts_->stiffest.empty();
  {
    const std::lock_guard guard(parts_->lock);
    if (parts_->last_step && parts_->last_step->first == key) return parts_->last_step->second;
  }
  const double liquid_bound = subcycled ? element_step(setup, true) : 0;
  StableSteps steps = Parts::in_precision(options, [&](auto zero) {
    using R = decltype(zero);
    const PackedMesh<R>& packed = parts_->packed<R>(key.group, key.kind, key.buffer);
    const auto global = [&](double step, bool liquid_alone) {
      const Run<R> run(packed, *parts_->mesh, parts_->volumes, setup, {.heated_rear = false}, step);
      return global_stable_step(run, options.threads, liquid_alone);
    };
    const double slow = global(bound, false) / std::sqrt(setup.steel_stiffening());  // of the steel at rest; on the safe side where mercury holds the step
    return StableSteps{mass_damped_time_step(slow, setup.steel_mass_damping), subcycled ? global(liquid_bound, true) : 0};
  });
  if (key.kind != ElementKind::b_bar) steps.whole = std::max(bound, steps.whole);
  steps.liquid = std::max(liquid_bound, steps.liquid);
  const std::lock_guard guard(parts_->lock);
  parts_->last_step = {key, steps};
  return steps;
}

Stepping ExplicitSolver::stepping(const RunSetup& s, const SolveOptions& options) const {
  const auto least_steps = [&](double step) {
    const double ratio = s.output_interval / (options.time_step_safety * step);
    if (ratio > 1e6) throw NumericsError(fmt::format("the stable time step {:.3g} s is more than a million times below the output interval", step));
    return std::max(1, int(std::ceil(ratio)));
  };
  if (least_steps(element_step(s)) == 1) return {};
  const StableSteps stable = stable_steps(s, options);
  const int least = least_steps(stable.whole);
  if (!(stable.liquid > 0)) return {.per_output = least};
  const Layout* layout = Parts::in_precision(
      options, [&](auto zero) { return &parts_->packed<decltype(zero)>(s.energies.size() > 1, kind_of(options), options.subcycle_buffer).layout; });
  return cheapest_stepping(*layout, s.liquid_law != nullptr, least, least_steps(stable.liquid), options.subcycles);
}

ThreadChoice ExplicitSolver::useful_threads(const RunSetup& s, const SolveOptions& options, int most) const {
  if (most <= 1) return {};
  const bool lanes = s.energies.size() > 1;
  const int subcycles = options.subcycles > 1 ? stepping(s, options).subcycles : 1;
  return Parts::in_precision(options, [&](auto zero) {
    const auto& packed = parts_->packed<decltype(zero)>(lanes, kind_of(options), subcycles > 1 ? options.subcycle_buffer : no_subcycles);
    return calomel::useful_threads(packed.layout, s.liquid_law != nullptr, lanes ? group_cost : 1, subcycles, most);
  });
}

SolveSummary ExplicitSolver::solve(const RunSetup& setup, std::span<const ObservationRow> rows, const SolveOptions& options) const {
  expect(!setup.energies.empty() && setup.energies.size() <= std::size_t(run_lanes), "one to eight runs in a group");
  expect(!options.energy_balance || setup.energies.size() == 1, "an energy balance is of single runs");
  if (kind_of(options) == ElementKind::b_bar && (!setup.thermal_strain.empty() || !setup.initial_stress.empty()))
    throw InputError({.problem = "the B-bar element takes no heat in the steel and no stress before the run",
                      .key = "solver.steel_element",
                      .value = "\"b_bar\"",
                      .suggestion = "set solver.steel_element = \"assumed_strain\""});
  const Stepping stepping = this->stepping(setup, options);
  return Parts::in_precision(options, [&](auto zero) {
    using R = decltype(zero);
    const PackedMesh<R>& packed =
        parts_->packed<R>(setup.energies.size() > 1, kind_of(options), stepping.subcycles > 1 ? options.subcycle_buffer : no_subcycles);
    Run<R> run(packed, *parts_->mesh, parts_->volumes, setup, options, setup.output_interval / stepping.per_output, stepping.subcycles);
    SolveSummary out = run_to_end(run, setup, packed.layout, rows, options, stepping.per_output);
    const auto [stress, element] = run.greatest_stress();
    out.greatest_stress = stress;
    out.time_at_cutoff = run.time_at_cutoff();
    if (element >= 0)
      for (const NodeId n : parts_->mesh->elements[std::size_t(element)])
        for (std::size_t c = 0; c < 3; ++c) out.greatest_stress_at[c] += parts_->mesh->nodes[std::size_t(n)][c] / 8;
    out.kernel = kernels<R>().name;
    return out;
  });
}

}  // namespace calomel
