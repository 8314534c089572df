#pragma once
/// Densities of draws as curves.
#include <cstddef>
#include <optional>
#include <vector>

namespace calomel {

/// The density of `values` at `points` even places from `low` to `high`. The kernels are Gaussians of width 0.9 min(sd, interquartile range / 1.34) n^(-1/5)
/// (Silverman 1986, equation 3.31) on finely binned values. They are reflected at the bounds `least` and `greatest` where these are given; beyond a bound the
/// density is 0. `values` must hold at least one value, and finite values only.
std::vector<double> density_curve(const std::vector<double>& values, double low, double high, std::optional<double> least, std::optional<double> greatest,
                                  std::size_t points);

}  // namespace calomel
