#include "forward/solver/kernel.hpp"

#include <cstdlib>
#include <string>

#include "base/errors.hpp"

namespace calomel {

#define CALOMEL_DECLARE(isa)                   \
  namespace isa {                              \
  template <class R>                           \
  const KernelTable<R>& table();               \
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
  const char* wish = std::getenv("CALOMEL_ISA");
  const std::string isa = wish ? wish : "";
  if (!isa.empty() && isa != "baseline" && isa != "avx2" && isa != "avx512")
    throw InputError({.problem = "not an instruction set", .key = "CALOMEL_ISA", .value = '"' + isa + '"', .range = "baseline, avx2, avx512"});
#if defined(__x86_64__)
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
  if (avx512 && (isa.empty() || isa == "avx512")) return isa_avx512::table<R>();
  if (avx2 && isa != "baseline") return isa_avx2::table<R>();
#endif
  return isa_baseline::table<R>();
}

template const KernelTable<float>& kernels<float>();
template const KernelTable<double>& kernels<double>();

}  // namespace calomel
