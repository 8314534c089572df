#pragma once
/// An experiment on a box slice, from a SPEC file: target, true numbers, concealed effects, gauges, pulses and noise. The keys: docs/proof/generator.md.
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/proof/slice.hpp"

namespace calomel::proof {

/// One concealed effect: numbers and words by key, as in an [[effect]] table.
struct Effect {
  std::string name;
  std::map<std::string, double> number;
  std::map<std::string, std::string> word;
  [[nodiscard]] double operator[](const std::string& key) const;  ///< throws where it is absent
  /// `times` as strong: every number that sets the strength moves from its off value in proportion (lengths, fractions) or in its logarithm (ratios).
  [[nodiscard]] Effect scaled(double times) const;
};

/// What the library calls it, or "" where it has no such mechanism.
[[nodiscard]] std::string library_name(const std::string& effect);

struct GaugeSpec {
  std::string name;
  double x = 0, z = 0, length = 0.002, noise = 0;
  bool along_x = true;
  double moved = 0, gain = 1;  ///< drawn, or given
};

struct Experiment {
  std::string name;
  std::uint64_t seed = 1;
  double grid = 0.25e-3;
  double length = 0, height = 0, front = 0, top = 0, bottom = 0, rear = 0;  ///< rear > 0: a wall
  double steel_density = 7960, young = 193e9, poisson = 0.29;
  double density = 13500, sound_speed = 1450, cutoff = 1.5e5, viscosity = 2000, collapse = 0.75;
  double wall_strength_ratio = 1;  ///< tension at which a wetted face parts, in cutoffs
  double nominal_young = 193e9, nominal_density = 13500, nominal_sound_speed = 1450, nominal_cutoff = 1.5e5;
  double peak = 25e6, center = 0, width = 0.02, decay = 0.13, buildup = 1.5, buildup_length = 0.02, exponent = 2;
  double pulse_length = 0.7e-6, nominal_pulse_length = 0.7e-6;
  double end = 0.25e-3, interval = 1e-6;
  int pulses = 20;
  double energy = 1, energy_sd = 0.015;  ///< of all pulses; from pulse to pulse
  double place_sd = 0, gain_sd = 0, noise_time = 5e-6;
  std::vector<double> energies;  ///< relative energy of each pulse; drawn where none is given
  std::vector<GaugeSpec> gauges;
  std::vector<Effect> effects;
  double target_strength = 0;                     ///< relative L2 that the effects are to make; 0: as given
  double least_scale = 0.02, greatest_scale = 4;  ///< of the search for it
  double search_grid = 0.5e-3;
  int search_pulses = 8;

  static Experiment read(const std::filesystem::path& path);
  void draw();  ///< energies, places and gains, by the seed
  [[nodiscard]] Slice slice(const std::vector<Effect>& concealed, double h) const;
  /// (pulse, gauge, time): noise-free strains as the channels read them.
  [[nodiscard]] std::vector<double> strains(const std::vector<Effect>& concealed, double h, const std::vector<double>& at, int threads) const;
  [[nodiscard]] std::size_t samples() const;
  [[nodiscard]] std::string case_file() const;
};

/// Mean over the pulses, (gauge, time).
[[nodiscard]] std::vector<double> mean_of(const std::vector<double>& strains, std::size_t pulses);

/// Difference of two mean records: relative L2 by gauge of all samples, and after a Hann window to 20 kHz, as the posterior compares.
struct Difference {
  std::vector<double> raw, band;
};
[[nodiscard]] Difference difference(const std::vector<double>& mean, const std::vector<double>& reference, std::size_t gauges, double interval);
/// Mean over the gauges; of effects on one gauge only, that gauge's.
[[nodiscard]] double strength(const std::vector<double>& by_gauge, const Experiment& experiment);

}  // namespace calomel::proof
