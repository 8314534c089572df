#include "tests/verification/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iostream>

namespace calomel::testing {
namespace {

/// Appends a line to the file of this test, which the first line of a run truncates.
void append(const std::string& line) {
  static std::string begun;
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  const std::string name = fmt::format("{}.{}", test->test_suite_name(), test->name());
  const std::filesystem::path folder = CALOMEL_VERIFICATION_ROWS;
  std::filesystem::create_directories(folder);
  std::ofstream out(folder / (name + ".csv"), begun == name ? std::ios::app : std::ios::trunc);
  out << line << '\n';
  begun = name;
}

}  // namespace

void verify(const Row& row) {
  std::cout << fmt::format("[ measured ] {}, {}: {:.6g} {} (reference {:.6g}, off by {:.3g} of {:.3g}{})\n", row.item, row.quantity, row.measured, row.unit,
                           row.reference, row.measured - row.reference, row.tolerance, std::isnan(row.order) ? "" : fmt::format(", order {:.2f}", row.order));
  if (!std::isnan(row.control_value)) std::cout << fmt::format("[ control  ] {}: {:.6g}\n", row.control, row.control_value);
  append("row:" + to_line(row));
  EXPECT_NE(std::find(items().begin(), items().end(), row.item), items().end()) << row.item << " is not among the items of row_file.cpp";
  EXPECT_LE(std::abs(row.measured - row.reference), row.tolerance) << row.item << ", " << row.quantity;
  EXPECT_FALSE(row.control.empty()) << "a row names its control";
  if (!std::isnan(row.control_value)) EXPECT_GT(std::abs(row.control_value - row.reference), row.tolerance) << "control: " << row.control;
}

void draw(const std::string& picture, const std::string& curve, const std::vector<double>& x, const std::vector<double>& y) {
  std::string line = fmt::format("curve:\"{}\",\"{}\"", picture, curve);
  for (std::size_t i = 0; i < x.size(); ++i) line += fmt::format(",{:.6g},{:.6g}", x[i], y[i]);
  append(line);
}

double observed_order(const std::vector<double>& h, const std::vector<double>& error) {
  const std::size_t n = h.size();
  return std::log(std::abs(error[n - 2] / error[n - 1])) / std::log(h[n - 2] / h[n - 1]);
}

double drawn_order(const std::string& what, const std::vector<double>& h, const std::vector<double>& error) {
  std::vector<double> x, y;
  for (std::size_t i = 0; i < h.size(); ++i) x.push_back(h[i] / h[0]), y.push_back(std::abs(error[i]));
  draw("convergence", what, x, y);
  return observed_order(h, error);
}

void rows_absent(const std::string& why) { append("absent:" + why); }

}  // namespace calomel::testing
