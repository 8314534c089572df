#define CALOMEL_ISA isa_avx512
#include "inverse/objective/score_kernel_impl.hpp"
