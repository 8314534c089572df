// Included once by each score_kernel_<isa>.cpp inside its own namespace CALOMEL_ISA, so that code for different instruction sets never mixes. No
// standard-library calls in here.
#include "inverse/objective/score_kernel.hpp"

#define CALOMEL_INLINE inline __attribute__((always_inline))

namespace calomel::CALOMEL_ISA {

// Accumulators of a tile are 2 vectors of rows times `most` columns: 24 of the 32 registers of AVX-512, 12 of the 16 of AVX2, 8 of the 16 of the baseline,
// which needs some for products.
#if defined(__AVX512F__)
constexpr std::ptrdiff_t width = 16, most = 12;
#elif defined(__AVX2__)
constexpr std::ptrdiff_t width = 8, most = 6;
#else
constexpr std::ptrdiff_t width = 4, most = 4;
#endif
typedef float V __attribute__((vector_size(width * sizeof(float)), aligned(sizeof(float)), may_alias));
typedef float Aligned __attribute__((vector_size(width * sizeof(float))));

CALOMEL_INLINE Aligned load(const float* p) { return *reinterpret_cast<const V*>(p); }
CALOMEL_INLINE void store(float* p, Aligned v) { *reinterpret_cast<V*>(p) = v; }
CALOMEL_INLINE Aligned all(float x) { return x - Aligned{}; }

/// Running sums of a column, (5, width).
enum { absolute, squares, inside, over, under, quantities };

CALOMEL_INLINE void add_rows(Aligned d, const float* rows, float* s) {
  const Aligned zero{};
  const Aligned low = load(rows + panel_rows), high = load(rows + 2 * panel_rows), inverse_width = load(rows + 3 * panel_rows);
  store(s + absolute * width, load(s + absolute * width) + (d < zero ? -d : d));
  store(s + squares * width, load(s + squares * width) + d * d);
  store(s + inside * width, load(s + inside * width) + (((d > low) & (d < high)) ? all(1) : zero));
  const Aligned a = (d - high) * inverse_width, b = (low - d) * inverse_width;
  const Aligned o = load(s + over * width), u = load(s + under * width);
  store(s + over * width, a > o ? a : o);
  store(s + under * width, b > u ? b : u);
}

/// C columns on one panel.
template <int C>
CALOMEL_INLINE void tile(const float* directions, const float* rows, std::ptrdiff_t rank, const float* coefficients, float* sums) {
  for (std::ptrdiff_t half = 0; half < panel_rows; half += 2 * width) {
    Aligned d0[C], d1[C];
    const Aligned offset0 = load(rows + half), offset1 = load(rows + half + width);
#pragma GCC unroll 16
    for (int c = 0; c < C; ++c) d0[c] = offset0, d1[c] = offset1;
    const float* a = directions + half;
    const float* b = coefficients;
    for (std::ptrdiff_t k = 0; k < rank; ++k, a += panel_rows, b += C) {
      const Aligned a0 = load(a), a1 = load(a + width);
#pragma GCC unroll 16
      for (int c = 0; c < C; ++c) {
        const Aligned x = all(b[c]);
        d0[c] += a0 * x;
        d1[c] += a1 * x;
      }
    }
#pragma GCC unroll 16
    for (int c = 0; c < C; ++c) {
      add_rows(d0[c], rows + half, sums + c * (quantities * width));
      add_rows(d1[c], rows + half + width, sums + c * (quantities * width));
    }
  }
}

template <int C>
void last_tile(const float* directions, const float* rows, std::ptrdiff_t rank, const float* coefficients, std::ptrdiff_t columns, float* sums) {
  if constexpr (C > 0) {
    if (columns == C)
      tile<C>(directions, rows, rank, coefficients, sums);
    else
      last_tile<C - 1>(directions, rows, rank, coefficients, columns, sums);
  }
}

void score(const ScorePanels& p, const float* coefficients, std::ptrdiff_t columns, ScoreSums* sums, float* scratch) {
  constexpr std::ptrdiff_t of_column = quantities * width;
  for (std::ptrdiff_t i = 0; i < columns * of_column; ++i) scratch[i] = 0;
  for (std::ptrdiff_t panel = 0; panel < p.panels; ++panel) {  // a panel remains in the cache for all columns
    const float* directions = p.directions + panel * p.rank * panel_rows;
    const float* rows = p.rows + panel * 4 * panel_rows;
    std::ptrdiff_t c = 0;
    for (; c + most <= columns; c += most) tile<most>(directions, rows, p.rank, coefficients + c * p.rank, scratch + c * of_column);
    if (c < columns) last_tile<most - 1>(directions, rows, p.rank, coefficients + c * p.rank, columns - c, scratch + c * of_column);
  }
  for (std::ptrdiff_t c = 0; c < columns; ++c) {
    const float* s = scratch + c * of_column;
    float sum[quantities] = {0, 0, 0, 0, 0};
    for (int q = 0; q < over; ++q)
      for (int i = 0; i < width; ++i) sum[q] += s[q * width + i];
    for (int q = over; q < quantities; ++q)
      for (int i = 0; i < width; ++i) sum[q] = s[q * width + i] > sum[q] ? s[q * width + i] : sum[q];
    sums[c] = {sum[absolute], sum[squares], sum[inside], sum[over], sum[under]};
  }
}

extern const ScoreKernel kernel;
const ScoreKernel kernel{most, score};

}  // namespace calomel::CALOMEL_ISA
