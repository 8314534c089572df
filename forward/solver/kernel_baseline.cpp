#define CALOMEL_ISA isa_baseline
#define CALOMEL_ISA_NAME "baseline"
#include "forward/solver/kernel_impl.hpp"
