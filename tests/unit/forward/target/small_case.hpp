#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "forward/target/forward_case.hpp"

namespace calomel::testing {

/// A plane-strain box of 660 elements, 40 us, two gauges.
inline std::string small_case_text(const std::string& more = "", const std::string& load = "peak_pressure = 25e6") {
  return R"([case]
name = "small box"
[geometry]
kind = "box"
length = 0.06
width = 0.05
height = 0.03
wall = 0.003
plane_strain = true
element_size = 0.003
[material.mercury]
least_mesh_viscosity = 0.02
[load]
)" + load +
         R"(
[load.profile]
center = [0.0, 0.015]
widths = [0.1, 0.01]
[time]
end = 40e-6
output_interval = 1e-6
[[sensor]]
name = "T"
position = [0.02, 0.0, 0.03]
direction = [1, 0, 0]
[[sensor]]
name = "F"
position = [0.0, 0.0, 0.015]
direction = [0, 0, 1]
)" + more;
}

/// The greatest difference of two histories over the greatest value of the second.
inline double greatest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double difference = 0, scale = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference = std::max(difference, std::abs(a[i] - b[i])), scale = std::max(scale, std::abs(b[i]));
  return difference / scale;
}

inline ForwardCase small_case(const std::string& more = "", const std::string& load = "peak_pressure = 25e6") {
  CaseFile file = CaseFile::from_text(small_case_text(more, load));
  return ForwardCase::read(file);
}

/// A box that next to nothing fills: its walls ring as dry ones do. `top`: thickness of the top wall [m].
inline ForwardCase ringing_box(double top, const std::string& more = "") {
  CaseFile file = CaseFile::from_text(R"([geometry]
kind = "box"
length = 0.06
width = 0.05
height = 0.03
walls = { front = 0.004, rear = 0.004, side = 0.004, bottom = 0.004, top = )" +
                                      number_text(top) + R"( }
rear = "wall"
plane_strain = true
element_size = 0.002
wall_elements = 2
[material.mercury]
law = "linear"
density = 5.0
sound_speed = 300.0
regularising_viscosity = 0.0
least_mesh_viscosity = 0.0
[load]
peak_pressure = 1e3
profile = { center = [0.0, 0.015], widths = [0.1, 0.1] }
[time]
end = 1.5e-3
output_interval = 5e-6
[[sensor]]
name = "T"
position = [0.03, 0.0, 0.03]
direction = [1, 0, 0]
)" + more);
  return ForwardCase::read(file);
}

}  // namespace calomel::testing
