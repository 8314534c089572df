#include "forward/surrogate/matern_kernel.hpp"

namespace calomel {

namespace isa_baseline {
void matern_means(const MaternProcess&, const double*, std::ptrdiff_t, double*, double*);
}
#if defined(__x86_64__)
namespace isa_avx2 {
void matern_means(const MaternProcess&, const double*, std::ptrdiff_t, double*, double*);
}
namespace isa_avx512 {
void matern_means(const MaternProcess&, const double*, std::ptrdiff_t, double*, double*);
}
#endif

MaternMeans matern_means([[maybe_unused]] InstructionSet isa) {
#if defined(__x86_64__)
  if (isa == InstructionSet::avx512) return isa_avx512::matern_means;
  if (isa == InstructionSet::avx2) return isa_avx2::matern_means;
#endif
  return isa_baseline::matern_means;
}

}  // namespace calomel
