#pragma once
/// Tables of a case file that several kinds of model have.
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>

#include "base/options.hpp"

namespace calomel {

/// `[case]`.
struct CaseName {
  std::string name, sensor_unit = "strain";
  template <class V>
  void visit(V& v) {
    v("name", name, {.doc = "title of the case; default: the name of its file"});
    v("sensor_unit", sensor_unit, {.doc = "unit of the readings, gain times strain; with another than strain, gains are in it per strain"});
  }
};

/// `[time]`.
struct TimeOptions {
  double end = 1e-3;
  double output_interval = 1e-6;
  template <class V>
  void visit(V& v) {
    v("end", end, {.unit = "s", .range = above(0), .doc = "end of the record, a multiple of output_interval"});
    v("output_interval", output_interval, {.unit = "s", .range = above(0), .doc = "time between output samples"});
  }
  /// Errors: InputError when the interval does not divide the end.
  void validate() const;
  [[nodiscard]] std::size_t samples() const { return std::size_t(std::llround(end / output_interval)) + 1; }
};

/// `[fields]` of a case file.
struct FieldOptions {
  std::optional<double> interval;
  template <class V>
  void visit(V& v) {
    v("interval", interval, {.unit = "s", .range = above(0), .doc = "time between pictures in fields.exo (default: end / 50)"});
  }
};

}  // namespace calomel
