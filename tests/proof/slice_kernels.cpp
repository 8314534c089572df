#include "tests/proof/slice_kernels.hpp"

#include <cmath>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define EVERY_MACHINE __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define EVERY_MACHINE
#endif

namespace calomel::proof::kernel {

namespace {

/// The end of a step of a cell: the resistance of the front that closes it, the cutoff, and whether it is open. `further` is a pressure beside the law's own.
[[gnu::always_inline]] inline void give_way(Real& p, Real& opened, Real elastic, Real rate, Real further, const Liquid& q) {
  const Real open = opened;
  const Real closing = rate < 0 ? -q.front * open * rate : Real(0);
  const Real trial = elastic - q.viscosity * rate + closing + further;
  p = trial > -q.cutoff ? trial : -q.cutoff;
  const Real still = rate < 0 ? open : Real(0);
  opened = elastic < -q.cutoff ? Real(1) : still;
}

/// A step of nuclei of one kind, r = R/R0: dR/dt = sign sqrt(2/3 |p + cutoff| / rho), never past p = -cutoff nor below R0. `whole` is the pressure without
/// their void, `stiffness` K times the volume of them at R0, `step` dt sqrt(2/(3 rho))/R0.
[[gnu::always_inline]] inline void grow(Real& r, Real whole, Real stiffness, Real cutoff, Real step) {
  const Real over = -cutoff - whole - stiffness * (r * r * r - 1);  // tension beyond the cutoff
  const Real size = over < 0 ? -over : over;
  const Real free = step * std::sqrt(size), to_balance = size / (3 * stiffness * r * r);
  const Real moved = free < to_balance ? free : to_balance;
  r += over > 0 ? moved : -moved;
  r = r > 1 ? r : Real(1);
}

/// One part of a step of a bubble: b = R/R0, g its rate. The convection 3/2 g^2 slows growth, where it is taken implicitly as the drag is, and hastens
/// collapse. `push_of` is 1/(rho R0^2).
[[gnu::always_inline]] inline void move_bubble(Real& b, Real& g, Real pressure, Real ambient, Real surface, Real push_of, Real damping, Real part, Real most) {
  const Real per_b = 1 / b;
  const Real gas = (ambient + surface) * per_b * per_b * per_b - surface * per_b;
  const Real push = (gas - ambient - pressure) * push_of;
  const Real convection = Real(1.5) * g;
  const Real slows = convection > 0 ? convection : Real(0), hastens = convection < 0 ? convection * g : Real(0);
  const Real free = (g + part * (push - hastens) * per_b) / (1 + part * (slows + damping * per_b) * per_b);
  const Real limit = most * b;
  const Real slower = free < limit ? free : limit;
  const Real bounded = slower > -limit ? slower : -limit;
  const Real next = b + part * bounded;
  g = next > Real(0.1) ? bounded : Real(0);
  b = next > Real(0.1) ? next : Real(0.1);
}

}  // namespace

EVERY_MACHINE void accelerate(Out v, In p, In p_before, Real a, int n) {
  for (int k = 0; k < n; ++k) v[k] -= a * (p[k] - p_before[k]);
}

EVERY_MACHINE void accelerate_solid(Out u, In s, In s_before, In t_after, In t, In a, Real dt, int n) {
  for (int k = 0; k < n; ++k) u[k] += dt * a[k] * ((s[k] - s_before[k]) + (t_after[k] - t[k]));
}

EVERY_MACHINE void riemer(Out p, Out e, Out opened, In p0, In vx, In vz, In vz_after, Liquid q, int n) {
  for (int k = 0; k < n; ++k) {
    const Real rate = ((vx[k + 1] - vx[k]) + (vz_after[k] - vz[k])) * q.per_h;
    const Real strain = e[k] + q.dt * rate;
    const Real elastic = p0[k] * q.ramp - q.modulus * strain;
    e[k] = strain;
    give_way(p[k], opened[k], elastic, rate, Real(0), q);
  }
}

EVERY_MACHINE void tait(Out p, Out e, Out opened, In p0, In vx, In vz, In vz_after, Liquid q, Real exponent, int n) {
  const Real second = (exponent + 1) / 2, third = (exponent + 1) * (exponent + 2) / 6, per_modulus = 1 / q.modulus;
  for (int k = 0; k < n; ++k) {
    const Real rate = ((vx[k + 1] - vx[k]) + (vz_after[k] - vz[k])) * q.per_h;
    const Real strain = e[k] + q.dt * rate;
    const Real s = strain - p0[k] * q.ramp * per_modulus;
    const Real bounded = s < Real(0.02) ? s : Real(0.02);
    const Real elastic = -q.modulus * s * (1 - bounded * (second - third * bounded));
    e[k] = strain;
    give_way(p[k], opened[k], elastic, rate, Real(0), q);
  }
}

EVERY_MACHINE void relaxing(Out p, Out e, Out opened, Out memory, In p0, In vx, In vz, In vz_after, Liquid q, Real keep, Real gain, int n) {
  for (int k = 0; k < n; ++k) {
    const Real rate = ((vx[k + 1] - vx[k]) + (vz_after[k] - vz[k])) * q.per_h;
    const Real strain = e[k] + q.dt * rate;
    const Real elastic = p0[k] * q.ramp - q.modulus * strain;
    const Real s = keep * memory[k] - gain * rate;
    e[k] = strain;
    memory[k] = s;
    give_way(p[k], opened[k], elastic, rate, s, q);
  }
}

EVERY_MACHINE void nucleation(Out p, Out e, Out opened, Out first, Out second, In p0, In vx, In vz, In vz_after, Liquid q, Nuclei nuclei, int n) {
  for (int k = 0; k < n; ++k) {
    const Real rate = ((vx[k + 1] - vx[k]) + (vz_after[k] - vz[k])) * q.per_h;
    const Real strain = e[k] + q.dt * rate;
    const Real whole = p0[k] * q.ramp - q.modulus * strain - q.viscosity * rate;  // without void
    Real r = first[k], s = second[k];
    const Real of_second = nuclei.fraction[1] * (s * s * s - 1);
    grow(r, whole + q.modulus * of_second, q.modulus * nuclei.fraction[0], nuclei.cutoff[0], q.dt * nuclei.speed);
    const Real of_first = nuclei.fraction[0] * (r * r * r - 1);
    grow(s, whole + q.modulus * of_first, q.modulus * nuclei.fraction[1], nuclei.cutoff[1], q.dt * nuclei.speed);
    const Real grown = of_first + nuclei.fraction[1] * (s * s * s - 1);
    const Real open = opened[k];
    const Real closing = rate < 0 ? -q.front * open * rate : Real(0), still = rate < 0 ? open : Real(0);
    const bool apart = grown > Real(1e-7);  // what holds void yields without the front's resistance
    e[k] = strain;
    first[k] = r;
    second[k] = s;
    p[k] = whole + q.modulus * grown + (apart ? Real(0) : closing);
    opened[k] = apart ? Real(1) : still;
  }
}

EVERY_MACHINE void bubbly(Out p, Out e, Out opened, Out b0, Out g0, Out b1, Out g1, In p0, In vx, In vz, In vz_after, Liquid q, Cloud cloud, int n) {
  const Real part = q.dt / 4, most = Real(0.2) / part;
  for (int k = 0; k < n; ++k) {
    const Real rate = ((vx[k + 1] - vx[k]) + (vz_after[k] - vz[k])) * q.per_h;
    const Real strain = e[k] + q.dt * rate;
    const Real heat = p0[k] * q.ramp;
    Real r = b0[k], u = g0[k], s = b1[k], v = g1[k];
#define CALOMEL_PART(rest)                                                                                            \
  {                                                                                                                   \
    const Real grown = cloud.fraction[0] * (r * r * r - 1) + cloud.fraction[1] * (s * s * s - 1);                     \
    const Real elastic = heat - q.modulus * (strain - (rest)*part * rate - grown) - q.viscosity * rate;               \
    const Real pressure = elastic > -q.cutoff ? elastic : -q.cutoff;                                                  \
    move_bubble(r, u, pressure, cloud.ambient, cloud.surface[0], cloud.per_inertia[0], cloud.damping[0], part, most); \
    move_bubble(s, v, pressure, cloud.ambient, cloud.surface[1], cloud.per_inertia[1], cloud.damping[1], part, most); \
  }
    CALOMEL_PART(3)
    CALOMEL_PART(2)
    CALOMEL_PART(1)
    CALOMEL_PART(0)
#undef CALOMEL_PART
    const Real grown = cloud.fraction[0] * (r * r * r - 1) + cloud.fraction[1] * (s * s * s - 1);
    const Real elastic = heat - q.modulus * (strain - grown);
    e[k] = strain;
    b0[k] = r;
    g0[k] = u;
    b1[k] = s;
    g1[k] = v;
    give_way(p[k], opened[k], elastic, rate, Real(0), q);
  }
}

EVERY_MACHINE void strain_increments(Out exx, Out ezz, In ux, In uz, In uz_after, Real dt_per_h, int n) {
  for (int k = 0; k < n; ++k) exx[k] = dt_per_h * (ux[k + 1] - ux[k]), ezz[k] = dt_per_h * (uz_after[k] - uz[k]);
}

EVERY_MACHINE void normal_stress(Out dxx, Out dzz, In exx, In ezz, In exx_below, In exx_above, In p_modulus, In lame, In pair_z, In pair_z_above, In pair_x,
                                 int n) {
  for (int k = 0; k < n; ++k) {
    dxx[k] = p_modulus[k] * exx[k] + lame[k] * ezz[k] + pair_z[k] * (exx[k] - exx_below[k]) - pair_z_above[k] * (exx_above[k] - exx[k]);
    dzz[k] = p_modulus[k] * ezz[k] + lame[k] * exx[k] + pair_x[k] * (ezz[k] - ezz[k - 1]) - pair_x[k + 1] * (ezz[k + 1] - ezz[k]);
  }
}

EVERY_MACHINE void shear_stress(Out dxz, In ux, In ux_below, In uz, In uz_before, In mu, Real dt_per_h, int n) {
  for (int k = 0; k < n; ++k) dxz[k] = mu[k] * dt_per_h * ((ux[k] - ux_below[k]) + (uz[k] - uz_before[k]));
}

EVERY_MACHINE void add(Out s, In d, int n) {
  for (int k = 0; k < n; ++k) s[k] += d[k];
}

EVERY_MACHINE void add_with_memory(Out s, Out m, In d, Real keep, Real strength, int n) {
  for (int k = 0; k < n; ++k) {
    const Real now = keep * m[k] + strength * d[k];
    s[k] += d[k] + (now - m[k]);
    m[k] = now;
  }
}

}  // namespace calomel::proof::kernel
