#include "inverse/objective/score_kernel.hpp"

namespace calomel {

namespace isa_baseline {
extern const ScoreKernel kernel;
}
#if defined(__x86_64__)
namespace isa_avx2 {
extern const ScoreKernel kernel;
}
namespace isa_avx512 {
extern const ScoreKernel kernel;
}
#endif

const ScoreKernel& score_kernel([[maybe_unused]] InstructionSet isa) {
#if defined(__x86_64__)
  if (isa == InstructionSet::avx512) return isa_avx512::kernel;
  if (isa == InstructionSet::avx2) return isa_avx2::kernel;
#endif
  return isa_baseline::kernel;
}

}  // namespace calomel
