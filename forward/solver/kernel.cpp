#include "forward/solver/kernel.hpp"

#include "base/instruction_set.hpp"

namespace calomel {

#define CALOMEL_DECLARE(isa)                                  \
  namespace isa {                                             \
  template <class R>                                          \
  const KernelTable<R>& table();                              \
  extern template const KernelTable<float>& table<float>();   \
  extern template const KernelTable<double>& table<double>(); \
  }
CALOMEL_DECLARE(isa_baseline)
#if defined(__x86_64__)
CALOMEL_DECLARE(isa_avx2)
CALOMEL_DECLARE(isa_avx512)
#endif
#undef CALOMEL_DECLARE

template <class R>
const KernelTable<R>& kernels() {
  [[maybe_unused]] const InstructionSet isa = instruction_set();
#if defined(__x86_64__)
  if (isa == InstructionSet::avx512) return isa_avx512::table<R>();
  if (isa == InstructionSet::avx2) return isa_avx2::table<R>();
#endif
  return isa_baseline::table<R>();
}

template const KernelTable<float>& kernels<float>();
template const KernelTable<double>& kernels<double>();

}  // namespace calomel
