#pragma once
/// Inner loops are compiled for several instruction sets; which one runs is decided by the processor.
#include <vector>

namespace calomel {

enum class InstructionSet { baseline, avx2, avx512 };

/// The widest that this processor has; the environment variable CALOMEL_ISA (baseline, avx2, avx512) is an upper limit.
/// Errors: InputError for another word there.
InstructionSet instruction_set();
/// Those that this processor has, narrowest first.
std::vector<InstructionSet> instruction_sets();
const char* name_of(InstructionSet isa);

}  // namespace calomel
