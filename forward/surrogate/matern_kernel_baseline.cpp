#define CALOMEL_ISA isa_baseline
#include "forward/surrogate/matern_kernel_impl.hpp"
