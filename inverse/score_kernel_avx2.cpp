#define CALOMEL_ISA isa_avx2
#include "inverse/score_kernel_impl.hpp"
