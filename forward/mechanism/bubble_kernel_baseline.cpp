#define CALOMEL_ISA isa_baseline
#include "forward/mechanism/bubble_kernel_impl.hpp"
