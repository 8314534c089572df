#include "base/instruction_set.hpp"

#include <cstdlib>
#include <string>

#include "base/errors.hpp"

namespace calomel {

const char* name_of(InstructionSet isa) { return isa == InstructionSet::avx512 ? "avx512" : isa == InstructionSet::avx2 ? "avx2" : "baseline"; }

std::vector<InstructionSet> instruction_sets() {
  std::vector<InstructionSet> all{InstructionSet::baseline};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    all.push_back(InstructionSet::avx2);
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")) all.push_back(InstructionSet::avx512);
  }
#endif
  return all;
}

InstructionSet instruction_set() {
  const char* wish = std::getenv("CALOMEL_ISA");
  const std::string limit = wish ? wish : "";
  if (!limit.empty() && limit != "baseline" && limit != "avx2" && limit != "avx512")
    throw InputError({.problem = "not an instruction set", .key = "CALOMEL_ISA", .value = '"' + limit + '"', .range = "baseline, avx2, avx512"});
  InstructionSet best = InstructionSet::baseline;
  for (const auto isa : instruction_sets()) {
    best = isa;
    if (limit == name_of(isa)) break;
  }
  return best;
}

}  // namespace calomel
