#define CALOMEL_ISA isa_avx2
#define CALOMEL_ISA_NAME "avx2"
#include "forward/solver/kernel_impl.hpp"
