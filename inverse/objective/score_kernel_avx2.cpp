#define CALOMEL_ISA isa_avx2
#include "inverse/objective/score_kernel_impl.hpp"
