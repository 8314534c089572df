// The inner loops, included once by each kernel_<isa>.cpp inside its own namespace CALOMEL_ISA, so that code for different
// instruction sets never mixes. No standard-library calls in here.
#include <type_traits>

#include "forward/solver/kernel.hpp"

#define CALOMEL_INLINE inline __attribute__((always_inline))

namespace calomel::CALOMEL_ISA {

#include "forward/solver/kernel_simd.hpp"
#include "forward/solver/kernel_elements.hpp"
#include "forward/solver/kernel_plane.hpp"
#include "forward/solver/kernel_nodes.hpp"

/// Copies u + beta v of a block's nodes to scratch and clears its forces. Rows are padded to whole vectors.
template <class R, bool Runs>
CALOMEL_INLINE void copy_in(const BlockData<R>& b, const StepData<R>& s, R of_u, R of_v, R* w, R* f) {
  constexpr int width = Row<R, Runs>::width;
  const R* u = s.u + std::size_t(b.first_node) * width;
  const R* v = s.v + std::size_t(b.first_node) * width;
  if (of_u == 1)  // u + 0 v would cost no less
    for (std::size_t k = 0; k < std::size_t(b.interior) * width; ++k) w[k] = u[k] + of_v * v[k];
  else
    for (std::size_t k = 0; k < std::size_t(b.interior) * width; ++k) w[k] = of_u * u[k] + of_v * v[k];
  for (std::int32_t i = 0; i < b.shared_count; ++i) {
    const std::size_t from = std::size_t(b.shared[i]) * width, to = std::size_t(b.interior + i) * width;
    for (int k = 0; k < width; ++k) w[to + k] = of_u * s.u[from + k] + of_v * s.v[from + k];
  }
  __builtin_memset(f, 0, sizeof(R) * std::size_t(b.interior + b.shared_count) * width);
}

/// Adds what the steel's branches answer beside u.
template <class R, bool Runs>
CALOMEL_INLINE void add_relaxing(const BlockData<R>& b, const StepData<R>& s, R* w) {
  constexpr int width = Row<R, Runs>::width;
  const R* x = s.relaxing + std::size_t(b.first_node) * width;
  for (std::size_t k = 0; k < std::size_t(b.interior) * width; ++k) w[k] += x[k];
  for (std::int32_t i = 0; i < b.shared_count; ++i) {
    const std::size_t from = std::size_t(b.shared[i]) * width, to = std::size_t(b.interior + i) * width;
    for (int k = 0; k < width; ++k) w[to + k] += s.relaxing[from + k];
  }
}

/// Modes of the corners of an element, or forces on them: (component, mode).
template <Form F, class V>
struct ModesOf {
  using type = V[3][8];
};
template <class V>
struct ModesOf<Form::plane, V> {
  using type = V[2][3];  // x and z
};

/// How lanes are filled from a block: W elements of one run, or one element of eight runs.
template <class R, bool Runs>
struct Lanes {
  static constexpr int width = Runs ? run_lanes : element_lanes<R>;
  static constexpr int per_group = Runs ? 1 : width;  ///< elements of a group
  using V = std::conditional_t<Runs, LaneVec<R, width>, Vec<R, width>>;

  static CALOMEL_INLINE auto coefficients(const R* geometry) {
    return [geometry](int k) __attribute__((always_inline))->V {
      if constexpr (Runs)
        return geometry[k] + V{};
      else
        return load<V>(geometry + k * width);
    };
  }
  static CALOMEL_INLINE void modes(const R* w, const std::uint16_t* at, V (&um)[3][8]) {
    if constexpr (Runs) {
      V u[8];
      for (int c = 0; c < 3; ++c) {
        for (int n = 0; n < 8; ++n) u[n] = load<V>(w + std::size_t(at[n]) * (3 * width) + std::size_t(c) * width);
        to_modes(u, um[c]);
      }
    } else {
      V u[3][8];
      for (int n = 0; n < 8; ++n) gather_rows(w, at + std::size_t(n) * width, u[0][n], u[1][n], u[2][n]);
      for (int c = 0; c < 3; ++c) to_modes(u[c], um[c]);
    }
  }
  static CALOMEL_INLINE void modes(const R* w, const std::uint16_t* at, V (&um)[2][3]) {
    V u[4];
    for (int c = 0; c < 2; ++c) {
      for (int n = 0; n < 4; ++n) u[n] = load<V>(w + std::size_t(at[n]) * (3 * width) + std::size_t(2 * c) * width);
      to_plane_modes(u, um[c]);
    }
  }
  static CALOMEL_INLINE void add_forces(const V (&fm)[2][3], R* force, const std::uint16_t* at) {
    V f[4];
    for (int c = 0; c < 2; ++c) {
      to_plane_corners(fm[c], f);
      for (int n = 0; n < 4; ++n) {
        R* p = force + std::size_t(at[n]) * (3 * width) + std::size_t(2 * c) * width;
        store(p, load<V>(p) + f[n]);
      }
    }
  }
  static CALOMEL_INLINE void add_forces(const V (&fm)[3][8], R* force, const std::uint16_t* at) {
    if constexpr (Runs) {
      V f[8];
      for (int c = 0; c < 3; ++c) {
        to_corners(fm[c], f);
        for (int n = 0; n < 8; ++n) {
          R* p = force + std::size_t(at[n]) * (3 * width) + std::size_t(c) * width;
          store(p, load<V>(p) + f[n]);
        }
      }
    } else {
      V f[3][8];
      for (int c = 0; c < 3; ++c) to_corners(fm[c], f[c]);
      for (int n = 0; n < 8; ++n) scatter_rows(force, at + std::size_t(n) * width, f[0][n], f[1][n], f[2][n]);
    }
  }
  /// One number of each element of a group.
  static CALOMEL_INLINE V numbers(const R* of_elements, std::int32_t group) {
    if constexpr (Runs)
      return of_elements[group] + V{};
    else
      return load<V>(of_elements + std::size_t(group) * width);
  }
  static CALOMEL_INLINE V heating(const R* p0, std::int32_t group, const R* share) {
    if constexpr (Runs)
      return p0[group] * load<V>(share);
    else
      return load<V>(p0 + std::size_t(group) * width) * share[0];
  }
};

template <class R, bool Runs>
CALOMEL_INLINE LiquidStep<typename Lanes<R, Runs>::V> liquid_step(const StepData<R>& s) {
  using V = typename Lanes<R, Runs>::V;
  LiquidStep<V> l;
  l.bulk_modulus = V{} + s.bulk_modulus;
  l.minus_cutoff = V{} - s.cutoff;
  l.cutoff = V{} + s.cutoff;
  l.hourglass = V{} + s.hourglass;
  l.ratio = V{} + (s.dt > 0 ? s.beta / s.dt : R(0));
  l.rate_factor = V{} + (s.dt > 0 ? 1 / s.dt : R(0));
  l.quadratic = V{} + s.quadratic;
  l.dt = V{} + s.dt;
  return l;
}

template <class R, bool Runs>
CALOMEL_INLINE void report_sums(const Sums<typename Lanes<R, Runs>::V>& sums, EnergyTerms* energy) {
  constexpr int W = Lanes<R, Runs>::width;
  energy->liquid += lane_sum<R, W>(sums.liquid);
  energy->dissipated += lane_sum<R, W>(sums.dissipated);
  energy->heat += lane_sum<R, W>(sums.heat);
  energy->hourglass += 0.5 * lane_sum<R, W>(sums.hourglass);
  energy->steel += 0.5 * lane_sum<R, W>(sums.steel);
}

/// Stressed: the block has a stress before the run, or heat in the steel.
template <class R, bool Runs, bool Liquid, Form F, Keep K, bool Stressed = false>
void elements(const BlockData<R>& b, const StepData<R>& s, const R* w, R* force, EnergyTerms* energy) {
  using L = Lanes<R, Runs>;
  using V = typename L::V;
  constexpr int terms = geometry_terms(Liquid, F), W = L::width;
  constexpr bool balance = K == Keep::energies;
  Sums<V> sums;
  LiquidStep<V> liquid = liquid_step<R, Runs>(s);
  const V lambda = V{} + s.lambda, mu = V{} + s.mu;
  for (std::int32_t g = 0; g < b.groups; ++g) {
    const std::uint16_t* at = b.connectivity + std::size_t(g) * corner_count(F) * L::per_group;
    const auto coefficient = L::coefficients(b.geometry + std::size_t(g) * terms * L::per_group);
    typename ModesOf<F, V>::type um, fm;
    L::modes(w, at, um);
    if constexpr (Liquid) {
      liquid.p0 = L::heating(b.p0, g, s.load);
      V* state = nullptr;
      if constexpr (K != Keep::nothing) {
        state = reinterpret_cast<V*>(b.state) + std::size_t(g) * liquid_state(K);
        liquid.collapse = s.collapse * L::numbers(b.size, g);
      } else if (b.size) {
        liquid.bulk_modulus = s.bulk_modulus + s.collapse * L::numbers(b.size, g);
      }
      if constexpr (balance) liquid.p0_before = L::heating(b.p0, g, s.load_before);
      if constexpr (Stressed) {
        const V initial = L::numbers(b.initial, g);
        liquid.p0 += initial;
        if constexpr (balance) liquid.p0_before += initial;
      }
      liquid_element<F, K, false>(um, fm, coefficient, liquid, state, sums);
    } else if constexpr (F == Form::dense) {
      dense_element<balance>(um, fm, coefficient, sums);
    } else {
      V* state = nullptr;
      if constexpr (balance) state = reinterpret_cast<V*>(b.state) + std::size_t(g) * steel_state;
      if constexpr (Stressed) {
        FreeStrain<V> free;
        free.thermal = L::heating(b.thermal, g, s.load);
        free.thermal_before = L::heating(b.thermal, g, s.load_before);
        const auto initial = L::coefficients(b.initial + std::size_t(g) * 6 * L::per_group);
        for (int k = 0; k < 6; ++k) free.initial[k] = initial(k);
        free.trace = balance && b.trace ? reinterpret_cast<V*>(b.trace) + std::size_t(g) : nullptr;
        steel_element<F, balance, true>(um, fm, coefficient, lambda, mu, state, sums, &free);
      } else {
        steel_element<F, balance>(um, fm, coefficient, lambda, mu, state, sums);
      }
    }
    L::add_forces(fm, force, at);
  }
  if constexpr (balance) report_sums<R, Runs>(sums, energy);
  (void)W;
}

/// Liquid elements whose pressure is that of a law of its own: strains of a stretch of elements, the law, their forces.
template <class R, bool Runs, Form F, Keep K>
void law_elements(const BlockData<R>& b, const StepData<R>& s, const R* w, R* force, EnergyTerms* energy) {
  using L = Lanes<R, Runs>;
  using V = typename L::V;
  constexpr int terms = geometry_terms(true, F), W = L::width, stretch = 256 / W;
  constexpr bool balance = K == Keep::energies;
  alignas(64) double strain[256], heating[256];
  alignas(64) R lanes[2 * W];
  Sums<V> sums;
  LiquidStep<V> liquid = liquid_step<R, Runs>(s);
  const double ratio = s.dt > 0 ? double(s.beta) / double(s.dt) : 0;
  for (std::int32_t first = 0; first < b.groups; first += stretch) {
    const std::int32_t last = first + stretch < b.groups ? first + stretch : b.groups;
    const std::size_t count = std::size_t(last - first) * W, offset = std::size_t(first) * W;
    double* before = b.law.memory + offset;
    double* pressure = before + b.law.points;
    for (std::int32_t g = first; g < last; ++g) {
      typename ModesOf<F, V>::type um;
      L::modes(w, b.connectivity + std::size_t(g) * corner_count(F) * L::per_group, um);
      const V e = element_strain<F>(um, L::coefficients(b.geometry + std::size_t(g) * terms * L::per_group));
      V p0 = L::heating(b.p0, g, s.load);
      if (b.initial) p0 += L::numbers(b.initial, g);
      const std::size_t at = std::size_t(g - first) * W;
      // a loop over memory is one over whole vectors
      store(lanes, e);
      store(lanes + W, p0);
      for (std::size_t l = 0; l < W; ++l) strain[at + l] = (double(lanes[l]) + ratio * before[at + l]) / (1 + ratio), heating[at + l] = double(lanes[W + l]);
    }
    b.law.advance(b.law.law, {count, double(s.dt), strain, before, heating, pressure, pressure + b.law.points, b.law.points});
    for (std::int32_t g = first; g < last; ++g) {
      const std::uint16_t* at = b.connectivity + std::size_t(g) * corner_count(F) * L::per_group;
      for (std::size_t l = 0; l < W; ++l) lanes[l] = R(pressure[std::size_t(g - first) * W + l]);
      liquid.pressure = load<V>(lanes);
      typename ModesOf<F, V>::type um, fm;
      V* state = nullptr;
      if constexpr (K != Keep::nothing) {
        state = reinterpret_cast<V*>(b.state) + std::size_t(g) * liquid_state(K);
        liquid.collapse = s.collapse * L::numbers(b.size, g);
      }
      L::modes(w, at, um);
      liquid_element<F, K, true>(um, fm, L::coefficients(b.geometry + std::size_t(g) * terms * L::per_group), liquid, state, sums);
      L::add_forces(fm, force, at);
    }
    for (std::size_t i = 0; i < count; ++i) before[i] = strain[i];
  }
  if constexpr (balance) report_sums<R, Runs>(sums, energy);
}

template <class R, bool Runs, Keep K>
void stressed_forces(const BlockData<R>& b, const StepData<R>& s, const R* w, R* force, EnergyTerms* energy) {
  if constexpr (Runs)
    if (b.form == Form::plane)
      return b.liquid ? elements<R, Runs, true, Form::plane, K, true>(b, s, w, force, energy)
                      : elements<R, Runs, false, Form::plane, K, true>(b, s, w, force, energy);
  if (b.liquid) switch (b.form) {
      case Form::parallelepiped:
        return elements<R, Runs, true, Form::parallelepiped, K, true>(b, s, w, force, energy);
      case Form::finite:
        return elements<R, Runs, true, Form::finite, K, true>(b, s, w, force, energy);
      default:
        return elements<R, Runs, true, Form::general, K, true>(b, s, w, force, energy);
    }
  switch (b.form) {
    case Form::parallelepiped:
      return elements<R, Runs, false, Form::parallelepiped, K, true>(b, s, w, force, energy);
    case Form::finite:
      return elements<R, Runs, false, Form::finite, K, true>(b, s, w, force, energy);
    default:
      return elements<R, Runs, false, Form::general, K, true>(b, s, w, force, energy);
  }
}

template <class R, bool Runs, Keep K>
void forces(const BlockData<R>& b, const StepData<R>& s, const R* w, R* force, EnergyTerms* energy) {
  if constexpr (Runs)
    if (b.form == Form::plane && b.law.advance) return law_elements<R, Runs, Form::plane, K>(b, s, w, force, energy);
  if (b.liquid && b.law.advance) switch (b.form) {
      case Form::parallelepiped:
        return law_elements<R, Runs, Form::parallelepiped, K>(b, s, w, force, energy);
      case Form::finite:
        return law_elements<R, Runs, Form::finite, K>(b, s, w, force, energy);
      default:
        return law_elements<R, Runs, Form::general, K>(b, s, w, force, energy);
    }
  if constexpr (K != Keep::nothing)  // of stressed runs something is always kept
    if (b.initial) return stressed_forces<R, Runs, K>(b, s, w, force, energy);
  if constexpr (Runs)
    if (b.form == Form::plane)
      return b.liquid ? elements<R, Runs, true, Form::plane, K>(b, s, w, force, energy) : elements<R, Runs, false, Form::plane, K>(b, s, w, force, energy);
  if (b.liquid) switch (b.form) {
      case Form::parallelepiped:
        return elements<R, Runs, true, Form::parallelepiped, K>(b, s, w, force, energy);
      case Form::finite:
        return elements<R, Runs, true, Form::finite, K>(b, s, w, force, energy);
      default:
        return elements<R, Runs, true, Form::general, K>(b, s, w, force, energy);
    }
  switch (b.form) {
    case Form::parallelepiped:
      return elements<R, Runs, false, Form::parallelepiped, K>(b, s, w, force, energy);
    case Form::finite:
      return elements<R, Runs, false, Form::finite, K>(b, s, w, force, energy);
    case Form::dense:
      return elements<R, Runs, false, Form::dense, K>(b, s, w, force, energy);
    default:
      return elements<R, Runs, false, Form::general, K>(b, s, w, force, energy);
  }
}

/// Damped steel: u.K u / 2 is stored, beta v.K v a second dissipated; in a branch share x.K x / 2 and share x.K x / time. All from passes of their own, for the
/// energy balance only. Force and way of a step are half a step apart: of what is dissipated so far, beta dt v.K v / 4 is still to be done; of a branch, whose
/// x is one of the step's end, half a step's.
template <class R>
void book_damped_steel(const BlockData<R>& b, const StepData<R>& s, R* w, R* force, EnergyTerms* energy) {
  EnergyTerms of_u, of_v;
  copy_in<R, false>(b, s, R(1), R(0), w, force);
  forces<R, false, Keep::energies>(b, s, w, force, &of_u);
  copy_in<R, false>(b, s, R(0), s.dt, w, force);  // dt v, the change in a step
  BlockData<R> unstressed = b;
  unstressed.initial = nullptr;
  forces<R, false, Keep::energies>(unstressed, s, w, force, &of_v);
  const double rate = double(s.steel_beta) / double(s.dt);
  energy->steel += of_u.steel - 0.5 * rate * of_v.steel;
  energy->dissipated += 2 * rate * of_v.steel;
  energy->heat += of_u.heat;
  for (int k = 0; k < s.branch_count; ++k) {
    StepData<R> in_branch = s;
    in_branch.u = s.branches[k].x;
    EnergyTerms of_x;
    copy_in<R, false>(b, in_branch, R(1), R(0), w, force);
    forces<R, false, Keep::energies>(unstressed, s, w, force, &of_x);
    const double stored = s.branches[k].share * of_x.steel, lost = 2 * stored * double(s.dt) / s.branches[k].time;
    energy->steel += stored - 0.5 * lost;
    energy->dissipated += lost;
  }
}

template <class R, bool Runs, Keep K>
void block(const BlockData<R>& b, const StepData<R>& s, EnergyTerms* energy) {
  constexpr int width = Row<R, Runs>::width;
  R* w = s.scratch;
  R* force = w + std::size_t(b.interior + b.shared_count) * width;
  const R beta = b.liquid ? s.beta : s.steel_beta;
  constexpr bool balance = K == Keep::energies;
  const bool relaxes = !b.liquid && s.relaxing, damped = balance && !b.liquid && (beta != 0 || relaxes);
  if constexpr (balance)
    if (damped) book_damped_steel(b, s, w, force, energy);
  copy_in<R, Runs>(b, s, R(1), beta, w, force);
  if (relaxes) add_relaxing<R, Runs>(b, s, w);
  EnergyTerms here;
  if (damped && b.trace) {
    BlockData<R> balanced = b;
    balanced.trace = nullptr;  // its heat is counted already
    forces<R, Runs, K>(balanced, s, w, force, &here);
  } else {
    forces<R, Runs, K>(b, s, w, force, &here);
  }
  if constexpr (balance)
    if (!damped) energy->add(here);
  double kinetic = 0;
  advance_interior<R, Runs, balance>(b, s, force, kinetic);
  if (balance) energy->kinetic += kinetic;
  const R* shared = force + std::size_t(b.interior) * width;
  R* out = s.outbox + b.outbox * width;
  if (s.outbox_scale == 1)
    __builtin_memcpy(out, shared, sizeof(R) * std::size_t(b.shared_count) * width);
  else
    for (std::size_t k = 0; k < std::size_t(b.shared_count) * width; ++k) out[k] = s.outbox_scale * shared[k];
}

template <class R>
const KernelTable<R>& table() {
  static const KernelTable<R> t{
      CALOMEL_ISA_NAME,
      element_lanes<R>,
      [](const BlockData<R>& b, const StepData<R>& s, Keep keep, EnergyTerms* e) {
        switch (keep) {
          case Keep::energies:
            return block<R, false, Keep::energies>(b, s, e);
          case Keep::rate:
            return block<R, false, Keep::rate>(b, s, e);
          default:
            return block<R, false, Keep::nothing>(b, s, e);
        }
      },
      [](const BlockData<R>& b, const StepData<R>& s, Keep keep) {
        keep == Keep::nothing ? block<R, true, Keep::nothing>(b, s, nullptr) : block<R, true, Keep::rate>(b, s, nullptr);
      },
      [](const Layout& l, std::size_t begin, std::size_t end, const StepData<R>& s, bool energy_balance, EnergyTerms* e) {
        energy_balance ? plain<R, false, true>(l, begin, end, s, e) : plain<R, false, false>(l, begin, end, s, e);
      },
      [](const Layout& l, std::size_t begin, std::size_t end, const StepData<R>& s) { plain<R, true, false>(l, begin, end, s, nullptr); },
      [](const Layout& l, const SpecialData<R>* r, std::size_t begin, std::size_t end, const StepData<R>& s, bool energy_balance, EnergyTerms* e) {
        if (s.extras.strength)
          return energy_balance ? special_extended<R, false, true>(l, r, begin, end, s, e) : special_extended<R, false, false>(l, r, begin, end, s, e);
        energy_balance ? special<R, false, true>(l, r, begin, end, s, e) : special<R, false, false>(l, r, begin, end, s, e);
      },
      [](const Layout& l, const SpecialData<R>* r, std::size_t begin, std::size_t end, const StepData<R>& s) {
        s.extras.strength ? special_extended<R, true, false>(l, r, begin, end, s, nullptr) : special<R, true, false>(l, r, begin, end, s, nullptr);
      }};
  return t;
}

template const KernelTable<float>& table<float>();
template const KernelTable<double>& table<double>();

}  // namespace calomel::CALOMEL_ISA
