#define CALOMEL_ISA isa_avx2
#include "forward/mechanism/bubble_kernel_impl.hpp"
