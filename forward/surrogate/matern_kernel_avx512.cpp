#define CALOMEL_ISA isa_avx512
#include "forward/surrogate/matern_kernel_impl.hpp"
