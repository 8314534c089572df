#pragma once
/// Samples as rows, before they are put on a common time grid: what every reader gives and what a merge takes.
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "inverse/data/recordings.hpp"

namespace calomel {

/// One sample with its place in a file.
struct RecordRow {
  int condition, sensor, pulse;  ///< the first two are indices into RecordRows, the third is the pulse's number
  int file, line;
  double time, value;  ///< [s]; value in the file's unit, NaN = dropout
};

/// The samples of one or several files.
struct RecordRows {
  std::vector<std::string> files, conditions, sensors;
  std::vector<int> sensor_lines;  ///< line of each sensor's first row; 0 when it is a column
  std::vector<RecordRow> rows;
  bool wide = false;         ///< a column a sensor: the file does not number the pulse
  std::string unit;          ///< unit in the file; empty if it has none
  std::string value_column;  ///< header of the value column in long form
  std::vector<std::string> warnings;
};

/// Seconds in a unit of time ("s", "ms", "µs", "seconds"), 1 where none is given; empty when it is no time.
std::optional<double> seconds_in(std::string_view unit);

/// What a unit measures, and how much of the plain unit it is.
struct ReadingUnit {
  std::string_view quantity;  ///< "strain", "voltage", "pressure", "time", ...
  double size = 1;            ///< in strain, V, Pa, N, m, m/s, m/s^2, s
};

/// A unit as files spell it: symbol or word, with or without an SI prefix ("kPa", "Volts", "millivolt", "um/m"); empty when it is none that is known here.
std::optional<ReadingUnit> reading_unit(std::string_view word);

/// Reads text: comma, semicolon, tab or blanks between the fields, '#' before a comment.
/// Errors: InputError with file and line.
RecordRows parse_record_text(std::string_view text, const std::string& file);

/// Puts the samples on one evenly spaced grid. Errors: InputError with file and line for a time off the grid and for a
/// sample that is given twice.
Recordings assemble(const RecordRows& rows);

}  // namespace calomel
