// Forces of elements in plane strain, which four corners and the directions x and z determine. Included by kernel_impl.hpp.
// Modes of corner values: along the first axis, along the second, and the hourglass.

template <class V>
CALOMEL_INLINE void to_plane_modes(const V* n, V* m) {
  const V d0 = n[1] - n[0], d1 = n[3] - n[2], s0 = n[0] + n[1], s1 = n[2] + n[3];
  m[0] = d0 + d1;
  m[1] = s1 - s0;
  m[2] = d1 - d0;
}
template <class V>
CALOMEL_INLINE void to_plane_corners(const V* m, V* n) {
  const V d0 = m[0] - m[2], d1 = m[0] + m[2];
  n[0] = -m[1] - d0;
  n[1] = d0 - m[1];
  n[2] = m[1] - d1;
  n[3] = m[1] + d1;
}

inline constexpr int plane_volume = 6, plane_x = 7, plane_last = 9;  ///< places of volume, X, and h or K in the terms

template <class V, class Geometry>
CALOMEL_INLINE void plane_gradients(const V (&u)[2][3], Geometry g, V (&grad)[2][2]) {
  for (int c = 0; c < 2; ++c)
    for (int i = 0; i < 2; ++i) grad[c][i] = g(3 * i) * u[c][0] + g(3 * i + 1) * u[c][1] + g(3 * i + 2) * u[c][2];
}

/// Projected hourglass amplitudes.
template <class V, class Geometry>
CALOMEL_INLINE void plane_hourglass(const V (&u)[2][3], const V (&grad)[2][2], Geometry g, V (&q)[2]) {
  for (int c = 0; c < 2; ++c) q[c] = u[c][2] - (g(plane_x) * grad[c][0] + g(plane_x + 1) * grad[c][1]);
}

/// Forces on the modes of minus volume times stress, t, and of the hourglass springs.
template <class V, class Geometry>
CALOMEL_INLINE void spread_plane(V (&t)[2][2], const V (&spring)[2], Geometry g, V (&f)[2][3]) {
  for (int c = 0; c < 2; ++c) {
    for (int i = 0; i < 2; ++i) t[c][i] += g(plane_x + i) * spring[c];
    for (int m = 0; m < 3; ++m) f[c][m] = t[c][0] * g(m) + t[c][1] * g(3 + m);
    f[c][2] -= spring[c];
  }
}

/// As of hexahedra, without an energy balance.
template <Form F, Keep K, bool Given, class V, class Geometry>
CALOMEL_INLINE void liquid_element(const V (&u)[2][3], V (&f)[2][3], Geometry g, const LiquidStep<V>& s, V* state, Sums<V>& sums) {
  static_assert(F == Form::plane && K != Keep::energies);
  V grad[2][2], q[2], spring[2];
  plane_gradients(u, g, grad);
  plane_hourglass(u, grad, g, q);
  const V pv = liquid_pressure<K, Given>(grad[0][0] + grad[1][1], g(plane_volume), s, state, sums) * g(plane_volume), h = s.hourglass * g(plane_last);
  for (int c = 0; c < 2; ++c) spring[c] = h * q[c];
  V t[2][2] = {{pv, V{}}, {V{}, pv}};
  spread_plane(t, spring, g, f);
}

template <Form F, bool Balance, bool Stressed = false, class V, class Geometry>
CALOMEL_INLINE void steel_element(const V (&u)[2][3], V (&f)[2][3], Geometry g, V lambda, V mu, V*, Sums<V>&, const FreeStrain<V>* free = nullptr) {
  static_assert(F == Form::plane && !Balance);
  V grad[2][2], q[2], spring[2];
  plane_gradients(u, g, grad);
  plane_hourglass(u, grad, g, q);
  V xx = 2 * grad[0][0], zz = 2 * grad[1][1], zx = grad[0][1] + grad[1][0], trace = xx + zz;  // twice the strain
  if constexpr (Stressed) {
    xx += 2 * (free->initial[0] - free->thermal);
    zz += 2 * (free->initial[2] - free->thermal);
    zx += 2 * free->initial[5];
    trace = xx + zz + 2 * (free->initial[1] - free->thermal);
  }
  const V minus_volume = -g(plane_volume), pressure = lambda * (V{} + Scalar<V>(0.5)) * trace, shear = minus_volume * (mu * zx);
  V t[2][2] = {{minus_volume * (pressure + mu * xx), shear}, {shear, minus_volume * (pressure + mu * zz)}};
  spring[0] = g(plane_last) * q[0] + g(plane_last + 1) * q[1];
  spring[1] = g(plane_last + 1) * q[0] + g(plane_last + 2) * q[1];
  spread_plane(t, spring, g, f);
}

template <Form F, class V, class Geometry>
CALOMEL_INLINE V element_strain(const V (&u)[2][3], Geometry g) {
  static_assert(F == Form::plane);
  V grad[2][2];
  plane_gradients(u, g, grad);
  return grad[0][0] + grad[1][1];
}
