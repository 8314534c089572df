#pragma once
/// The inner loops of the slice, along x over n cells, faces or corners with consecutive indices; each is compiled for several instruction sets.
#include "tests/proof/slice.hpp"

namespace calomel::proof::kernel {

using In = const Real* __restrict;
using Out = Real* __restrict;

/// v -= a (p - p_before): `p` and `p_before` are the cells on the far and the near side of the face.
void accelerate(Out v, In p, In p_before, Real a, int n);

/// u += dt a ((s - s_before) + (t_after - t)).
void accelerate_solid(Out u, In s, In s_before, In t_after, In t, In a, Real dt, int n);

struct Liquid {
  Real modulus, viscosity, front, cutoff, dt, per_h, ramp;
};

/// Riemer's law, p = max(p0 - K e - eta rate, -cutoff). `opened` is 1 from the moment a cell has given way until the front that closes it has passed: there the
/// rate is resisted by `front`, too.
void riemer(Out p, Out e, Out opened, In p0, In vx, In vz, In vz_after, Liquid q, int n);

/// The same with Tait's equation of state, p = K/m ((1 + s)^-m - 1) of s = e - p0/K, to third order in s (1e-3 at most).
void tait(Out p, Out e, Out opened, In p0, In vx, In vz, In vz_after, Liquid q, Real exponent, int n);

/// The same with a further viscous pressure that relaxes, ds/dt = -s/time - (zeta/time) rate.
void relaxing(Out p, Out e, Out opened, Out memory, In p0, In vx, In vz, In vz_after, Liquid q, Real keep, Real gain, int n);

struct Nuclei {
  Real fraction[2], cutoff[2], speed;  ///< volume of either kind in a volume at rest; tension at which it opens; sqrt(2/(3 rho))/R0
};

/// Void grows from nuclei of two kinds, one of which opens at the cutoff and the other at a greater tension: dR/dt = sign sqrt(2/3 |p + cutoff| / rho) of
/// either (Rayleigh, without R''), never past its balance. `first`, `second`: R in units of the nucleus.
void nucleation(Out p, Out e, Out opened, Out first, Out second, In p0, In vx, In vz, In vz_after, Liquid q, Nuclei nuclei, int n);

struct Cloud {
  Real fraction[2], per_inertia[2], surface[2], damping[2];  ///< 1/(rho R0^2), 2 tension/R0, 4 viscosity/(rho R0^2)
  Real ambient;
};

/// Bubbles of two sizes after Rayleigh and Plesset, isothermal, b = R/R0:  b b'' + 3/2 b'^2 = (p_gas - ambient - p)/(rho R0^2) - damping b'/b. They are
/// advanced in four parts of the step; a bubble changes by a fifth in a part at most and is not crushed below a tenth of its radius, where its motion is lost
/// (it breaks up).
void bubbly(Out p, Out e, Out opened, Out b0, Out g0, Out b1, Out g1, In p0, In vx, In vz, In vz_after, Liquid q, Cloud cloud, int n);

void strain_increments(Out exx, Out ezz, In ux, In uz, In uz_after, Real dt_per_h, int n);

/// Stress increments of solid cells. The last terms carry what a strain that is linear across a cell adds in bending: with them n cells through a wall have its
/// whole stiffness, without them 1 - 1/n^2 of it. exx_below, exx_above: the rows below and above.
void normal_stress(Out dxx, Out dzz, In exx, In ezz, In exx_below, In exx_above, In p_modulus, In lame, In pair_z, In pair_z_above, In pair_x, int n);

void shear_stress(Out dxz, In ux, In ux_below, In uz, In uz_before, In mu, Real dt_per_h, int n);

void add(Out s, In d, int n);

/// Standard linear solid: sigma = relaxed + m, dm/dt = strength d(relaxed)/dt - m/time.
void add_with_memory(Out s, Out m, In d, Real keep, Real strength, int n);

}  // namespace calomel::proof::kernel
