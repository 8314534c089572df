#include "forward/solver/explicit_solver.hpp"

#include <fmt/format.h>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#include <barrier>
#include <chrono>
#include <cmath>
#include <mutex>
#include <thread>

#include "base/parallel.hpp"
#include "forward/solver/aligned_array.hpp"
#include "forward/solver/hexahedron.hpp"
#include "forward/solver/kernel.hpp"
#include "forward/solver/layout.hpp"

namespace calomel {

double stable_time_step(double eigenvalue, double beta) {
  const double omega = std::sqrt(eigenvalue), xi = 0.5 * beta * omega;
  return 2 / omega * (std::sqrt(1 + xi * xi) - xi);
}

namespace {

constexpr double unlimited = 1e30;  // a cutoff that is never reached, finite in single precision

Corners corners_of(const Mesh& mesh, std::size_t e) {
  Corners x;
  for (int k = 0; k < 8; ++k) x.col(k) = Eigen::Map<const Eigen::Vector3d>(mesh.nodes[std::size_t(mesh.elements[e][std::size_t(k)])].data());
  return x;
}

std::array<std::uint8_t, 8> fixed_of(const Mesh& mesh, std::size_t e) {
  std::array<std::uint8_t, 8> f{};
  for (std::size_t k = 0; k < 8; ++k) f[k] = mesh.fixed[std::size_t(mesh.elements[e][k])];
  return f;
}

/// A mesh in the form that the kernels read, for one precision and one use of the lanes.
template <class R>
struct Packed {
  bool runs;
  Layout layout;
  std::vector<AlignedArray<R>> geometry;                    ///< per block
  std::vector<std::vector<std::uint16_t>> connectivity;     ///< per block, by groups of lanes
  std::vector<std::vector<std::int32_t>> elements;          ///< per block, mesh element of every lane slot, -1 = padding

  /// `stiffness`: per element, the share of its stiffness that it keeps.
  Packed(const Mesh& mesh, const LinearElastic& steel, const std::vector<std::uint8_t>& parallelepiped, const std::vector<float>& stiffness, bool lanes_are_runs, int threads)
      : runs(lanes_are_runs), layout(make_layout(mesh, parallelepiped, lanes_are_runs ? 256 : 2048)) {
    const std::size_t lanes = runs ? 1 : std::size_t(kernels<R>().lanes), blocks = layout.blocks.size();
    geometry.resize(blocks), connectivity.resize(blocks), elements.resize(blocks);
    parallel_for(blocks, threads, [&](std::size_t b) {
      const Block& block = layout.blocks[b];
      const std::size_t terms = std::size_t(geometry_terms(block.liquid, block.parallelepiped));
      const std::size_t groups = (block.elements.size() + lanes - 1) / lanes;
      geometry[b] = AlignedArray<R>(groups * lanes * terms);
      connectivity[b].resize(groups * lanes * 8);
      elements[b].assign(groups * lanes, -1);
      for (std::size_t slot = 0; slot < groups * lanes; ++slot) {
        const std::size_t group = slot / lanes, lane = slot % lanes;
        const bool padding = slot >= block.elements.size();
        const std::size_t source = padding ? group * lanes : slot;
        for (std::size_t k = 0; k < 8; ++k) connectivity[b][(group * 8 + k) * lanes + lane] = block.connectivity[source * 8 + k];
        if (padding) continue;  // zero geometry: no force
        elements[b][slot] = block.elements[slot];
        std::size_t term = 0;
        const auto put = [&](double value) { geometry[b][(group * terms + term++) * lanes + lane] = R(value); };
        const HexGeometry g = hex_geometry(corners_of(mesh, std::size_t(block.elements[slot])));
        for (int i = 0; i < 3; ++i) {
          if (block.parallelepiped)
            for (const int m : linear_modes) put(g.mode_gradient(i, m - 1));
          else
            for (int m = 1; m < 8; ++m) put(g.mode_gradient(i, m - 1));
        }
        const double share = double(stiffness[std::size_t(block.elements[slot])]);
        put(share * g.volume);  // the force's volume; masses are kept apart
        if (block.liquid) put(liquid_hourglass(g));
        if (!block.parallelepiped)
          for (int i = 0; i < 3; ++i)
            for (int a = 0; a < 4; ++a) put(g.hourglass(i, a));
        if (!block.liquid) {
          const HourglassStiffness k = hourglass_stiffness(g, steel);
          for (int i = 0; i < 9; ++i)
            for (int j = i; j < 9; ++j) put(share * k.bending(i, j));
          for (int i = 0; i < 3; ++i)
            for (int j = i; j < 3; ++j) put(share * k.last(i, j));
        }
        expect(term == terms, "every geometry term of an element is packed");
      }
    });
  }
};

/// Denormals are flushed while waves arrive in untouched ground; restores the mode at the end.
class FlushDenormals {
#if defined(__x86_64__)
 public:
  FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040); }
  ~FlushDenormals() { _mm_setcsr(before_); }

 private:
  unsigned before_;
#endif
};

}  // namespace

struct ExplicitSolver::Parts {
  const Mesh* mesh;
  LinearElastic steel;
  std::vector<std::uint8_t> parallelepiped;
  std::vector<float> stiffness;  ///< per mesh element, share that is kept: below 1 at re-entrant edges of the steel
  double liquid_eigenvalue = 0;  ///< / c^2
  double steel_eigenvalue = 0;   ///< x density
  std::vector<double> steel_volume, liquid_volume;  ///< per mesh node, an eighth of each element [m^3]

  // Made when first needed; the lock only guards the making.
  mutable std::mutex lock;
  mutable std::unique_ptr<Packed<float>> single[2];
  mutable std::unique_ptr<Packed<double>> twice[2];
  int threads;

  template <class R>
  const Packed<R>& packed(bool runs) const {
    const std::lock_guard guard(lock);
    auto& slot = [&]() -> auto& {
      if constexpr (std::is_same_v<R, float>) return single[runs];
      else return twice[runs];
    }();
    if (!slot) slot = std::make_unique<Packed<R>>(*mesh, steel, parallelepiped, stiffness, runs, threads);
    return *slot;
  }

  template <class R>
  SolveSummary solve(const RunSetup& setup, std::span<const ObservationRow> rows, const SolveOptions& options, int steps_per_output) const;
  template <class R>
  FieldSnapshot snapshot(const Packed<R>& packed, const RunSetup& setup, const R* u, const R* v, double time, double load, double beta) const;
};

ExplicitSolver::ExplicitSolver(const Mesh& mesh, const LinearElastic& steel, int threads, double softening) : parts_(std::make_unique<Parts>()) {
  Parts& p = *parts_;
  p.mesh = &mesh;
  p.steel = steel;
  p.threads = threads;
  const std::size_t n = mesh.elements.size();
  p.parallelepiped.resize(n);
  p.stiffness.assign(n, 1.0f);
  if (softening != 0) {
    const auto reentrant = reentrant_elements(mesh);
    for (std::size_t e = 0; e < n; ++e)
      if (reentrant[e]) p.stiffness[e] = float(1 - softening);
  }
  p.steel_volume.assign(mesh.nodes.size(), 0), p.liquid_volume.assign(mesh.nodes.size(), 0);
  std::vector<double> volume(n), eigenvalue(n);
  parallel_for((n + 1023) / 1024, threads, [&](std::size_t chunk) {
    for (std::size_t e = chunk * 1024; e < std::min(n, (chunk + 1) * 1024); ++e) {
      const HexGeometry g = hex_geometry(corners_of(mesh, e));
      if (!(g.volume > 0)) throw InputError({.problem = fmt::format("element {} is inverted (volume {:.3g} m^3)", e, g.volume), .key = "geometry"});
      p.parallelepiped[e] = g.parallelepiped;
      volume[e] = g.volume;
      eigenvalue[e] = mesh.region[e] == Region::mercury ? liquid_eigenvalue(g, fixed_of(mesh, e)) : steel_eigenvalue(g, steel, hourglass_stiffness(g, steel), fixed_of(mesh, e));
    }
  });
  for (std::size_t e = 0; e < n; ++e) {
    const bool liquid = mesh.region[e] == Region::mercury;
    auto& greatest = liquid ? p.liquid_eigenvalue : p.steel_eigenvalue;
    greatest = std::max(greatest, eigenvalue[e]);
    for (const NodeId node : mesh.elements[e]) (liquid ? p.liquid_volume : p.steel_volume)[std::size_t(node)] += volume[e] / 8;
  }
}
ExplicitSolver::~ExplicitSolver() = default;
ExplicitSolver::ExplicitSolver(ExplicitSolver&&) noexcept = default;
const Mesh& ExplicitSolver::mesh() const { return *parts_->mesh; }

double ExplicitSolver::stable_step(const RunSetup& s) const {
  double step = 1e300;
  if (parts_->steel_eigenvalue > 0) step = std::min(step, stable_time_step(parts_->steel_eigenvalue / s.steel_density, 0));
  if (parts_->liquid_eigenvalue > 0) {
    const double k = s.liquid.bulk_modulus;
    if (!(k > 0) || !std::isfinite(k)) throw NumericsError(fmt::format("the liquid's bulk modulus vanishes (K = {:.3g} Pa): nothing resists compression", k));
    step = std::min(step, stable_time_step(parts_->liquid_eigenvalue * k / s.liquid_density * std::max(1.0, s.hourglass), s.liquid.viscosity / k));
  }
  if (!(step > 1e-12)) throw NumericsError(fmt::format("the stable time step collapses ({:.3g} s)", step));
  return step;
}

int ExplicitSolver::steps_per_output(const RunSetup& s, double safety) const {
  const double step = safety * stable_step(s), ratio = s.output_interval / step;
  if (ratio > 1e6) throw NumericsError(fmt::format("the stable time step {:.3g} s is more than a million times below the output interval", step));
  return std::max(1, int(std::ceil(ratio)));
}

SolveSummary ExplicitSolver::solve(const RunSetup& setup, std::span<const ObservationRow> rows, const SolveOptions& options) const {
  expect(!setup.energies.empty() && setup.energies.size() <= std::size_t(run_lanes), "one to eight runs in a group");
  expect(!options.booking || setup.energies.size() == 1, "energy is booked in single runs");
  const int per_output = steps_per_output(setup, options.time_step_safety);
  return options.precision == "single" ? parts_->solve<float>(setup, rows, options, per_output) : parts_->solve<double>(setup, rows, options, per_output);
}

template <class R>
FieldSnapshot ExplicitSolver::Parts::snapshot(const Packed<R>& packed, const RunSetup& setup, const R* u, const R* v, double time, double load, double beta) const {
  FieldSnapshot f;
  f.time = time;
  const std::size_t nodes = mesh->nodes.size(), count = mesh->elements.size();
  const std::size_t width = packed.runs ? 3 * run_lanes : 4, stride = packed.runs ? run_lanes : 1;
  f.displacement.resize(nodes), f.velocity.resize(nodes), f.pressure.resize(count), f.effective_stress.resize(count);
  for (std::size_t n = 0; n < nodes; ++n)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t at = std::size_t(packed.layout.to_solver[n]) * width + c * stride;
      f.displacement[n][c] = double(u[at]), f.velocity[n][c] = double(v[at]);
    }
  for (std::size_t e = 0; e < count; ++e) {
    const HexGeometry g = hex_geometry(corners_of(*mesh, e));
    Eigen::Matrix3d grad = Eigen::Matrix3d::Zero();
    double rate = 0;
    for (int k = 0; k < 8; ++k) {
      const auto n = std::size_t(mesh->elements[e][std::size_t(k)]);
      grad += Eigen::Map<const Eigen::Vector3d>(f.displacement[n].data()) * g.gradient.col(k).transpose();
      rate += Eigen::Map<const Eigen::Vector3d>(f.velocity[n].data()).dot(g.gradient.col(k));
    }
    if (mesh->region[e] == Region::mercury) {
      const double p0 = setup.p0.empty() ? 0 : setup.p0[e] * load;
      f.pressure[e] = std::max(p0 - setup.liquid.bulk_modulus * (grad.trace() + beta * rate), -setup.liquid.tensile_cutoff);
    } else {
      const Eigen::Matrix3d strain = 0.5 * (grad + grad.transpose());
      const Eigen::Matrix3d stress = steel.lambda * strain.trace() * Eigen::Matrix3d::Identity() + 2 * steel.mu * strain;
      const Eigen::Matrix3d deviator = stress - stress.trace() / 3 * Eigen::Matrix3d::Identity();
      f.pressure[e] = -stress.trace() / 3;
      f.effective_stress[e] = std::sqrt(1.5) * deviator.norm();
    }
  }
  return f;
}

template <class R>
SolveSummary ExplicitSolver::Parts::solve(const RunSetup& setup, std::span<const ObservationRow> rows, const SolveOptions& options, int per_output) const {
  const bool runs = setup.energies.size() > 1;
  const Packed<R>& p = packed<R>(runs);
  const Layout& layout = p.layout;
  const KernelTable<R>& kernel = kernels<R>();
  const std::size_t width = runs ? 3 * run_lanes : 4, lanes = runs ? 1 : std::size_t(kernel.lanes), blocks = layout.blocks.size();
  const std::size_t nodes = std::size_t(layout.nodes), lane_stride = runs ? run_lanes : 1;
  const bool stateful = options.booking || setup.quadratic_viscosity > 0;

  // Nodal masses.
  AlignedArray<R> inverse_mass(nodes);
  std::vector<double> mass(nodes);
  for (std::size_t n = 0; n < nodes; ++n) {
    const auto s = std::size_t(layout.to_solver[n]);
    mass[s] = setup.steel_density * steel_volume[n] + setup.liquid_density * liquid_volume[n];
    inverse_mass[s] = R(1 / mass[s]);
  }

  // Blocks with this run's heating and, when booked, their state.
  std::vector<AlignedArray<R>> p0(blocks), state(blocks);
  std::vector<BlockData<R>> data(blocks);
  std::size_t scratch_rows = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    const Block& block = layout.blocks[b];
    const std::size_t slots = p.elements[b].size();
    if (block.liquid) {
      p0[b] = AlignedArray<R>(slots);
      for (std::size_t i = 0; i < slots; ++i)
        if (p.elements[b][i] >= 0 && !setup.p0.empty()) p0[b][i] = R(setup.p0[std::size_t(p.elements[b][i])]);
      if (stateful) state[b] = AlignedArray<R>(runs ? slots * run_state * run_lanes : slots * element_state);
    }
    data[b] = {block.liquid, block.parallelepiped, std::int32_t(slots / lanes), p.geometry[b].data(), p.connectivity[b].data(), p0[b].data(), state[b].data(),
               block.first_node, block.interior, block.ranges.data(), std::int32_t(block.ranges.size()), block.shared.data(), std::int32_t(block.shared.size()), block.outbox};
    scratch_rows = std::max(scratch_rows, std::size_t(block.interior) + block.shared.size());
  }

  // Rules of special nodes.
  std::vector<SpecialData<R>> rules;
  for (const auto& s : layout.special) {
    SpecialData<R> r{};
    r.node = s.node, r.partner = s.partner, r.normals = s.normals;
    r.fixed_node = layout.fixed[std::size_t(s.node)];
    r.mass_node = R(mass[std::size_t(s.node)]);
    if (s.partner >= 0) r.fixed_partner = layout.fixed[std::size_t(s.partner)], r.mass_partner = R(mass[std::size_t(s.partner)]);
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t c = 0; c < 3; ++c) r.normal[k][c] = R(s.normal[k][c]);
    if (s.rear >= 0) {
      const BoundaryNode& n = layout.rear[std::size_t(s.rear)];
      const double area = std::sqrt(n.area[0] * n.area[0] + n.area[1] * n.area[1] + n.area[2] * n.area[2]);
      r.rear_area = R(area);
      for (std::size_t c = 0; c < 3; ++c) r.rear_normal[c] = R(n.area[c] / area);
      if (options.heated_rear && setup.p0_at) r.rear_p0 = R(setup.p0_at(mesh->nodes[std::size_t(n.node)]));
    }
    if (s.loaded >= 0)
      for (std::size_t c = 0; c < 3; ++c) r.load_area[c] = R(layout.loaded[std::size_t(s.loaded)].area[c]);
    rules.push_back(r);
  }

  AlignedArray<R> u(nodes * width), v(nodes * width), outbox(layout.outbox_size * width);
  const auto start_from = [&](const std::vector<Vec3>& field, R* to) {
    for (std::size_t n = 0; n < field.size(); ++n)
      for (std::size_t c = 0; c < 3; ++c)
        if (!(mesh->fixed[n] & (1 << c)))
          for (std::size_t l = 0; l < lane_stride; ++l) to[std::size_t(layout.to_solver[n]) * width + c * lane_stride + l] = R(field[n][c]);
  };
  start_from(setup.initial_displacement, u.data());
  start_from(setup.initial_velocity, v.data());
  const int threads = std::max(1, std::min<int>(options.threads, int(blocks)));
  std::vector<AlignedArray<R>> scratch;
  for (int t = 0; t < threads; ++t) scratch.emplace_back(scratch_rows * 2 * width + 64);

  const double dt = setup.output_interval / per_output, k = setup.liquid.bulk_modulus;
  const auto outputs = std::int64_t(std::llround(setup.end / setup.output_interval));
  const std::int64_t steps = outputs * per_output;
  const double beta = k > 0 ? setup.liquid.viscosity / k : 0, h = mesh->liquid_element_size;
  StepData<R> base{};
  base.u = u.data(), base.v = v.data(), base.inverse_mass = inverse_mass.data(), base.outbox = outbox.data();
  base.dt = R(dt), base.kick = R(dt);
  base.bulk_modulus = R(k), base.cutoff = R(std::min(setup.liquid.tensile_cutoff, unlimited)), base.beta = R(beta), base.hourglass = R(setup.hourglass * k);
  base.quadratic = R(setup.liquid_density * setup.quadratic_viscosity * setup.quadratic_viscosity * h * h);
  base.impedance = R(std::sqrt(k * setup.liquid_density));
  base.lambda = R(setup.steel.lambda), base.mu = R(setup.steel.mu);
  const auto ramp = [&](double t) { return setup.pulse_length > 0 ? std::clamp(t / setup.pulse_length, 0.0, 1.0) : 1.0; };
  const auto energy_of = [&](std::size_t lane) { return setup.energies[std::min(lane, setup.energies.size() - 1)]; };
  const auto at_step = [&](StepData<R>& s, std::int64_t n) {
    for (std::size_t l = 0; l < run_lanes; ++l) {
      s.load[l] = R(ramp(double(n) * dt) * energy_of(l));
      s.load_before[l] = n > 0 ? R(ramp(double(n - 1) * dt) * energy_of(l)) : R(0);
      s.end_stress[l] = R(setup.end_stress.at(double(n) * dt) * energy_of(l));
    }
    s.kick = n == 0 ? R(dt / 2) : R(dt);
  };

  SolveSummary out;
  const std::int64_t sample_every = options.every_step ? 1 : per_output;
  const std::size_t samples = std::size_t(steps / sample_every) + 1, run_count = setup.energies.size();
  out.times.resize(samples);
  out.observations.assign(run_count * rows.size() * samples, 0);
  const auto observe = [&](std::int64_t n) {
    const std::size_t sample = std::size_t(n / sample_every);
    out.times[sample] = options.every_step ? double(n) * dt : double(n / per_output) * setup.output_interval;
    for (std::size_t r = 0; r < rows.size(); ++r)
      for (std::size_t l = 0; l < run_count; ++l) {
        double value = 0;
        for (std::size_t i = 0; i < rows[r].nodes.size(); ++i) {
          const R* at = u.data() + std::size_t(layout.to_solver[std::size_t(rows[r].nodes[i])]) * width + l;
          for (std::size_t c = 0; c < 3; ++c) value += rows[r].weights[i][c] * double(at[c * lane_stride]);
        }
        out.observations[(l * rows.size() + r) * samples + sample] = value;
      }
  };
  const auto check_finite = [&](std::int64_t n) {
    for (std::size_t i = 0; i < nodes * width; ++i)
      if (!std::isfinite(u[i]) || std::abs(u[i]) > R(1)) {
        const auto solver_node = std::int32_t(i / width);
        std::size_t node = 0;
        while (layout.to_solver[node] != solver_node) ++node;
        const auto& x = mesh->nodes[node];
        std::size_t element = 0;
        for (std::size_t e = 0; e < mesh->elements.size() && element == 0; ++e)
          for (const NodeId m : mesh->elements[e])
            if (std::size_t(m) == node) element = e;
        throw NumericsError(fmt::format("the displacements leave all bounds at step {} ({:.4g} s), node {} at ({:.4g}, {:.4g}, {:.4g}) m of {} element {}; step {:.3g} s, K {:.4g} Pa, density {:.5g} kg/m^3",
                                        n, double(n) * dt, node, x[0], x[1], x[2], mesh->region[element] == Region::mercury ? "mercury" : "steel", element, dt, k, setup.liquid_density));
      }
  };

  // Contiguous shares of blocks by cost, and of the shared nodes.
  std::vector<double> cost(blocks + 1, 0);
  for (std::size_t b = 0; b < blocks; ++b) cost[b + 1] = cost[b] + double(layout.blocks[b].elements.size()) * (layout.blocks[b].liquid ? 1.0 : 1.8) * (layout.blocks[b].parallelepiped ? 0.7 : 1.0);
  const auto first_block = [&](int t) { return std::size_t(std::lower_bound(cost.begin(), cost.end(), cost.back() * t / threads - 1e-9) - cost.begin()); };
  constexpr std::size_t chunk = 512;
  const std::size_t plain_chunks = (layout.plain.size() + chunk - 1) / chunk, special_chunks = (rules.size() + chunk - 1) / chunk;
  std::vector<EnergyTerms> energies(blocks + plain_chunks + special_chunks);

  std::barrier<> sync(threads);
  std::exception_ptr error;
  std::atomic<bool> halt{false};
  double dissipated = 0, heat = 0, boundary = 0, initial = 0, worst = 0, scale = 0, hourglass = 0;
  const bool has_initial_state = !setup.initial_displacement.empty() || !setup.initial_velocity.empty();
  const std::int64_t field_every = options.field_interval > 0 ? std::max<std::int64_t>(1, std::llround(options.field_interval / setup.output_interval)) * per_output : 0;
  const auto started = std::chrono::steady_clock::now();

  const auto work = [&](int t) {
    const FlushDenormals flush;
    StepData<R> s = base;
    s.scratch = scratch[std::size_t(t)].data();
    const std::size_t b0 = first_block(t), b1 = t + 1 == threads ? blocks : first_block(t + 1);
    for (std::int64_t n = 0;; ++n) {
      if (n % sample_every == 0 || n % per_output == 0) {
        if (t == 0) try {
            if (n % sample_every == 0) observe(n);
            if (n % (std::int64_t(per_output) * 16) == 0 || n == steps) check_finite(n);
            if (field_every > 0 && options.on_field && (n % field_every == 0 || n == steps))
              options.on_field(snapshot(p, setup, u.data(), v.data(), double(n) * dt, ramp(double(n) * dt) * setup.energies[0], beta));
            if (options.on_progress && n % per_output == 0) options.on_progress(double(n) / double(std::max<std::int64_t>(1, steps)));
            if (options.stop && *options.stop) throw Interrupted();
          } catch (...) {
            error = std::current_exception();
            halt = true;
          }
        if (threads > 1) sync.arrive_and_wait();
        if (halt) return;
      }
      if (n == steps) return;
      at_step(s, n);
      for (std::size_t b = b0; b < b1; ++b) {
        if (runs) kernel.run_block(data[b], s, stateful);
        else energies[b] = {}, kernel.element_block(data[b], s, stateful, &energies[b]);
      }
      if (threads > 1) sync.arrive_and_wait();
      for (std::size_t c = std::size_t(t); c < plain_chunks; c += std::size_t(threads)) {
        const std::size_t begin = c * chunk, end = std::min(layout.plain.size(), begin + chunk);
        if (runs) kernel.run_plain(layout, begin, end, s);
        else energies[blocks + c] = {}, kernel.element_plain(layout, begin, end, s, stateful, &energies[blocks + c]);
      }
      for (std::size_t c = std::size_t(t); c < special_chunks; c += std::size_t(threads)) {
        const std::size_t begin = c * chunk, end = std::min(rules.size(), begin + chunk);
        auto& e = energies[blocks + plain_chunks + c];
        if (runs) kernel.run_special(layout, rules.data(), begin, end, s);
        else e = {}, kernel.element_special(layout, rules.data(), begin, end, s, stateful, &e);
      }
      if (threads > 1) sync.arrive_and_wait();
      if (options.booking && t == 0) {
        EnergyTerms sum;
        for (const auto& e : energies) sum.add(e);
        dissipated += sum.dissipated, heat += sum.heat, boundary += sum.boundary_before;
        const double stored = sum.kinetic + sum.liquid + sum.hourglass + sum.steel;
        // An initial state brings its own energy; its velocity is that of t = 0, so that 1/2 v- M v+ holds from step 1 on.
        if (has_initial_state && n <= 1) initial = stored + dissipated + boundary - heat;
        worst = std::max(worst, std::abs(stored + dissipated + boundary - heat - initial));
        scale = std::max({scale, heat, stored});
        hourglass = std::max(hourglass, sum.hourglass);
        boundary += sum.boundary_after;
      }
      if (options.booking && threads > 1) sync.arrive_and_wait();
    }
  };
  {
    std::vector<std::jthread> pool;
    for (int t = 1; t < threads; ++t) pool.emplace_back(work, t);
    work(0);
  }
  if (error) std::rethrow_exception(error);
  out.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  out.steps = steps;
  out.time_step = dt;
  out.element_steps_per_second = double(mesh->elements.size()) * double(run_count) * double(steps) / out.wall_seconds;
  out.energy_balance_error = options.booking ? (scale > 0 ? worst / scale : 0) : std::nan("");
  out.hourglass_share = scale > 0 ? hourglass / scale : 0;
  const bool end_load = !setup.end_stress.time.empty();  // a bar has no rear face: what goes out there is the load's work
  out.energy_in = heat + initial - (end_load ? boundary : 0);
  out.dissipated = dissipated, out.radiated = end_load ? 0 : boundary;
  out.kernel = kernel.name;
  return out;
}

}  // namespace calomel
