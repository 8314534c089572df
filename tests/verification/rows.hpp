#pragma once
/// The record of the verification: every test writes the numbers it checked to a file of its own. table_main.cpp makes the table and the
/// pictures of docs/verification from these files.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/verification/row_file.hpp"

namespace calomel::testing {

/// Records a row, and fails unless |measured - reference| <= tolerance and the control lies outside the tolerance.
/// Without a control value, another check of the same test is the control, and `control` names it in words.
void verify(const Row& row);

/// Records a curve of a picture. `x`, `y`: (points).
void draw(const std::string& picture, const std::string& curve, const std::vector<double>& x, const std::vector<double>& y);

/// Order of convergence between the last two meshes. `h`: element sizes, to any scale; `error`: (h).
double observed_order(const std::vector<double>& h, const std::vector<double>& error);

/// The same, which also puts the errors into the picture of convergence.
double drawn_order(const std::string& what, const std::vector<double>& h, const std::vector<double>& error);

/// Records why this test could not run, so that its rows are not reported as missing.
void rows_absent(const std::string& why);

}  // namespace calomel::testing
