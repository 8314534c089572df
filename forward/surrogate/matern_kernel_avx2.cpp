#define CALOMEL_ISA isa_avx2
#include "forward/surrogate/matern_kernel_impl.hpp"
