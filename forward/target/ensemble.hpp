#pragma once
/// The mean over pulse energies that predicts a mean record.
#include <span>
#include <vector>

#include "forward/model.hpp"

namespace calomel {

/// How a record's mean is imitated: the mean of `pulses` runs whose relative energies are the quantiles (i + 1/2)/m of a
/// normal with the measured pulse-to-pulse scatter. One pulse: a single run at energy 1. Another `quantile_shift` than 1/2
/// gives an equally good set of energies, for the repeatability floor.
struct EnsembleOptions {
  int pulses = 8;
  double energy_sd = 0.015;
  double quantile_shift = 0.5;
};
std::vector<double> pulse_energies(const EnsembleOptions& options);

/// Mean, energy gradient (regression) and scatter about it of single pulses, (pulse, condition, sensor, time), at out.energies, into `out`. Pulses of one
/// energy determine no slope, and two pulses no scatter: these are left empty, because zeros would mean that energy has no effect.
void mean_over_energies(std::span<const double> pulses, Prediction& out);

}  // namespace calomel
