#pragma once
/// The small slice for tests of the program; they change its lines with `with`.
#include <filesystem>
#include <fstream>

#include "base/netcdf_file.hpp"
#include "tests/regression/program.hpp"
#include "tests/slice_case.hpp"

namespace calomel::testing {

/// Makes the histories of dir/truth/simulate.nc the records of dir/case.toml: one pulse of each gauge, with a stated noise of 2e-6 that is not added.
inline void put_records(const std::filesystem::path& dir) {
  const NetcdfReader file(dir / "truth" / "simulate.nc");
  const auto time = file.doubles("time"), strain = file.doubles("strain");
  const auto sensors = file.strings("sensor");
  std::ofstream csv(dir / "records.csv");
  csv.precision(9);
  csv << "sensor,pulse,time,strain\n";
  for (std::size_t s = 0; s < sensors.size(); ++s)
    for (std::size_t t = 0; t < time.size(); ++t) csv << sensors[s] << ",1," << time[t] << ',' << strain[s * time.size() + t] << '\n';
  std::ofstream(dir / "case.toml", std::ios::app) << "[recordings]\nfile = \"records.csv\"\nnoise = 2e-6\n";
}

}  // namespace calomel::testing
