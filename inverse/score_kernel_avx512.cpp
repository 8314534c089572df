#define CALOMEL_ISA isa_avx512
#include "inverse/score_kernel_impl.hpp"
