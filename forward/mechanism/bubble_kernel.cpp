#include "forward/mechanism/bubble_kernel.hpp"

namespace calomel {

#if defined(__x86_64__)
namespace isa_avx512 {
extern const BubbleKernel bubbles;
}
namespace isa_avx2 {
extern const BubbleKernel bubbles;
}
#endif
namespace isa_baseline {
extern const BubbleKernel bubbles;
}

const BubbleKernel& bubble_kernel(InstructionSet isa) {
#if defined(__x86_64__)
  if (isa == InstructionSet::avx512) return isa_avx512::bubbles;
  if (isa == InstructionSet::avx2) return isa_avx2::bubbles;
#endif
  (void)isa;
  return isa_baseline::bubbles;
}

}  // namespace calomel
