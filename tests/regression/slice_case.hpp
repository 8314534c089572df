#pragma once
/// The small slice for tests of the program; they change its lines with `with`.
#include "tests/regression/program.hpp"
#include "tests/slice_case.hpp"
