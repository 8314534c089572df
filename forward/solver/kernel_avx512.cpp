#define CALOMEL_ISA isa_avx512
#define CALOMEL_ISA_NAME "avx512"
#include "forward/solver/kernel_impl.hpp"
