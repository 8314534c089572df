#pragma once
/// A small slice of a box, as a case file of the program.
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "tests/scratch.hpp"

namespace calomel::testing {

inline const std::string slice_case = R"(# a small slice
[case]
name = "slice"
[geometry]
kind = "box"
length = 0.06
width = 0.05
height = 0.04
wall = 0.004
rear = "non_reflecting"
plane_strain = true
element_size = 0.002
[material.steel]
density = 7960.0
young = 193e9
poisson = 0.29
[material.mercury]
law = "riemer"
density = 13500.0
sound_speed = 1450.0
tensile_cutoff = 1.5e5
[load]
policy = "fixed"
peak_pressure = 25e6
pulse_length = 0.7e-6
profile = { center = [0.0, 0.02], widths = [0.1, 0.02], decay = 0.13 }
[time]
end = 2e-5
output_interval = 1e-6
[[sensor]]
name = "A"
position = [0.02, 0.0, 0.04]
direction = [1, 0, 0]
)";

/// An empty folder with these files, by name.
inline std::filesystem::path folder_with(const std::string& name, const std::map<std::string, std::string>& files) {
  const auto dir = scratch(name);
  for (const auto& [file, text] : files) std::ofstream(dir / file, std::ios::binary) << text;
  return dir;
}

}  // namespace calomel::testing
