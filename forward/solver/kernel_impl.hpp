// The inner loops, included once by each kernel_<isa>.cpp inside its own namespace CALOMEL_ISA, so that code for different
// instruction sets never mixes. No standard-library calls in here.
#include "forward/solver/kernel.hpp"

namespace calomel::CALOMEL_ISA {

#define CALOMEL_INLINE inline __attribute__((always_inline))

template <class R, int W>
struct Simd {
  typedef R type __attribute__((vector_size(sizeof(R) * W)));
};
template <class R, int W>
using Vec = typename Simd<R, W>::type;

template <class R>
inline constexpr int element_lanes = sizeof(R) == 4 ? 8 : 4;

template <class V>
CALOMEL_INLINE V greater(V a, V b) {
  return a > b ? a : b;
}
template <class V, class R>
CALOMEL_INLINE V load(const R* p) {
  return *reinterpret_cast<const V*>(p);
}
template <class V, class R>
CALOMEL_INLINE void store(R* p, V v) {
  *reinterpret_cast<V*>(p) = v;
}
template <class R, int W>
CALOMEL_INLINE double lane_sum(Vec<R, W> v) {
  double s = 0;
  for (int l = 0; l < W; ++l) s += double(v[l]);
  return s;
}

// Walsh-Hadamard modes 1..7 of eight corner values (mode 0, the mean, is never needed), and the transpose.
template <class V>
CALOMEL_INLINE void to_modes(const V* n, V* m) {
  const V s0 = n[0] + n[1], d0 = n[1] - n[0], s1 = n[2] + n[3], d1 = n[3] - n[2];
  const V s2 = n[4] + n[5], d2 = n[5] - n[4], s3 = n[6] + n[7], d3 = n[7] - n[6];
  const V ss0 = s0 + s1, ts0 = s1 - s0, sd0 = d0 + d1, td0 = d1 - d0;
  const V ss1 = s2 + s3, ts1 = s3 - s2, sd1 = d2 + d3, td1 = d3 - d2;
  m[1] = sd0 + sd1, m[2] = ts0 + ts1, m[3] = td0 + td1;
  m[4] = ss1 - ss0, m[5] = sd1 - sd0, m[6] = ts1 - ts0, m[7] = td1 - td0;
}
template <class V>
CALOMEL_INLINE void to_corners(const V* m, V* n) {
  const V ss0 = -m[4], sd0 = m[1] - m[5], ts0 = m[2] - m[6], td0 = m[3] - m[7];
  const V ss1 = m[4], sd1 = m[1] + m[5], ts1 = m[2] + m[6], td1 = m[3] + m[7];
  const V s0 = ss0 - ts0, s1 = ss0 + ts0, d0 = sd0 - td0, d1 = sd0 + td0;
  const V s2 = ss1 - ts1, s3 = ss1 + ts1, d2 = sd1 - td1, d3 = sd1 + td1;
  n[0] = s0 - d0, n[1] = s0 + d0, n[2] = s1 - d1, n[3] = s1 + d1;
  n[4] = s2 - d2, n[5] = s2 + d2, n[6] = s3 - d3, n[7] = s3 + d3;
}

CALOMEL_INLINE constexpr int linear_mode(int j) { return 1 << j; }
CALOMEL_INLINE constexpr int hourglass_mode(int a) { return a == 0 ? 3 : a + 4; }

template <bool Affine, class V, class Geometry>
CALOMEL_INLINE void gradients(const V (&u)[3][8], Geometry g, V (&grad)[3][3]) {
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 3; ++i) {
      V s;
      if constexpr (Affine) {
        s = g(i * 3) * u[c][1] + g(i * 3 + 1) * u[c][2] + g(i * 3 + 2) * u[c][4];
      } else {
        s = g(i * 7) * u[c][1];
        for (int m = 2; m < 8; ++m) s += g(i * 7 + m - 1) * u[c][m];
      }
      grad[c][i] = s;
    }
}

/// Forces of F_m = sum_i T_ci b_im on modes 1..7.
template <bool Affine, class V, class Geometry>
CALOMEL_INLINE void spread(const V (&t)[3][3], Geometry g, V (&f)[3][8]) {
  for (int c = 0; c < 3; ++c) {
    if constexpr (Affine) {
      for (int j = 0; j < 3; ++j) f[c][linear_mode(j)] = t[c][0] * g(j) + t[c][1] * g(3 + j) + t[c][2] * g(6 + j);
      for (int a = 0; a < 4; ++a) f[c][hourglass_mode(a)] = V{};
    } else {
      for (int m = 1; m < 8; ++m) f[c][m] = t[c][0] * g(m - 1) + t[c][1] * g(6 + m) + t[c][2] * g(13 + m);
    }
  }
}

/// The liquid's scalars, each a lane vector or a broadcast.
template <class V>
struct LiquidStep {
  V bulk_modulus, minus_cutoff, hourglass, p0, p0_before;
  V ratio, rate_factor, quadratic, cutoff;  // booking: beta/dt, 1/dt
};

template <class V>
struct Sums {
  V liquid{}, hourglass{}, steel{}, dissipated{}, heat{}, kinetic{};
};

/// Energy of one hourglass amplitude w = q + beta dq/dt whose spring is h: 1/2 h q^2 is stored, h beta (dq/dt)^2 dissipated.
/// `before` is q of the last step.
template <class V>
CALOMEL_INLINE void book_hourglass(V w, V h, const LiquidStep<V>& s, V* before, Sums<V>& sums) {
  const V q = (w + s.ratio * *before) / (V{} + 1 + s.ratio), change = q - *before;
  sums.hourglass += h * q * q;
  sums.dissipated += h * s.ratio * change * change;
  *before = q;
}

/// `state`: strain and viscous pressure of the last step, then, with Hourglass, the twelve hourglass amplitudes.
template <bool Affine, bool Booking, bool Hourglass, class V, class Geometry>
CALOMEL_INLINE void liquid_element(const V (&u)[3][8], V (&f)[3][8], Geometry g, const LiquidStep<V>& s, V* state, Sums<V>& sums) {
  constexpr int terms = Affine ? 9 : 21;
  const V volume = g(terms), h = s.hourglass * g(terms + 1);
  V grad[3][3];
  gradients<Affine>(u, g, grad);
  const V w = grad[0][0] + grad[1][1] + grad[2][2];  // e_v + (eta/K) de_v/dt
  V p = s.p0 - s.bulk_modulus * w;
  if constexpr (Booking) {
    const V before = state[0], viscous_before = state[1];
    const V strain = (w + s.ratio * before) / (V{} + 1 + s.ratio);
    const V change = strain - before, rate = change * s.rate_factor;
    p += rate < 0 ? s.quadratic * rate * rate : V{};
    p = greater(p, s.minus_cutoff);
    const V elastic = greater(s.p0 - s.bulk_modulus * strain, s.minus_cutoff);
    const V elastic_before = greater(s.p0_before - s.bulk_modulus * before, s.minus_cutoff);
    const V viscous = p - elastic;
    sums.dissipated -= (viscous + viscous_before) * change * volume * (V{} + typename std::remove_reference_t<decltype(p[0])>(0.5));
    sums.heat += (elastic + elastic_before) * (s.p0 - s.p0_before) / s.bulk_modulus * volume * (V{} + typename std::remove_reference_t<decltype(p[0])>(0.5));
    const V stretch = strain - s.p0 / s.bulk_modulus, limit = s.cutoff / s.bulk_modulus;
    const V half = V{} + typename std::remove_reference_t<decltype(p[0])>(0.5);
    sums.liquid += volume * (stretch <= limit ? half * s.bulk_modulus * stretch * stretch : s.cutoff * (stretch - half * limit));
    state[0] = strain, state[1] = viscous;
  } else {
    p = greater(p, s.minus_cutoff);
  }
  const V pv = p * volume;
  if constexpr (Affine) {
    for (int c = 0; c < 3; ++c) {
      for (int j = 0; j < 3; ++j) f[c][linear_mode(j)] = pv * g(c * 3 + j);
      for (int a = 0; a < 4; ++a) {
        const V q = u[c][hourglass_mode(a)];
        f[c][hourglass_mode(a)] = -h * q;
        if constexpr (Hourglass) book_hourglass(q, h, s, state + 2 + c * 4 + a, sums);
      }
    }
  } else {
    V t[3][3], force[3][4];
    for (int c = 0; c < 3; ++c) {
      for (int a = 0; a < 4; ++a) {
        const V q = u[c][hourglass_mode(a)] - (g(23 + a) * grad[c][0] + g(27 + a) * grad[c][1] + g(31 + a) * grad[c][2]);
        force[c][a] = h * q;
        if constexpr (Hourglass) book_hourglass(q, h, s, state + 2 + c * 4 + a, sums);
      }
      for (int i = 0; i < 3; ++i) {
        V s2 = i == c ? pv : V{};
        for (int a = 0; a < 4; ++a) s2 += g(23 + i * 4 + a) * force[c][a];
        t[c][i] = s2;
      }
    }
    spread<false>(t, g, f);
    for (int c = 0; c < 3; ++c)
      for (int a = 0; a < 4; ++a) f[c][hourglass_mode(a)] -= force[c][a];
  }
}

template <bool Affine, bool Booking, class V, class Geometry>
CALOMEL_INLINE void steel_element(const V (&u)[3][8], V (&f)[3][8], Geometry g, V lambda, V mu, Sums<V>& sums) {
  constexpr int at_volume = Affine ? 9 : 21, at_x = 22, at_bending = Affine ? 10 : 34, at_last = at_bending + 45;
  V grad[3][3];
  gradients<Affine>(u, g, grad);
  const V minus_volume = -g(at_volume);
  const V pressure = lambda * (grad[0][0] + grad[1][1] + grad[2][2]);
  V t[3][3];  // -V sigma
  for (int c = 0; c < 3; ++c)
    for (int i = c; i < 3; ++i) {
      const V sigma = i == c ? pressure + (mu + mu) * grad[c][c] : mu * (grad[c][i] + grad[i][c]);
      t[c][i] = t[i][c] = minus_volume * sigma;
      if constexpr (Booking) sums.steel += -t[c][i] * (i == c ? grad[c][c] : grad[c][i] + grad[i][c]);
    }
  V q[9], last[3];
  for (int c = 0; c < 3; ++c) {
    for (int a = 0; a < 3; ++a) {
      q[c * 3 + a] = u[c][hourglass_mode(a)];
      if constexpr (!Affine) q[c * 3 + a] -= g(at_x + a) * grad[c][0] + g(at_x + 4 + a) * grad[c][1] + g(at_x + 8 + a) * grad[c][2];
    }
    last[c] = u[c][7];
    if constexpr (!Affine) last[c] -= g(at_x + 3) * grad[c][0] + g(at_x + 7) * grad[c][1] + g(at_x + 11) * grad[c][2];
  }
  V force[3][4];
  for (int i = 0; i < 9; ++i) {
    V s{};
    for (int j = 0; j < 9; ++j) {
      const int low = i < j ? i : j, high = i < j ? j : i;
      s += g(at_bending + low * 9 - low * (low - 1) / 2 + high - low) * q[j];
    }
    force[i / 3][i % 3] = s;
    if constexpr (Booking) sums.steel += s * q[i];
  }
  force[0][3] = g(at_last) * last[0] + g(at_last + 1) * last[1] + g(at_last + 2) * last[2];
  force[1][3] = g(at_last + 1) * last[0] + g(at_last + 3) * last[1] + g(at_last + 4) * last[2];
  force[2][3] = g(at_last + 2) * last[0] + g(at_last + 4) * last[1] + g(at_last + 5) * last[2];
  if constexpr (Booking)
    for (int c = 0; c < 3; ++c) sums.steel += force[c][3] * last[c];
  if constexpr (!Affine)
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < 3; ++i)
        for (int a = 0; a < 4; ++a) t[c][i] += g(at_x + i * 4 + a) * force[c][a];
  spread<Affine>(t, g, f);
  for (int c = 0; c < 3; ++c)
    for (int a = 0; a < 4; ++a) f[c][hourglass_mode(a)] -= force[c][a];
}

// Rows x, y, z, 0 of W nodes to lane vectors and back (added).
CALOMEL_INLINE void gather_rows(const float* u, const std::uint16_t* at, Vec<float, 8>& x, Vec<float, 8>& y, Vec<float, 8>& z) {
  using F4 = Vec<float, 4>;
  using F8 = Vec<float, 8>;
  F8 a[4];
  for (int l = 0; l < 4; ++l)
    a[l] = __builtin_shufflevector(load<F4>(u + 4 * std::size_t(at[l])), load<F4>(u + 4 * std::size_t(at[l + 4])), 0, 1, 2, 3, 4, 5, 6, 7);
  const F8 t0 = __builtin_shufflevector(a[0], a[1], 0, 8, 1, 9, 4, 12, 5, 13), t1 = __builtin_shufflevector(a[0], a[1], 2, 10, 3, 11, 6, 14, 7, 15);
  const F8 t2 = __builtin_shufflevector(a[2], a[3], 0, 8, 1, 9, 4, 12, 5, 13), t3 = __builtin_shufflevector(a[2], a[3], 2, 10, 3, 11, 6, 14, 7, 15);
  x = __builtin_shufflevector(t0, t2, 0, 1, 8, 9, 4, 5, 12, 13);
  y = __builtin_shufflevector(t0, t2, 2, 3, 10, 11, 6, 7, 14, 15);
  z = __builtin_shufflevector(t1, t3, 0, 1, 8, 9, 4, 5, 12, 13);
}
CALOMEL_INLINE void scatter_rows(float* f, const std::uint16_t* at, Vec<float, 8> x, Vec<float, 8> y, Vec<float, 8> z) {
  using F4 = Vec<float, 4>;
  using F8 = Vec<float, 8>;
  const F8 o{};
  const F8 t0 = __builtin_shufflevector(x, y, 0, 8, 1, 9, 4, 12, 5, 13), t1 = __builtin_shufflevector(x, y, 2, 10, 3, 11, 6, 14, 7, 15);
  const F8 s0 = __builtin_shufflevector(z, o, 0, 8, 1, 9, 4, 12, 5, 13), s1 = __builtin_shufflevector(z, o, 2, 10, 3, 11, 6, 14, 7, 15);
  const F8 r[4] = {__builtin_shufflevector(t0, s0, 0, 1, 8, 9, 4, 5, 12, 13), __builtin_shufflevector(t0, s0, 2, 3, 10, 11, 6, 7, 14, 15),
                   __builtin_shufflevector(t1, s1, 0, 1, 8, 9, 4, 5, 12, 13), __builtin_shufflevector(t1, s1, 2, 3, 10, 11, 6, 7, 14, 15)};
  for (int l = 0; l < 4; ++l) {
    float* p = f + 4 * std::size_t(at[l]);
    store<F4>(p, load<F4>(p) + __builtin_shufflevector(r[l], r[l], 0, 1, 2, 3));
  }
  for (int l = 0; l < 4; ++l) {
    float* p = f + 4 * std::size_t(at[l + 4]);
    store<F4>(p, load<F4>(p) + __builtin_shufflevector(r[l], r[l], 4, 5, 6, 7));
  }
}
CALOMEL_INLINE void gather_rows(const double* u, const std::uint16_t* at, Vec<double, 4>& x, Vec<double, 4>& y, Vec<double, 4>& z) {
  using D4 = Vec<double, 4>;
  const D4 r0 = load<D4>(u + 4 * std::size_t(at[0])), r1 = load<D4>(u + 4 * std::size_t(at[1])), r2 = load<D4>(u + 4 * std::size_t(at[2])),
           r3 = load<D4>(u + 4 * std::size_t(at[3]));
  const D4 t0 = __builtin_shufflevector(r0, r1, 0, 4, 2, 6), t1 = __builtin_shufflevector(r0, r1, 1, 5, 3, 7);
  const D4 t2 = __builtin_shufflevector(r2, r3, 0, 4, 2, 6), t3 = __builtin_shufflevector(r2, r3, 1, 5, 3, 7);
  x = __builtin_shufflevector(t0, t2, 0, 1, 4, 5);
  y = __builtin_shufflevector(t1, t3, 0, 1, 4, 5);
  z = __builtin_shufflevector(t0, t2, 2, 3, 6, 7);
}
CALOMEL_INLINE void scatter_rows(double* f, const std::uint16_t* at, Vec<double, 4> x, Vec<double, 4> y, Vec<double, 4> z) {
  using D4 = Vec<double, 4>;
  const D4 o{};
  const D4 t0 = __builtin_shufflevector(x, y, 0, 4, 2, 6), t1 = __builtin_shufflevector(x, y, 1, 5, 3, 7);
  const D4 s0 = __builtin_shufflevector(z, o, 0, 4, 2, 6), s1 = __builtin_shufflevector(z, o, 1, 5, 3, 7);
  const D4 r[4] = {__builtin_shufflevector(t0, s0, 0, 1, 4, 5), __builtin_shufflevector(t1, s1, 0, 1, 4, 5), __builtin_shufflevector(t0, s0, 2, 3, 6, 7),
                   __builtin_shufflevector(t1, s1, 2, 3, 6, 7)};
  for (int l = 0; l < 4; ++l) {
    double* p = f + 4 * std::size_t(at[l]);
    store<D4>(p, load<D4>(p) + r[l]);
  }
}

// ---- node rows: x, y, z, 0 (one run) or x[8], y[8], z[8] (eight runs) ----

template <class R, bool Runs>
struct Row {
  using Lane = R;
  static constexpr int width = 4;
};
template <class R>
struct Row<R, true> {
  using Lane = Vec<R, run_lanes>;
  static constexpr int width = 3 * run_lanes;
};

template <class R, bool Runs>
CALOMEL_INLINE void read_row(const R* p, typename Row<R, Runs>::Lane (&x)[3]) {
  if constexpr (Runs)
    for (int c = 0; c < 3; ++c) x[c] = load<Vec<R, run_lanes>>(p + c * run_lanes);
  else
    for (int c = 0; c < 3; ++c) x[c] = p[c];
}
template <class R, bool Runs>
CALOMEL_INLINE void write_row(R* p, const typename Row<R, Runs>::Lane (&x)[3]) {
  if constexpr (Runs)
    for (int c = 0; c < 3; ++c) store(p + c * run_lanes, x[c]);
  else
    for (int c = 0; c < 3; ++c) p[c] = x[c];
}

/// v+ = v- + kick f / m, u += dt v+; fixed directions stay.
template <class R, bool Runs, bool Booking>
CALOMEL_INLINE void advance(R* u, R* v, const R* f, R inverse_mass, std::uint8_t fixed, const StepData<R>& s, double& kinetic) {
  typename Row<R, Runs>::Lane force[3], velocity[3], place[3];
  read_row<R, Runs>(f, force), read_row<R, Runs>(v, velocity), read_row<R, Runs>(u, place);
  const R a = s.kick * inverse_mass;
  for (int c = 0; c < 3; ++c) {
    if (fixed & (1 << c)) continue;
    const auto before = velocity[c];
    velocity[c] += a * force[c];
    place[c] += s.dt * velocity[c];
    if constexpr (Booking && !Runs) kinetic += 0.5 * double(before) * double(velocity[c]) / double(inverse_mass);
  }
  write_row<R, Runs>(v, velocity), write_row<R, Runs>(u, place);
}

template <class R, bool Runs, bool Booking>
CALOMEL_INLINE void advance_interior(const BlockData<R>& b, const StepData<R>& s, const R* force, double& kinetic) {
  constexpr int width = Row<R, Runs>::width;
  for (int r = 0; r < b.range_count; ++r) {
    const auto& range = b.ranges[r];
    if (!Runs && !Booking && range.fixed == 0) {  // the common case, whole rows at once
      using V4 = Vec<R, 4>;
      for (std::int32_t n = range.begin; n < range.end; ++n) {
        const V4 v = load<V4>(s.v + std::size_t(n) * 4) + s.kick * s.inverse_mass[n] * load<V4>(force + std::size_t(n - b.first_node) * 4);
        store<V4>(s.v + std::size_t(n) * 4, v);
        store<V4>(s.u + std::size_t(n) * 4, load<V4>(s.u + std::size_t(n) * 4) + s.dt * v);
      }
      continue;
    }
    for (std::int32_t n = range.begin; n < range.end; ++n)
      advance<R, Runs, Booking>(s.u + std::size_t(n) * width, s.v + std::size_t(n) * width, force + std::size_t(n - b.first_node) * width, s.inverse_mass[n],
                                range.fixed, s, kinetic);
  }
}

/// Copies u + beta v of a block's nodes to scratch and clears its forces. Rows are padded to whole vectors.
template <class R, bool Runs>
CALOMEL_INLINE void copy_in(const BlockData<R>& b, const StepData<R>& s, R* w, R* f) {
  constexpr int width = Row<R, Runs>::width;
  const R beta = b.liquid ? s.beta : R(0);
  const R* u = s.u + std::size_t(b.first_node) * width;
  const R* v = s.v + std::size_t(b.first_node) * width;
  for (std::size_t k = 0; k < std::size_t(b.interior) * width; ++k) w[k] = u[k] + beta * v[k];
  for (std::int32_t i = 0; i < b.shared_count; ++i) {
    const std::size_t from = std::size_t(b.shared[i]) * width, to = std::size_t(b.interior + i) * width;
    for (int k = 0; k < width; ++k) w[to + k] = s.u[from + k] + beta * s.v[from + k];
  }
  __builtin_memset(f, 0, sizeof(R) * std::size_t(b.interior + b.shared_count) * width);
}

template <class R, bool Liquid, bool Affine, bool Booking>
void element_groups(const BlockData<R>& b, const StepData<R>& s, const R* w, R* force, EnergyTerms* energy) {
  constexpr int W = element_lanes<R>;
  using V = Vec<R, W>;
  constexpr int terms = geometry_terms(Liquid, Affine);
  Sums<V> sums;
  LiquidStep<V> liquid;
  liquid.bulk_modulus = V{} + s.bulk_modulus, liquid.minus_cutoff = V{} - s.cutoff, liquid.cutoff = V{} + s.cutoff, liquid.hourglass = V{} + s.hourglass;
  liquid.ratio = V{} + s.beta / s.dt, liquid.rate_factor = V{} + 1 / s.dt, liquid.quadratic = V{} + s.quadratic;
  const V lambda = V{} + s.lambda, mu = V{} + s.mu;
  for (std::int32_t g = 0; g < b.groups; ++g) {
    const std::uint16_t* at = b.connectivity + std::size_t(g) * 8 * W;
    const R* geometry = b.geometry + std::size_t(g) * terms * W;
    const auto coefficient = [geometry](int k) __attribute__((always_inline)) { return load<V>(geometry + k * W); };
    V u[3][8], f[3][8], um[3][8], fm[3][8];
    for (int n = 0; n < 8; ++n) gather_rows(w, at + n * W, u[0][n], u[1][n], u[2][n]);
    for (int c = 0; c < 3; ++c) to_modes(u[c], um[c]);
    if constexpr (Liquid) {
      const V p0 = load<V>(b.p0 + std::size_t(g) * W);
      liquid.p0 = p0 * s.load[0];
      V* state = nullptr;
      if constexpr (Booking) liquid.p0_before = p0 * s.load_before[0], state = reinterpret_cast<V*>(b.state) + std::size_t(g) * element_state;
      liquid_element<Affine, Booking, Booking>(um, fm, coefficient, liquid, state, sums);
    } else {
      steel_element<Affine, Booking>(um, fm, coefficient, lambda, mu, sums);
    }
    for (int c = 0; c < 3; ++c) to_corners(fm[c], f[c]);
    for (int n = 0; n < 8; ++n) scatter_rows(force, at + n * W, f[0][n], f[1][n], f[2][n]);
  }
  if constexpr (Booking) {
    energy->liquid += lane_sum<R, W>(sums.liquid), energy->dissipated += lane_sum<R, W>(sums.dissipated), energy->heat += lane_sum<R, W>(sums.heat);
    energy->hourglass += 0.5 * lane_sum<R, W>(sums.hourglass), energy->steel += 0.5 * lane_sum<R, W>(sums.steel);
  }
}

template <class R, bool Liquid, bool Affine, bool Booking>
void run_elements(const BlockData<R>& b, const StepData<R>& s, const R* w, R* force) {
  constexpr int W = run_lanes;
  using V = Vec<R, W>;
  constexpr int terms = geometry_terms(Liquid, Affine), width = 3 * W;
  Sums<V> sums;
  LiquidStep<V> liquid;
  liquid.bulk_modulus = V{} + s.bulk_modulus, liquid.minus_cutoff = V{} - s.cutoff, liquid.cutoff = V{} + s.cutoff, liquid.hourglass = V{} + s.hourglass;
  liquid.ratio = V{} + s.beta / s.dt, liquid.rate_factor = V{} + 1 / s.dt, liquid.quadratic = V{} + s.quadratic;
  const V lambda = V{} + s.lambda, mu = V{} + s.mu;
  const V share = load<V>(s.load), share_before = load<V>(s.load_before);
  for (std::int32_t e = 0; e < b.groups; ++e) {
    const std::uint16_t* at = b.connectivity + std::size_t(e) * 8;
    const R* geometry = b.geometry + std::size_t(e) * terms;
    const auto coefficient = [geometry](int k) __attribute__((always_inline)) { return geometry[k] + V{}; };
    V u[8], f[8], um[3][8], fm[3][8];
    for (int c = 0; c < 3; ++c) {
      for (int n = 0; n < 8; ++n) u[n] = load<V>(w + std::size_t(at[n]) * width + c * W);
      to_modes(u, um[c]);
    }
    if constexpr (Liquid) {
      liquid.p0 = b.p0[e] * share;
      V* state = nullptr;
      if constexpr (Booking) liquid.p0_before = b.p0[e] * share_before, state = reinterpret_cast<V*>(b.state) + std::size_t(e) * run_state;
      liquid_element<Affine, Booking, false>(um, fm, coefficient, liquid, state, sums);
    } else {
      steel_element<Affine, false>(um, fm, coefficient, lambda, mu, sums);
    }
    for (int c = 0; c < 3; ++c) {
      to_corners(fm[c], f);
      for (int n = 0; n < 8; ++n) {
        R* p = force + std::size_t(at[n]) * width + c * W;
        store(p, load<V>(p) + f[n]);
      }
    }
  }
}

template <class R, bool Runs, bool Booking>
void block(const BlockData<R>& b, const StepData<R>& s, EnergyTerms* energy) {
  constexpr int width = Row<R, Runs>::width;
  R* w = s.scratch;
  R* force = w + std::size_t(b.interior + b.shared_count) * width;
  copy_in<R, Runs>(b, s, w, force);
  const auto elements = [&]<bool Liquid, bool Affine>() {
    if constexpr (Runs)
      run_elements<R, Liquid, Affine, Booking>(b, s, w, force);
    else
      element_groups<R, Liquid, Affine, Booking>(b, s, w, force, energy);
  };
  if (b.liquid)
    b.parallelepiped ? elements.template operator()<true, true>() : elements.template operator()<true, false>();
  else
    b.parallelepiped ? elements.template operator()<false, true>() : elements.template operator()<false, false>();
  double kinetic = 0;
  advance_interior<R, Runs, Booking>(b, s, force, kinetic);
  if (Booking && !Runs) energy->kinetic += kinetic;
  __builtin_memcpy(s.outbox + b.outbox * width, force + std::size_t(b.interior) * width, sizeof(R) * std::size_t(b.shared_count) * width);
}

/// Sum of a shared node's forces in block order.
template <class R, bool Runs>
CALOMEL_INLINE void sum_outbox(const Layout& layout, std::int32_t node, const R* outbox, typename Row<R, Runs>::Lane (&force)[3]) {
  const std::size_t k = std::size_t(node - layout.first_shared);
  for (auto& f : force) f = typename Row<R, Runs>::Lane{};
  for (std::size_t i = layout.outbox_begin[k]; i < layout.outbox_begin[k + 1]; ++i) {
    typename Row<R, Runs>::Lane part[3];
    read_row<R, Runs>(outbox + layout.outbox_rows[i] * Row<R, Runs>::width, part);
    for (int c = 0; c < 3; ++c) force[c] += part[c];
  }
}

template <class R, bool Runs, bool Booking>
void plain(const Layout& layout, std::size_t begin, std::size_t end, const StepData<R>& s, EnergyTerms* energy) {
  constexpr int width = Row<R, Runs>::width;
  double kinetic = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const std::int32_t n = layout.plain[i];
    typename Row<R, Runs>::Lane force[3];
    sum_outbox<R, Runs>(layout, n, s.outbox, force);
    alignas(64) R row[width];
    write_row<R, Runs>(row, force);
    advance<R, Runs, Booking>(s.u + std::size_t(n) * width, s.v + std::size_t(n) * width, row, s.inverse_mass[n], layout.fixed[std::size_t(n)], s, kinetic);
  }
  if (Booking && !Runs) energy->kinetic += kinetic;
}

template <class R, bool Runs, bool Booking>
void special(const Layout& layout, const SpecialData<R>* rules, std::size_t begin, std::size_t end, const StepData<R>& s, EnergyTerms* energy) {
  using L = typename Row<R, Runs>::Lane;
  constexpr int width = Row<R, Runs>::width;
  L share, stress;
  if constexpr (Runs)
    share = load<L>(s.load), stress = load<L>(s.end_stress);
  else
    share = s.load[0], stress = s.end_stress[0];
  for (std::size_t i = begin; i < end; ++i) {
    const SpecialData<R>& r = rules[i];
    L force[3], v[3], before[3];
    sum_outbox<R, Runs>(layout, r.node, s.outbox, force);
    read_row<R, Runs>(s.v + std::size_t(r.node) * width, before);
    for (int c = 0; c < 3; ++c) {
      force[c] += stress * r.load_area[c];
      v[c] = r.fixed_node & (1 << c) ? L{} : before[c] + s.kick / r.mass_node * force[c];
    }
    if constexpr (Booking && !Runs)
      for (int c = 0; c < 3; ++c) {
        energy->boundary_before -= 0.5 * double(s.dt) * double(stress) * double(r.load_area[c]) * double(before[c]);
        energy->boundary_after -= 0.5 * double(s.dt) * double(stress) * double(r.load_area[c]) * double(v[c]);
      }
    if (r.rear_area > 0) {
      // p = p0 + rho c v_n at mid-step, not below the cutoff; v_n solved implicitly, so the face never limits the step.
      const R* n = r.rear_normal;
      const L vn_before = before[0] * n[0] + before[1] * n[1] + before[2] * n[2];
      const L vn_free = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
      const L p0 = share * r.rear_p0;
      const R a = s.kick * r.rear_area / r.mass_node, half = R(0.5);
      const L vn = (vn_free - a * (p0 + half * s.impedance * vn_before)) / (1 + half * a * s.impedance);
      const L p_wave = p0 + half * s.impedance * (vn + vn_before);
      const L p_least = L{} - s.cutoff;
      const L p = p_wave > p_least ? p_wave : p_least;
      const L vn_after = vn_free - a * p;
      for (int c = 0; c < 3; ++c) v[c] += (vn_after - vn_free) * n[c];
      if constexpr (Booking && !Runs) {
        energy->boundary_before += 0.5 * double(s.dt) * double(p) * double(r.rear_area) * double(vn_before);
        energy->boundary_after += 0.5 * double(s.dt) * double(p) * double(r.rear_area) * double(vn_after);
      }
    }
    L u[3];
    if (r.partner >= 0) {
      L steel_force[3], steel[3], steel_before[3];
      sum_outbox<R, Runs>(layout, r.partner, s.outbox, steel_force);
      read_row<R, Runs>(s.v + std::size_t(r.partner) * width, steel_before);
      for (int c = 0; c < 3; ++c) steel[c] = r.fixed_partner & (1 << c) ? L{} : steel_before[c] + s.kick / r.mass_partner * steel_force[c];
      // Common normal momentum: a_n = (F_s + F_f).n / (m_s + m_f).
      const R share_node = r.mass_node / (r.mass_node + r.mass_partner), share_partner = r.mass_partner / (r.mass_node + r.mass_partner);
      for (int k = 0; k < r.normals; ++k) {
        const R* n = r.normal[k];
        const L vn = v[0] * n[0] + v[1] * n[1] + v[2] * n[2], sn = steel[0] * n[0] + steel[1] * n[1] + steel[2] * n[2];
        const L common = share_node * vn + share_partner * sn;
        for (int c = 0; c < 3; ++c) v[c] += (common - vn) * n[c], steel[c] += (common - sn) * n[c];
      }
      read_row<R, Runs>(s.u + std::size_t(r.partner) * width, u);
      for (int c = 0; c < 3; ++c) u[c] += s.dt * steel[c];
      write_row<R, Runs>(s.u + std::size_t(r.partner) * width, u);
      write_row<R, Runs>(s.v + std::size_t(r.partner) * width, steel);
      if constexpr (Booking && !Runs)
        for (int c = 0; c < 3; ++c) energy->kinetic += 0.5 * double(r.mass_partner) * double(steel_before[c]) * double(steel[c]);
    }
    read_row<R, Runs>(s.u + std::size_t(r.node) * width, u);
    for (int c = 0; c < 3; ++c) u[c] += s.dt * v[c];
    write_row<R, Runs>(s.u + std::size_t(r.node) * width, u);
    write_row<R, Runs>(s.v + std::size_t(r.node) * width, v);
    if constexpr (Booking && !Runs)
      for (int c = 0; c < 3; ++c) energy->kinetic += 0.5 * double(r.mass_node) * double(before[c]) * double(v[c]);
  }
}

template <class R>
const KernelTable<R>& table() {
  static const KernelTable<R> t{
      CALOMEL_ISA_NAME,
      element_lanes<R>,
      [](const BlockData<R>& b, const StepData<R>& s, bool booking, EnergyTerms* e) {
        booking ? block<R, false, true>(b, s, e) : block<R, false, false>(b, s, e);
      },
      [](const BlockData<R>& b, const StepData<R>& s, bool booking) { booking ? block<R, true, true>(b, s, nullptr) : block<R, true, false>(b, s, nullptr); },
      [](const Layout& l, std::size_t begin, std::size_t end, const StepData<R>& s, bool booking, EnergyTerms* e) {
        booking ? plain<R, false, true>(l, begin, end, s, e) : plain<R, false, false>(l, begin, end, s, e);
      },
      [](const Layout& l, std::size_t begin, std::size_t end, const StepData<R>& s) { plain<R, true, false>(l, begin, end, s, nullptr); },
      [](const Layout& l, const SpecialData<R>* r, std::size_t begin, std::size_t end, const StepData<R>& s, bool booking, EnergyTerms* e) {
        booking ? special<R, false, true>(l, r, begin, end, s, e) : special<R, false, false>(l, r, begin, end, s, e);
      },
      [](const Layout& l, const SpecialData<R>* r, std::size_t begin, std::size_t end, const StepData<R>& s) {
        special<R, true, false>(l, r, begin, end, s, nullptr);
      }};
  return t;
}

template const KernelTable<float>& table<float>();
template const KernelTable<double>& table<double>();

}  // namespace calomel::CALOMEL_ISA
