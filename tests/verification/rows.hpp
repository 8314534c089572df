#pragma once
/// The record of the verification: every test leaves the numbers it checked, one file a test, from which the table and the
/// pictures of docs/verification are made (table_main.cpp).
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/verification/row_file.hpp"

namespace calomel::testing {

/// Records a row, and fails unless |measured - reference| <= tolerance and the control lies outside the tolerance.
/// Without a control in the row, another check of the same test is one: then `control` says in words which.
void verify(const Row& row);

/// Records a curve of a picture. `x`, `y`: (points).
void draw(const std::string& picture, const std::string& curve, const std::vector<double>& x, const std::vector<double>& y);

/// Records errors against the element size [m], for the picture of convergence; returns the order between the last two.
double observed_order(const std::string& what, const std::vector<double>& h, const std::vector<double>& error);

/// Records that this test could not run, so that its rows are not missed.
void rows_absent(const std::string& why);

}  // namespace calomel::testing
