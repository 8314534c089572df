#pragma once
/// A measured history on evenly spaced times, read from a text file: what drives a bar.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/options.hpp"

namespace calomel {

/// `[drive]`: the record at the first gauge of a bar.
struct DriveOptions {
  std::string file;
  int column = 2;
  std::optional<double> sample_interval;
  double baseline = 0;
  double scale = 1;
  template <class V>
  void visit(V& v) {
    v("file", file, {.doc = "text file with columns of numbers, the first of them time [s]; lines of words before the numbers are a header", .required = true});
    v("column", column, {.range = between(2, 1000), .doc = "column of the record at the first gauge, counted from 1"});
    v("sample_interval", sample_interval,
      {.unit = "s", .range = above(0), .doc = "time between samples, for a file whose times are rounded; default: from its first column"});
    v("baseline", baseline, {.unit = "s", .range = at_least(0), .doc = "length of the quiet beginning whose mean is taken off; 0 = none"});
    v("scale", scale, {.doc = "factor on the record"});
  }
};

/// Samples value[i] at begin + i interval [s].
struct Signal {
  double begin = 0;
  double interval = 0;
  std::vector<double> value;  ///< (samples)
  [[nodiscard]] double end() const { return begin + interval * double(value.size() - 1); }
};

/// One column of a text file (commas, semicolons or blanks between columns, `#` comments). A time may be off its even place by a tenth of the interval, unless
/// the interval is given: then the times are not read but for the first. Errors: InputError with file and line.
Signal read_signal(const std::filesystem::path& path, int column, std::optional<double> sample_interval, const std::string& key);

/// The record that drives a bar: its column, less the mean of its quiet beginning, times the scale. Errors: as read_signal; no sample within the baseline.
Signal read_drive(const std::filesystem::path& path, const DriveOptions& options);

}  // namespace calomel
