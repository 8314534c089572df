#pragma once
/// Output of other programs.
#include <cstdio>
#include <string>
#include <utility>

namespace calomel::testing {

/// Output of a command, both streams, and whether its exit status was 0.
inline std::pair<std::string, bool> output_of(const std::string& command) {
  std::string text;
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (!pipe) return {"", false};
  char part[4096];
  for (std::size_t n; (n = std::fread(part, 1, sizeof part, pipe)) > 0;) text.append(part, n);
  return {text, ::pclose(pipe) == 0};
}

/// A Python with xarray and netCDF4; the system's Python where the first one on PATH lacks them; empty where there is none.
inline std::string python_with_xarray() {
  for (const std::string name : {"python3", "/usr/bin/python3"})
    if (output_of(name + " -c 'import xarray, netCDF4'").second) return name;
  return "";
}
inline constexpr const char* no_xarray = "no python3 with xarray and netCDF4 is here: packages.txt lists python3-xarray and python3-netcdf4";

}  // namespace calomel::testing
