#define CALOMEL_ISA isa_avx512
#include "forward/mechanism/bubble_kernel_impl.hpp"
