// Lanes, Walsh-Hadamard modes of corner values, and the way between node rows and lanes. Included by kernel_impl.hpp inside
// the namespace of one instruction set.

template <class R, int W>
struct Simd {
  typedef R type __attribute__((vector_size(sizeof(R) * W)));
};
template <class R, int W>
using Vec = typename Simd<R, W>::type;

template <class R>
inline constexpr int element_lanes = sizeof(R) == 4 ? 8 : 4;

// Bytes of this instruction set's vectors.
#if defined(__AVX512F__)
inline constexpr int vector_bytes = 64;
#elif defined(__AVX__)
inline constexpr int vector_bytes = 32;
#else
inline constexpr int vector_bytes = 16;
#endif

template <class R, int W>
struct Halves;
template <class R, int W, bool Native>
struct LanesOf {
  using type = Vec<R, W>;
};
template <class R, int W>
struct LanesOf<R, W, false> {
  using type = Halves<R, W>;
};
/// W lanes in vectors that the processor has: GCC's own way with wider ones is up to ten times slower.
template <class R, int W>
using LaneVec = typename LanesOf<R, W, sizeof(R) * W <= vector_bytes>::type;

template <class M>
struct HalvesMask {
  M lo, hi;
};
template <class R, int W>
struct Halves {
  using Half = LaneVec<R, W / 2>;
  Half lo, hi;
  CALOMEL_INLINE R& operator[](int l) { return reinterpret_cast<R*>(this)[l]; }
  CALOMEL_INLINE R operator[](int l) const { return reinterpret_cast<const R*>(this)[l]; }
  CALOMEL_INLINE Halves operator-() const { return {-lo, -hi}; }
#define CALOMEL_HALVES_OPERATOR(op)                                                                                   \
  friend CALOMEL_INLINE Halves operator op(const Halves& a, const Halves& b) { return {a.lo op b.lo, a.hi op b.hi}; } \
  friend CALOMEL_INLINE Halves operator op(const Halves& a, R b) { return {a.lo op b, a.hi op b}; }                   \
  friend CALOMEL_INLINE Halves operator op(R a, const Halves& b) { return {a op b.lo, a op b.hi}; }
  CALOMEL_HALVES_OPERATOR(+)
  CALOMEL_HALVES_OPERATOR(-)
  CALOMEL_HALVES_OPERATOR(*)
  CALOMEL_HALVES_OPERATOR(/)
#undef CALOMEL_HALVES_OPERATOR
  CALOMEL_INLINE Halves& operator+=(const Halves& b) { return *this = *this + b; }
  CALOMEL_INLINE Halves& operator-=(const Halves& b) { return *this = *this - b; }
  friend CALOMEL_INLINE auto operator>(const Halves& a, const Halves& b) { return HalvesMask<decltype(a.lo > b.lo)>{a.lo > b.lo, a.hi > b.hi}; }
  friend CALOMEL_INLINE auto operator<=(const Halves& a, const Halves& b) { return HalvesMask<decltype(a.lo <= b.lo)>{a.lo <= b.lo, a.hi <= b.hi}; }
  friend CALOMEL_INLINE auto operator<(const Halves& a, R b) { return HalvesMask<decltype(a.lo < b)>{a.lo < b, a.hi < b}; }
};

/// a where the condition holds, else b.
template <class C, class V>
CALOMEL_INLINE V select(C condition, V a, V b) {
  return condition ? a : b;
}
template <class M, class R, int W>
CALOMEL_INLINE Halves<R, W> select(const HalvesMask<M>& condition, const Halves<R, W>& a, const Halves<R, W>& b) {
  return {select(condition.lo, a.lo, b.lo), select(condition.hi, a.hi, b.hi)};
}
template <class V>
CALOMEL_INLINE V greater(V a, V b) {
  return select(a > b, a, b);
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
  m[1] = sd0 + sd1;
  m[2] = ts0 + ts1;
  m[3] = td0 + td1;
  m[4] = ss1 - ss0;
  m[5] = sd1 - sd0;
  m[6] = ts1 - ts0;
  m[7] = td1 - td0;
}
template <class V>
CALOMEL_INLINE void to_corners(const V* m, V* n) {
  const V ss0 = -m[4], sd0 = m[1] - m[5], ts0 = m[2] - m[6], td0 = m[3] - m[7];
  const V ss1 = m[4], sd1 = m[1] + m[5], ts1 = m[2] + m[6], td1 = m[3] + m[7];
  const V s0 = ss0 - ts0, s1 = ss0 + ts0, d0 = sd0 - td0, d1 = sd0 + td0;
  const V s2 = ss1 - ts1, s3 = ss1 + ts1, d2 = sd1 - td1, d3 = sd1 + td1;
  n[0] = s0 - d0;
  n[1] = s0 + d0;
  n[2] = s1 - d1;
  n[3] = s1 + d1;
  n[4] = s2 - d2;
  n[5] = s2 + d2;
  n[6] = s3 - d3;
  n[7] = s3 + d3;
}

CALOMEL_INLINE constexpr int linear_mode(int j) { return 1 << j; }
CALOMEL_INLINE constexpr int hourglass_mode(int a) { return a == 0 ? 3 : a + 4; }

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
  using Lane = LaneVec<R, run_lanes>;
  static constexpr int width = 3 * run_lanes;
};

template <class R, bool Runs>
CALOMEL_INLINE void read_row(const R* p, typename Row<R, Runs>::Lane (&x)[3]) {
  if constexpr (Runs)
    for (int c = 0; c < 3; ++c) x[c] = load<LaneVec<R, run_lanes>>(p + c * run_lanes);
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
