// Included once by each bubble_kernel_<isa>.cpp inside its own namespace CALOMEL_ISA, so that code for different instruction sets never mixes. No
// standard-library calls in here.
#include "forward/material/keller_miksis_equation.hpp"
#include "forward/mechanism/bubble_kernel.hpp"

#define CALOMEL_INLINE inline __attribute__((always_inline))

namespace calomel::CALOMEL_ISA {

#if defined(__AVX512F__)
constexpr int width = 8;
#elif defined(__AVX2__)
constexpr int width = 4;
#else
constexpr int width = 2;
#endif
typedef double V __attribute__((vector_size(width * sizeof(double))));
typedef double Unaligned __attribute__((vector_size(width * sizeof(double)), aligned(sizeof(double)), may_alias));
typedef unsigned long long Bits __attribute__((vector_size(width * sizeof(double))));

CALOMEL_INLINE V all(double x) { return x - V{}; }
template <class Mask>
CALOMEL_INLINE bool any(Mask m) {
  long long found = 0;
  for (int l = 0; l < width; ++l) found |= m[l];
  return found != 0;
}

/// a_0 + a_1 x + ... + a_{N-1} x^{N-1}, paired (Estrin 1960): the chain of dependent operations is what a sub-step waits for.
template <int N>
CALOMEL_INLINE V polynomial(const V (&a)[N], V x) {
  if constexpr (N == 1) {
    return a[0];
  } else {
    V pairs[(N + 1) / 2];
    for (int i = 0; i < N / 2; ++i) pairs[i] = a[2 * i] + a[2 * i + 1] * x;
    if constexpr (N % 2) pairs[N / 2] = a[N - 1];
    return polynomial(pairs, x * x);
  }
}

/// log x of a normal x > 0: x = 2^k m with sqrt(1/2) <= m < sqrt(2), log m = 2 artanh s, s = (m - 1)/(m + 1), |s| < 0.172, by its series to s^21.
CALOMEL_INLINE V log_of(V x) {
  const Bits bits = (Bits)x;
  const Bits k = (bits - 0x3fe6a09e667f3bcdull + (1024ull << 52)) >> 52;  // 1024 more
  const V m = (V)(bits - ((k - 1024) << 52)), exponent = (V)(k | 0x4330000000000000ull) - (4503599627370496.0 + 1024);
  const V s = (m - 1) / (m + 1), z = s * s;
  V series[10];
  for (int n = 0; n < 10; ++n) series[n] = all(1.0 / (2 * n + 3));
  return exponent * 0.69314718055994531 + 2 * s * (1 + z * polynomial(series, z));
}

/// exp y of |y| < 700: y = k log 2 + r, |r| < 0.347, e^r by its series to r^13. log 2 in two parts, the first of few bits (Cody and Waite 1980).
CALOMEL_INLINE V exp_of(V y) {
  constexpr double round = 6755399441055744.0;  // 1.5 2^52: the sum's last bits are k
  const V sum = y * 1.4426950408889634 + round, k = sum - round, r = y - k * 0.693147180369123816490 - k * 1.90821492927058770002e-10;
  V series[14];
  double factorial = 1;
  for (int n = 0; n < 14; factorial *= ++n) series[n] = all(1 / factorial);
  return polynomial(series, r) * (V)(((Bits)sum + 1023) << 52);
}

/// What the points of a group have in a step; e_v and p0 run linearly in it.
struct Group {
  V strain_before, strain_rate, heating_before, heating_rate;
};

CALOMEL_INLINE V share_of_gas(const BubblyNumbers& b, V radius) {
  const V x = radius * (1 / b.radius);
  return b.alpha0 * x * x * x;
}

CALOMEL_INLINE V pressure(const BubblyNumbers& b, V strain, V heating, V rate, V radius) {
  const V p = heating - b.bulk_modulus * (strain - share_of_gas(b, radius) + b.alpha0) - b.liquid_viscosity * rate, least = all(-b.tensile_cutoff);
  return p > least ? p : least;
}

CALOMEL_INLINE V gas_pressure(const BubblyNumbers& b, V radius) { return b.gas_at_rest * exp_of(-3 * b.polytropic * log_of(radius * (1 / b.radius))); }

/// Gas pressure about a radius at which it is known: gas (1 + d)^(-3 kappa) by its series to d^7, d = r/r0 - 1, which leaves less than 1e-11 of it for |d| <
/// 0.02.
struct GasNearby {
  static constexpr int terms = 8;
  double coefficient[terms];

  explicit GasNearby(double polytropic) {
    coefficient[0] = 1;
    for (int n = 1; n < terms; ++n) coefficient[n] = coefficient[n - 1] * (-3 * polytropic - (n - 1)) / n;
  }
  CALOMEL_INLINE V pressure(const BubblyNumbers& b, V gas, V per_r0, V r) const {
    const V d = r * per_r0 - 1;
    if (any((d > 0.02) | (d < -0.02))) return gas_pressure(b, r);
    V series[terms];
    for (int n = 0; n < terms; ++n) series[n] = all(coefficient[n]);
    return gas * polynomial(series, d);
  }
};

/// Groups that are advanced side by side: what one waits for, another has time for.
constexpr int abreast = 2;

/// The first lane of which a mask is set; one is.
template <class Mask>
CALOMEL_INLINE std::size_t first_lane(Mask m) {
  std::size_t l = 0;
  while (!m[l]) ++l;
  return l;
}

/// Radius and rate of N groups after the time dt; what stops a lane, if anything does, counted over the groups.
template <int N>
CALOMEL_INLINE BubbleFailure advance_groups(const BubblyNumbers& b, const GasNearby& nearby, const Group (&g)[N], double dt, V (&radius)[N], V (&rate)[N]) {
  constexpr int most_steps = 200000;
  const auto pressure_at = [&](int k, V t, V r) __attribute__((always_inline)) {
    return pressure(b, g[k].strain_before + g[k].strain_rate * t, g[k].heating_before + g[k].heating_rate * t, g[k].strain_rate, r);
  };
  V t[N]{}, r[N], v[N], gas[N], per_r[N];
  const auto acceleration = [&](int k, V time, V at, V rate_there) __attribute__((always_inline)) {
    return bubble_acceleration(b, at, rate_there, pressure_at(k, time, at), nearby.pressure(b, gas[k], per_r[k], at));
  };
  for (int k = 0; k < N; ++k) r[k] = radius[k], v[k] = rate[k];
  for (int step = 0; step < most_steps; ++step) {
    V left[N], h[N], a1[N], a2[N], a3[N], a4[N], v2[N], v3[N], v4[N];
    for (int k = 0; k < N; ++k) {
      left[k] = dt - t[k];
      gas[k] = gas_pressure(b, r[k]);
      per_r[k] = 1 / r[k];
      const V p = pressure_at(k, t[k], r[k]), rate_squared = bubble_rate_squared(b, r[k], v[k], p, gas[k]) + b.coupling * r[k];
      h[k] = left[k];
      if (any((left[k] * left[k] * rate_squared > 0.16) | (left[k] > b.greatest_step)))  // more than one
        for (int l = 0; l < width; ++l) {
          const double stable = 0.4 / __builtin_sqrt(rate_squared[l]), limit = stable < b.greatest_step ? stable : b.greatest_step;
          if (left[k][l] > limit) h[k][l] = left[k][l] / __builtin_ceil(left[k][l] / limit);
        }
      a1[k] = bubble_acceleration(b, r[k], v[k], p, gas[k]);
    }
    for (int k = 0; k < N; ++k) v2[k] = v[k] + 0.5 * h[k] * a1[k], a2[k] = acceleration(k, t[k] + 0.5 * h[k], r[k] + 0.5 * h[k] * v[k], v2[k]);
    for (int k = 0; k < N; ++k) v3[k] = v[k] + 0.5 * h[k] * a2[k], a3[k] = acceleration(k, t[k] + 0.5 * h[k], r[k] + 0.5 * h[k] * v2[k], v3[k]);
    for (int k = 0; k < N; ++k) v4[k] = v[k] + h[k] * a3[k], a4[k] = acceleration(k, t[k] + h[k], r[k] + h[k] * v3[k], v4[k]);
    bool more = false;
    for (int k = 0; k < N; ++k) {
      r[k] += h[k] * (1.0 / 6) * (v[k] + 2 * v2[k] + 2 * v3[k] + v4[k]);
      v[k] += h[k] * (1.0 / 6) * (a1[k] + 2 * a2[k] + 2 * a3[k] + a4[k]);
      const auto lost = (r[k] <= 0) | (r[k] != r[k]) | (v[k] - v[k] != 0);
      if (any(lost)) return {BubbleFailure::vanished, std::size_t(k * width) + first_lane(lost), r[k][first_lane(lost)]};
      t[k] = h[k] < left[k] ? t[k] + h[k] : all(dt);
      more |= any(t[k] < dt);
    }
    if (more) continue;
    for (int k = 0; k < N; ++k) {
      radius[k] = r[k];
      rate[k] = v[k];
      const auto too_much = share_of_gas(b, r[k]) > b.greatest_alpha;
      if (any(too_much)) return {BubbleFailure::too_much_gas, std::size_t(k * width) + first_lane(too_much), r[k][first_lane(too_much)]};
    }
    return {};
  }
  for (int k = 0; k < N; ++k)
    if (const auto late = t[k] < dt; any(late)) return {BubbleFailure::too_violent, std::size_t(k * width) + first_lane(late), r[k][first_lane(late)]};
  return {};
}

/// N groups of points from `first` on; lanes without a point of their own have the last one's.
template <int N>
CALOMEL_INLINE BubbleFailure advance_points(const BubblyNumbers& b, const GasNearby& nearby, const LiquidPoints& points, std::size_t first) {
  const double per_step = points.dt > 0 ? 1 / points.dt : 0;
  double *const radii = points.state, *const rates = points.state + points.stride, *const heating_before = points.state + 2 * points.stride;
  const auto load = [&](int k, const double* from) __attribute__((always_inline)) {
    const std::size_t at = first + std::size_t(k * width);
    if (at + width <= points.count) return V(*reinterpret_cast<const Unaligned*>(from + at));
    V x{};
    for (int l = 0; l < width; ++l) x[l] = from[at + std::size_t(l) < points.count ? at + std::size_t(l) : points.count - 1];
    return x;
  };
  const auto store = [&](int k, double* to, V x) __attribute__((always_inline)) {
    const std::size_t at = first + std::size_t(k * width);
    if (at + width <= points.count)
      *reinterpret_cast<Unaligned*>(to + at) = x;
    else
      for (std::size_t l = 0; at + l < points.count; ++l) to[at + l] = x[l];
  };
  Group g[N];
  V strain[N], heating[N], radius[N], rate[N], now[N], rate_now[N];
  decltype(V{} != 0) moves[N];
  bool some_move = false;
  for (int k = 0; k < N; ++k) {
    strain[k] = load(k, points.strain);
    heating[k] = load(k, points.heating);
    radius[k] = now[k] = load(k, radii);
    rate[k] = rate_now[k] = load(k, rates);
    g[k].strain_before = load(k, points.strain_before);
    g[k].heating_before = load(k, heating_before);
    g[k].strain_rate = (strain[k] - g[k].strain_before) * per_step;
    g[k].heating_rate = (heating[k] - g[k].heating_before) * per_step;
    moves[k] = (strain[k] != 0) | (g[k].strain_before != 0) | (heating[k] != 0) | (g[k].heating_before != 0) | (radius[k] != b.radius) | (rate[k] != 0);
    some_move |= any(moves[k]);
  }
  if (some_move && points.dt > 0) {
    BubbleFailure failure = advance_groups<N>(b, nearby, g, points.dt, now, rate_now);
    if (failure.reason != BubbleFailure::none) {
      failure.point += first;
      return failure;
    }
    for (int k = 0; k < N; ++k) store(k, radii, moves[k] ? now[k] : radius[k]), store(k, rates, moves[k] ? rate_now[k] : rate[k]);
  }
  for (int k = 0; k < N; ++k) {
    store(k, heating_before, heating[k]);
    store(k, points.pressure, moves[k] ? pressure(b, strain[k], heating[k], g[k].strain_rate, now[k]) : V{});
  }
  return {};
}

BubbleFailure advance(const BubblyNumbers& b, const LiquidPoints& points) {
  const GasNearby nearby(b.polytropic);
  std::size_t first = 0;
  for (; first + (abreast - 1) * width < points.count; first += abreast * width)
    if (const auto failure = advance_points<abreast>(b, nearby, points, first); failure.reason != BubbleFailure::none) return failure;
  for (; first < points.count; first += width)
    if (const auto failure = advance_points<1>(b, nearby, points, first); failure.reason != BubbleFailure::none) return failure;
  return {};
}

extern const BubbleKernel bubbles;
const BubbleKernel bubbles{advance};

}  // namespace calomel::CALOMEL_ISA
