#pragma once
/// Small cases of a bar and of a pipe.
#include <cmath>
#include <fstream>
#include <string>

#include "forward/line/line_case.hpp"
#include "tests/scratch.hpp"

namespace calomel::testing {

/// A pulse of 1 - cos, 30 us long from 20 us on, at 1000 samples of 0.5 us; the path of its file.
inline std::string pulse_file() {
  const auto path = scratch_file("pulse.csv");
  std::ofstream out(path);
  out << "time,strain\n";
  for (int i = 0; i < 1000; ++i) {
    const double t = 0.5e-6 * i, x = (t - 20e-6) / 30e-6;
    out << t << ',' << (x > 0 && x < 1 ? 0.5e-3 * (1 - std::cos(2 * M_PI * x)) : 0) << '\n';
  }
  return path.string();
}

inline std::string bar_text(const std::string& more = "", const std::string& line = "radius = 0.01") {
  return R"([model]
kind = "line"
[line]
kind = "bar"
wave_speed = 5000
)" + line +
         R"(
[drive]
file = ")" +
         pulse_file() + R"("
[time]
end = 400e-6
output_interval = 0.5e-6
[[station]]
name = "near"
distance = 0.25
[[station]]
name = "far"
distance = 1.0
gain = 2.0
)" + more;
}

/// Without friction but for what `line` adds.
inline std::string pipe_text(const std::string& more = "", const std::string& line = "viscosity = 0\nfriction_factor = 0") {
  return R"([case]
sensor_unit = "kPa"
[model]
kind = "line"
[line]
kind = "pipe"
length = 40
diameter = 0.02
wave_speed = 1250
density = 1000
velocity = 0.5
reservoir_pressure = 200e3
cells = 32
)" + line +
         R"(
[time]
end = 0.5
output_interval = 0.001
[[station]]
name = "valve"
distance = 40
[[station]]
name = "middle"
distance = 20
)" + more;
}

inline LineCase line_case(const std::string& text) {
  CaseFile file = CaseFile::from_text(text);
  return LineCase::read(file);
}

}  // namespace calomel::testing
