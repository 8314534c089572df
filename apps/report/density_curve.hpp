#pragma once
/// Densities of draws as curves.
#include <optional>
#include <vector>

namespace calomel {

/// Density of `values` at `points` even places from `low` to `high`: Gaussian kernels of width 0.9 min(sd, interquartile range / 1.34) n^(-1/5) (Silverman
/// 1986, equation 3.31) on finely binned values, reflected at the bounds `least` and `greatest` where there are any; 0 beyond these. Finite values, at least
/// one.
std::vector<double> density_curve(const std::vector<double>& values, double low, double high, std::optional<double> least, std::optional<double> greatest,
                                  std::size_t points);

}  // namespace calomel
