#define CALOMEL_ISA isa_baseline
#include "inverse/score_kernel_impl.hpp"
