#pragma once
/// Rows and curves of the verification as files: text fields in quotes, numbers to nine digits.
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace calomel::testing {

/// One checked number. Reference, measured, tolerance and control_value have its unit ("" = dimensionless).
struct Row {
  std::string item;      ///< one of `items()`
  std::string quantity;  ///< unique within the item
  std::string unit;
  double reference = 0;
  std::string source;  ///< source of the reference
  double measured = 0;
  double tolerance = 0;                                             ///< allowed |measured - reference|
  double order = std::numeric_limits<double>::quiet_NaN();          ///< observed under refinement; NaN: none
  std::string control;                                              ///< the change that makes the control
  double control_value = std::numeric_limits<double>::quiet_NaN();  ///< result of the control
};

/// A curve of a picture.
struct Curve {
  std::string picture, name;
  std::vector<double> x, y;
};

/// Items in the order of the table: those of physics.md section 4.
const std::vector<std::string>& items();

std::string to_line(const Row& row);
/// Errors: InputError when the line is not a row.
Row row_from_line(const std::string& line);

/// All rows and curves below a folder that tests have written; rows by item, then by test and place in it.
struct Record {
  std::vector<Row> rows;
  std::vector<Curve> curves;
  std::vector<std::string> absent;  ///< tests that could not run, with the reason
};
Record read_record(const std::filesystem::path& folder);

}  // namespace calomel::testing
