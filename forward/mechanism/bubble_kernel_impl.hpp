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

/// log x of a normal x > 0: x = 2^k m with sqrt(1/2) <= m < sqrt(2), log m = 2 artanh s, s = (m - 1)/(m + 1), |s| < 0.172, by its series to s^21.
CALOMEL_INLINE V log_of(V x) {
  const Bits bits = (Bits)x;
  const Bits k = (bits - 0x3fe6a09e667f3bcdull + (1024ull << 52)) >> 52;  // 1024 more
  const V m = (V)(bits - ((k - 1024) << 52)), exponent = (V)(k | 0x4330000000000000ull) - (4503599627370496.0 + 1024);
  const V s = (m - 1) / (m + 1), z = s * s;
  V series = all(1.0 / 21);
  for (int n = 19; n > 1; n -= 2) series = series * z + 1.0 / n;
  return exponent * 0.69314718055994531 + 2 * s * (1 + z * series);
}

/// exp y of |y| < 700: y = k log 2 + r, |r| < 0.347, e^r by its series to r^13. log 2 in two parts, the first of few bits (Cody and Waite 1980).
CALOMEL_INLINE V exp_of(V y) {
  constexpr double round = 6755399441055744.0;  // 1.5 2^52: the sum's last bits are k
  const V sum = y * 1.4426950408889634 + round, k = sum - round, r = y - k * 0.693147180369123816490 - k * 1.90821492927058770002e-10;
  V series = all(1.0 / 6227020800.0);
  double factorial = 6227020800.0;
  for (int n = 13; n > 0; --n) {
    factorial /= n;
    series = series * r + 1 / factorial;
  }
  return series * (V)(((Bits)sum + 1023) << 52);
}

/// What the points of a group have in a step; e_v and p0 run linearly in it.
struct Group {
  V strain_before, strain_rate, heating_before, heating_rate;
};

CALOMEL_INLINE V share_of_gas(const BubblyNumbers& b, V radius) {
  const V x = radius / b.radius;
  return b.alpha0 * x * x * x;
}

CALOMEL_INLINE V pressure(const BubblyNumbers& b, V strain, V heating, V rate, V radius) {
  const V p = heating - b.bulk_modulus * (strain - share_of_gas(b, radius) + b.alpha0) - b.liquid_viscosity * rate, least = all(-b.tensile_cutoff);
  return p > least ? p : least;
}

CALOMEL_INLINE V gas_pressure(const BubblyNumbers& b, V radius) { return b.gas_at_rest * exp_of(-3 * b.polytropic * log_of(radius / b.radius)); }

/// Radius and rate after the time dt; what stops a lane, if anything does.
CALOMEL_INLINE BubbleFailure advance_group(const BubblyNumbers& b, const Group& g, double dt, V& radius, V& rate) {
  constexpr int most_steps = 200000;
  const auto pressure_at = [&](V t, V r) __attribute__((always_inline)) {
    return pressure(b, g.strain_before + g.strain_rate * t, g.heating_before + g.heating_rate * t, g.strain_rate, r);
  };
  V t{}, r = radius, v = rate;
  for (int step = 0; step < most_steps; ++step) {
    const V left = dt - t, gas = gas_pressure(b, r), p = pressure_at(t, r);
    const V rate_squared = bubble_rate_squared(b, r, v, p, gas) + b.coupling * r;
    V h = left;
    if (any((left * left * rate_squared > 0.16) | (left > b.greatest_step)))  // more than one
      for (int l = 0; l < width; ++l) {
        const double stable = 0.4 / __builtin_sqrt(rate_squared[l]), limit = stable < b.greatest_step ? stable : b.greatest_step;
        if (left[l] > limit) h[l] = left[l] / __builtin_ceil(left[l] / limit);
      }
    const auto acceleration = [&](V time, V at, V rate_there) __attribute__((always_inline)) {
      return bubble_acceleration(b, at, rate_there, pressure_at(time, at), gas_pressure(b, at));
    };
    const V half = 0.5 * h;
    const V a1 = bubble_acceleration(b, r, v, p, gas), v2 = v + half * a1, a2 = acceleration(t + half, r + half * v, v2);
    const V v3 = v + half * a2, a3 = acceleration(t + half, r + half * v2, v3), v4 = v + h * a3, a4 = acceleration(t + h, r + h * v3, v4);
    r += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    const auto lost = (r <= 0) | (r != r) | (v - v != 0);
    if (any(lost))
      for (int l = 0; l < width; ++l)
        if (lost[l]) return {BubbleFailure::vanished, std::size_t(l), r[l]};
    t = h < left ? t + h : all(dt);
    if (!any(t < dt)) {
      radius = r, rate = v;
      const auto too_much = share_of_gas(b, r) > b.greatest_alpha;
      if (any(too_much))
        for (int l = 0; l < width; ++l)
          if (too_much[l]) return {BubbleFailure::too_much_gas, std::size_t(l), r[l]};
      return {};
    }
  }
  for (int l = 0; l < width; ++l)
    if (t[l] < dt) return {BubbleFailure::too_violent, std::size_t(l), r[l]};
  return {};
}

BubbleFailure advance(const BubblyNumbers& b, const LiquidPoints& points) {
  const double per_step = points.dt > 0 ? 1 / points.dt : 0;
  double *const radii = points.state, *const rates = points.state + points.stride, *const heating_before = points.state + 2 * points.stride;
  for (std::size_t first = 0; first < points.count; first += width) {
    const int here = points.count - first < std::size_t(width) ? int(points.count - first) : width;
    const auto load = [&](const double* from) __attribute__((always_inline)) {  // lanes without a point of their own have the last one's
      if (here == width) return V(*reinterpret_cast<const Unaligned*>(from + first));
      V x{};
      for (int l = 0; l < width; ++l) x[l] = from[first + std::size_t(l < here ? l : here - 1)];
      return x;
    };
    const auto store = [&](double* to, V x) __attribute__((always_inline)) {
      if (here == width) *reinterpret_cast<Unaligned*>(to + first) = x;
      else
        for (int l = 0; l < here; ++l) to[first + std::size_t(l)] = x[l];
    };
    const V strain = load(points.strain), heating = load(points.heating);
    Group g{load(points.strain_before), {}, load(heating_before), {}};
    g.strain_rate = (strain - g.strain_before) * per_step, g.heating_rate = (heating - g.heating_before) * per_step;
    const V radius = load(radii), rate = load(rates);
    const auto moves = (strain != 0) | (g.strain_before != 0) | (heating != 0) | (g.heating_before != 0) | (radius != b.radius) | (rate != 0);
    V now = radius, rate_now = rate;
    if (any(moves) && points.dt > 0) {
      BubbleFailure failure = advance_group(b, g, points.dt, now, rate_now);
      if (failure.reason != BubbleFailure::none) {
        failure.point += first;
        return failure;
      }
      store(radii, moves ? now : radius), store(rates, moves ? rate_now : rate);
    }
    store(heating_before, heating);
    store(points.pressure, moves ? pressure(b, strain, heating, g.strain_rate, now) : V{});
  }
  return {};
}

extern const BubbleKernel bubbles;
const BubbleKernel bubbles{advance};

}  // namespace calomel::CALOMEL_ISA
