#pragma once
/// A netCDF file of histories of the model beside the records that they are held against: what `calibrate` and `diagnose` hand in for plots.
#include <filesystem>
#include <span>
#include <string>

#include "base/netcdf_file.hpp"
#include "base/provenance.hpp"
#include "inverse/data/problem.hpp"

namespace calomel {

/// Dimensions condition, sensor, time (the model's) and record_time [s], with their coordinates; histories in the unit of the records ("1" for strain).
class HistoryFile {
 public:
  HistoryFile(const std::filesystem::path& path, const Problem& problem, const Provenance& provenance);
  void attribute(const std::string& name, const std::string& text) { file_.attribute(name, text); }
  /// values: (condition, sensor, time), or empty: the variable is left out.
  void history(const std::string& name, std::span<const double> values, const std::string& what);
  /// Adds record_mean, band_low and band_high (condition, sensor, record_time), and puts the file in its place.
  void commit();

 private:
  const Problem& problem_;
  NetcdfWriter file_;
  std::string units_;
};

}  // namespace calomel
