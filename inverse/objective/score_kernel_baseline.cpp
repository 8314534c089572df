#define CALOMEL_ISA isa_baseline
#include "inverse/objective/score_kernel_impl.hpp"
