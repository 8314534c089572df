// Forces of one group of elements from the modes of their corners' displacements. Included by kernel_impl.hpp.

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

template <class V>
using Scalar = std::remove_reference_t<decltype(V{}[0])>;

/// The liquid's scalars, each a lane vector or a broadcast.
template <class V>
struct LiquidStep {
  V bulk_modulus, minus_cutoff, hourglass, p0, p0_before;
  V ratio, rate_factor, quadratic, collapse, cutoff, dt;  // beta/dt, 1/dt
  V pressure;                                             // of a law of its own
};

/// F - 1 from displacement gradients: the volume ratio less one, and the cofactor of F = 1 + grad.
template <class V>
CALOMEL_INLINE V volume_change(const V (&grad)[3][3], V (&cofactor)[3][3]) {
  V f[3][3];
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 3; ++i) f[c][i] = c == i ? grad[c][i] + 1 : grad[c][i];
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 3; ++i) {
      const int c1 = (c + 1) % 3, c2 = (c + 2) % 3, i1 = (i + 1) % 3, i2 = (i + 2) % 3;
      cofactor[c][i] = f[c1][i1] * f[c2][i2] - f[c1][i2] * f[c2][i1];
    }
  // det(1 + g) - 1 = tr g + second invariant of g + det g: no cancellation against 1 in single precision.
  const V second =
      grad[0][0] * grad[1][1] - grad[0][1] * grad[1][0] + grad[1][1] * grad[2][2] - grad[1][2] * grad[2][1] + grad[2][2] * grad[0][0] - grad[2][0] * grad[0][2];
  const V third = grad[0][0] * (grad[1][1] * grad[2][2] - grad[1][2] * grad[2][1]) - grad[0][1] * (grad[1][0] * grad[2][2] - grad[1][2] * grad[2][0]) +
                  grad[0][2] * (grad[1][0] * grad[2][1] - grad[1][1] * grad[2][0]);
  return grad[0][0] + grad[1][1] + grad[2][2] + second + third;
}

/// Volumetric strain of an element, by its form.
template <Form F, class V>
CALOMEL_INLINE V volumetric_strain(const V (&grad)[3][3]) {
  if constexpr (F == Form::finite) {
    V cofactor[3][3];
    return volume_change(grad, cofactor);
  } else {
    return grad[0][0] + grad[1][1] + grad[2][2];
  }
}

/// The same from the modes of its corners.
template <Form F, class V, class Geometry>
CALOMEL_INLINE V element_strain(const V (&u)[3][8], Geometry g) {
  V grad[3][3];
  gradients<F == Form::parallelepiped>(u, g, grad);
  return volumetric_strain<F>(grad);
}

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

/// What an element's rate of volume does, found from its strain w = e_v + beta de_v/dt and `state` (kernel.hpp).
template <class V>
struct Motion {
  V strain, change;       ///< e_v, and by how much it grew in the step
  V quadratic, collapse;  ///< pressures against compression: quadratic viscosity, and that of liquid that has been at the cutoff
};

template <Keep K, class V>
CALOMEL_INLINE Motion<V> motion(V w, const LiquidStep<V>& s, const V* state) {
  const V one = V{} + 1;
  Motion<V> m;
  m.strain = (w + s.ratio * state[0]) / (one + s.ratio);
  m.change = m.strain - state[0];
  V opened;
  if constexpr (K == Keep::energies)
    opened = select(state[state_time_at_cutoff] > 0, one, V{});
  else
    opened = state[1];
  const V rate = m.change * s.rate_factor;
  m.quadratic = select(rate < 0, s.quadratic * rate * rate, V{});
  m.collapse = select(rate < 0, s.collapse * opened * rate, V{});
  return m;
}

/// Stored, dissipated and heat of Riemer's law in a step that ends at pressure p.
template <class V>
CALOMEL_INLINE void count_riemer(V p, const Motion<V>& m, V volume, const LiquidStep<V>& s, V* state, Sums<V>& sums) {
  const V half = V{} + Scalar<V>(0.5);
  const V elastic = greater(s.p0 - s.bulk_modulus * m.strain, s.minus_cutoff);
  const V elastic_before = greater(s.p0_before - s.bulk_modulus * state[0], s.minus_cutoff);
  const V viscous = p - elastic;
  sums.dissipated -= (viscous + state[1]) * m.change * volume * half;
  sums.heat += (elastic + elastic_before) * (s.p0 - s.p0_before) / s.bulk_modulus * volume * half;
  const V stretch = m.strain - s.p0 / s.bulk_modulus, limit = s.cutoff / s.bulk_modulus;
  sums.liquid += volume * select(stretch <= limit, half * s.bulk_modulus * stretch * stretch, s.cutoff * (stretch - half * limit));
  state[0] = m.strain;
  state[1] = viscous;
}

/// Work done on a liquid with a law of its own, stored and dissipated together.
template <class V>
CALOMEL_INLINE void count_work(V p, const Motion<V>& m, V volume, V* state, Sums<V>& sums) {
  sums.dissipated -= (p + state[1]) * m.change * volume * (V{} + Scalar<V>(0.5));
  state[0] = m.strain;
  state[1] = p;
}

/// Pressure of a liquid element: Riemer's, or that of a law of its own; above the cutoff with the resistance of liquid that has been there.
template <Keep K, bool Given, class V>
CALOMEL_INLINE V liquid_pressure(V w, V volume, const LiquidStep<V>& s, V* state, Sums<V>& sums) {
  if constexpr (K == Keep::nothing) {
    return Given ? s.pressure : greater(s.p0 - s.bulk_modulus * w, s.minus_cutoff);
  } else {
    const Motion<V> m = motion<K>(w, s, state);
    V p = Given ? s.pressure + select(s.pressure > s.minus_cutoff, m.quadratic, V{}) : greater(s.p0 - s.bulk_modulus * w + m.quadratic, s.minus_cutoff);
    const V at_cutoff = select(p <= s.minus_cutoff, V{} + 1, V{});
    p -= select(p > s.minus_cutoff, m.collapse, V{});
    if constexpr (K == Keep::rate) {
      state[0] = m.strain;
      state[1] = greater(state[1], at_cutoff);
    } else {
      Given ? count_work(p, m, volume, state, sums) : count_riemer(p, m, volume, s, state, sums);
      state[state_time_at_cutoff] += s.dt * at_cutoff;
    }
    return p;
  }
}

/// Given: the pressure is that of a law of its own.
template <Form F, Keep K, bool Given, class V, class Geometry>
CALOMEL_INLINE void liquid_element(const V (&u)[3][8], V (&f)[3][8], Geometry g, const LiquidStep<V>& s, V* state, Sums<V>& sums) {
  constexpr bool affine = F == Form::parallelepiped, balance = K == Keep::energies;
  constexpr int terms = affine ? 9 : 21;
  const V volume = g(terms), h = s.hourglass * g(terms + 1);
  V grad[3][3], cofactor[3][3];
  gradients<affine>(u, g, grad);
  V w;  // e_v + (eta/K) de_v/dt
  if constexpr (F == Form::finite)
    w = volume_change(grad, cofactor);
  else
    w = grad[0][0] + grad[1][1] + grad[2][2];
  const V p = liquid_pressure<K, Given>(w, volume, s, state, sums);
  const V pv = p * volume;
  if constexpr (affine) {
    for (int c = 0; c < 3; ++c) {
      for (int j = 0; j < 3; ++j) f[c][linear_mode(j)] = pv * g(c * 3 + j);
      for (int a = 0; a < 4; ++a) {
        const V q = u[c][hourglass_mode(a)];
        f[c][hourglass_mode(a)] = -h * q;
        if constexpr (balance) book_hourglass(q, h, s, state + 2 + c * 4 + a, sums);
      }
    }
  } else {
    V t[3][3], force[3][4];
    for (int c = 0; c < 3; ++c) {
      for (int a = 0; a < 4; ++a) {
        const V q = u[c][hourglass_mode(a)] - (g(23 + a) * grad[c][0] + g(27 + a) * grad[c][1] + g(31 + a) * grad[c][2]);
        force[c][a] = h * q;
        if constexpr (balance) book_hourglass(q, h, s, state + 2 + c * 4 + a, sums);
      }
      for (int i = 0; i < 3; ++i) {
        V s2;
        if constexpr (F == Form::finite)
          s2 = pv * cofactor[c][i];
        else
          s2 = i == c ? pv : V{};
        for (int a = 0; a < 4; ++a) s2 += g(23 + i * 4 + a) * force[c][a];
        t[c][i] = s2;
      }
    }
    spread<false>(t, g, f);
    for (int c = 0; c < 3; ++c)
      for (int a = 0; a < 4; ++a) f[c][hourglass_mode(a)] -= force[c][a];
  }
}

/// Square of the von Mises stress.
template <class V>
CALOMEL_INLINE V effective_squared(const V (&s)[3][3]) {
  const V a = s[0][0] - s[1][1], b = s[1][1] - s[2][2], c = s[2][2] - s[0][0];
  return (a * a + b * b + c * c) * (V{} + Scalar<V>(0.5)) + 3 * (s[0][1] * s[0][1] + s[1][2] * s[1][2] + s[2][0] * s[2][0]);
}

/// Rotation of F = 1 + grad by two steps of Newton and Schulz, X <- X (3 - X^T X) / 2: exact to the fourth power of the strain,
/// for any rotation.
template <class V>
CALOMEL_INLINE void rotation_of(const V (&grad)[3][3], V (&r)[3][3]) {
  const V half = V{} + Scalar<V>(0.5);
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 3; ++i) r[c][i] = c == i ? grad[c][i] + 1 : grad[c][i];
  for (int step = 0; step < 2; ++step) {
    V m[3][3], next[3][3];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) m[i][j] = (i == j ? V{} + 3 : V{}) - (r[0][i] * r[0][j] + r[1][i] * r[1][j] + r[2][i] * r[2][j]);
    for (int c = 0; c < 3; ++c)
      for (int j = 0; j < 3; ++j) next[c][j] = half * (r[c][0] * m[0][j] + r[c][1] * m[1][j] + r[c][2] * m[2][j]);
    for (int c = 0; c < 3; ++c)
      for (int j = 0; j < 3; ++j) r[c][j] = next[c][j];
  }
}

/// a <- R a (or R^T a) for vectors held by component.
template <bool Transposed, int N, class V>
CALOMEL_INLINE void rotate(const V (&r)[3][3], V (&a)[3][N]) {
  for (int k = 0; k < N; ++k) {
    V x[3];
    for (int c = 0; c < 3; ++c)
      x[c] = Transposed ? r[0][c] * a[0][k] + r[1][c] * a[1][k] + r[2][c] * a[2][k] : r[c][0] * a[0][k] + r[c][1] * a[1][k] + r[c][2] * a[2][k];
    for (int c = 0; c < 3; ++c) a[c][k] = x[c];
  }
}

/// What stressed steel has beyond its displacement: sigma = C : (epsilon - alpha dT 1 + initial).
template <class V>
struct FreeStrain {
  V thermal, thermal_before;  ///< alpha dT now and one step earlier [-]
  V initial[6];               ///< strain of the stress before the run, xx yy zz xy yz zx [-]
  V* trace;                   ///< of the stress one step earlier [Pa]; null: without an energy balance
};

/// Minus volume times the first Piola-Kirchhoff stress, sigma (or F S of St. Venant and Kirchhoff with Green's strain).
/// What is stored is 1/2 sigma : s of the elastic strain s, and heat puts in -tr(sigma) d(alpha dT).
template <Form F, bool Balance, bool Stressed = false, class V>
CALOMEL_INLINE void steel_stress(const V (&grad)[3][3], V minus_volume, V lambda, V mu, V (&t)[3][3], V* state, Sums<V>& sums,
                                 const FreeStrain<V>* free = nullptr) {
  V strain[3][3], stress[3][3];  // strain: twice the tensor
  for (int c = 0; c < 3; ++c)
    for (int i = c; i < 3; ++i) {
      strain[c][i] = grad[c][i] + grad[i][c];
      if constexpr (F == Form::finite) strain[c][i] += grad[0][c] * grad[0][i] + grad[1][c] * grad[1][i] + grad[2][c] * grad[2][i];
      strain[i][c] = strain[c][i];
    }
  if constexpr (Stressed) {
    for (int c = 0; c < 3; ++c) strain[c][c] += 2 * (free->initial[c] - free->thermal);
    for (int k = 0; k < 3; ++k) {
      const int c = k == 1 ? 1 : 0, i = k == 0 ? 1 : 2;  // xy yz zx
      strain[c][i] = strain[i][c] = strain[c][i] + 2 * free->initial[3 + k];
    }
  }
  const V pressure = lambda * (V{} + Scalar<V>(0.5)) * (strain[0][0] + strain[1][1] + strain[2][2]);
  for (int c = 0; c < 3; ++c)
    for (int i = c; i < 3; ++i) {
      stress[c][i] = stress[i][c] = i == c ? pressure + mu * strain[c][c] : mu * strain[c][i];
      if constexpr (Balance) sums.steel -= minus_volume * stress[c][i] * (i == c ? (V{} + Scalar<V>(0.5)) * strain[c][c] : strain[c][i]);
    }
  if constexpr (Balance) state[0] = greater(state[0], effective_squared(stress));
  if constexpr (Balance && Stressed)
    if (free->trace) {
      const V trace = stress[0][0] + stress[1][1] + stress[2][2];
      sums.heat += minus_volume * (V{} + Scalar<V>(0.5)) * (trace + *free->trace) * (free->thermal - free->thermal_before);
      *free->trace = trace;
    }
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 3; ++i) {
      V s = stress[c][i];
      if constexpr (F == Form::finite) s += grad[c][0] * stress[0][i] + grad[c][1] * stress[1][i] + grad[c][2] * stress[2][i];
      t[c][i] = minus_volume * s;
    }
}

template <Form F, bool Balance, bool Stressed = false, class V, class Geometry>
CALOMEL_INLINE void steel_element(const V (&u)[3][8], V (&f)[3][8], Geometry g, V lambda, V mu, V* state, Sums<V>& sums, const FreeStrain<V>* free = nullptr) {
  constexpr bool affine = F == Form::parallelepiped;
  constexpr int at_volume = affine ? 9 : 21, at_x = 22, at_bending = affine ? 10 : 34, at_last = at_bending + 45;
  V grad[3][3], t[3][3], r[3][3];
  gradients<affine>(u, g, grad);
  steel_stress<F, Balance, Stressed>(grad, -g(at_volume), lambda, mu, t, state, sums, free);
  V q[3][4], force[3][4];
  for (int c = 0; c < 3; ++c)
    for (int a = 0; a < 4; ++a) {
      q[c][a] = u[c][hourglass_mode(a)];
      if constexpr (!affine) q[c][a] -= g(at_x + a) * grad[c][0] + g(at_x + 4 + a) * grad[c][1] + g(at_x + 8 + a) * grad[c][2];
    }
  if constexpr (F == Form::finite) rotation_of(grad, r), rotate<true>(r, q);
  for (int i = 0; i < 9; ++i) {
    V s{};
    for (int j = 0; j < 9; ++j) {
      const int low = i < j ? i : j, high = i < j ? j : i;
      s += g(at_bending + low * 9 - low * (low - 1) / 2 + high - low) * q[j / 3][j % 3];
    }
    force[i / 3][i % 3] = s;
  }
  force[0][3] = g(at_last) * q[0][3] + g(at_last + 1) * q[1][3] + g(at_last + 2) * q[2][3];
  force[1][3] = g(at_last + 1) * q[0][3] + g(at_last + 3) * q[1][3] + g(at_last + 4) * q[2][3];
  force[2][3] = g(at_last + 2) * q[0][3] + g(at_last + 4) * q[1][3] + g(at_last + 5) * q[2][3];
  if constexpr (Balance)
    for (int c = 0; c < 3; ++c)
      for (int a = 0; a < 4; ++a) sums.steel += force[c][a] * q[c][a];
  if constexpr (F == Form::finite) rotate<false>(r, force);
  if constexpr (!affine)
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < 3; ++i)
        for (int a = 0; a < 4; ++a) t[c][i] += g(at_x + i * 4 + a) * force[c][a];
  spread<affine>(t, g, f);
  for (int c = 0; c < 3; ++c)
    for (int a = 0; a < 4; ++a) f[c][hourglass_mode(a)] -= force[c][a];
}

/// f = -K u over the 21 mode values of an element.
template <bool Balance, class V, class Geometry>
CALOMEL_INLINE void dense_element(const V (&u)[3][8], V (&f)[3][8], Geometry g, Sums<V>& sums) {
  for (int i = 0; i < 21; ++i) {
    V s{};
    for (int j = 0; j < 21; ++j) {
      const int low = i < j ? i : j, high = i < j ? j : i;
      s += g(1 + low * 21 - low * (low - 1) / 2 + high - low) * u[j / 7][1 + j % 7];
    }
    f[i / 7][1 + i % 7] = -s;
    if constexpr (Balance) sums.steel += s * u[i / 7][1 + i % 7];
  }
}
