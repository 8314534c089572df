#pragma once
/// Analytic archives for training: damped oscillations, and records that mimic strain gauges on a vessel of mercury, whose
/// arrival times move with the sound speed.
#include <cmath>
#include <numbers>

#include "base/random.hpp"
#include "forward/campaign/archive.hpp"

namespace calomel {

inline Parameter bounded(const std::string& name, double low, double high) {
  Parameter p;
  p.name = name;
  p.key = "material.mercury." + name;
  p.min = low;
  p.max = high;
  p.nominal = 0.5 * (low + high);
  return p;
}

/// Points of an additive recurrence with the generalised golden ratio (Roberts 2018), shifted by the seed.
inline Eigen::MatrixXd spread_points(const std::vector<Parameter>& parameters, std::size_t runs, std::uint64_t seed) {
  RandomStream random(seed, 0);
  Eigen::MatrixXd theta(Eigen::Index(parameters.size()), Eigen::Index(runs));
  const double g = 1.2207440846057596;  // root of x^4 = x + 1, for three parameters
  for (Eigen::Index j = 0; j < theta.rows(); ++j) {
    const double shift = random.uniform(), step = std::pow(1 / g, double(j + 1));
    for (Eigen::Index r = 0; r < theta.cols(); ++r) {
      const double u = std::fmod(shift + step * double(r + 1), 1.0);
      const auto& p = parameters[std::size_t(j)];
      theta(j, r) = p.min + (p.max - p.min) * u;
    }
  }
  return theta;
}

template <class F>
Archive archive_of(std::vector<Parameter> parameters, std::size_t sensors, std::size_t times, double end, std::size_t runs, std::uint64_t seed, F&& value) {
  Archive a;
  a.shape.parameters = std::move(parameters);
  a.shape.conditions = {"default"};
  for (std::size_t s = 0; s < sensors; ++s) a.shape.sensors.push_back(std::string(1, char('A' + s)));
  for (std::size_t t = 0; t < times; ++t) a.shape.times.push_back(end * double(t) / double(times - 1));
  a.design = "sobol";
  a.theta = spread_points(a.shape.parameters, runs, seed);
  a.status.assign(runs, RunStatus::done);
  a.message.assign(runs, "");
  a.mean.resize(Eigen::Index(a.shape.values()), Eigen::Index(runs));
  for (std::size_t r = 0; r < runs; ++r)
    for (std::size_t s = 0; s < sensors; ++s)
      for (std::size_t t = 0; t < times; ++t)
        a.mean(Eigen::Index(a.shape.at(0, s, t)), Eigen::Index(r)) = float(value(a.theta.col(Eigen::Index(r)), s, a.shape.times[t]));
  return a;
}

/// f_s(t) = a exp(-d t) sin(2 pi nu t + s / 2): nu in [1, 2] cycles, d in [0.5, 3], a in [0.5, 1.5] over t in [0, 1].
inline Archive damped_oscillations(std::size_t runs, std::size_t sensors, std::size_t times, std::uint64_t seed) {
  return archive_of({bounded("frequency", 1, 2), bounded("damping", 0.5, 3), bounded("amplitude", 0.5, 1.5)}, sensors, times, 1.0, runs, seed,
                    [](const auto& theta, std::size_t s, double t) {
                      return theta[2] * std::exp(-theta[1] * t) * std::sin(2 * std::numbers::pi * theta[0] * t + 0.5 * double(s));
                    });
}

/// Strain [-] of a gauge over 1 ms. It has a steel precursor, mercury waves of travel times d / c with their echoes (amplitude
/// by the impedances rho c against the wall's, fronts 1.5 cm wide, tension clipped smoothly at the cutoff), and a wall that rings with the
/// mercury's added mass from each arrival on. theta = (tensile_cutoff, density, sound_speed).
inline double mimic_strain(const Eigen::VectorXd& theta, std::size_t sensor, double t) {
  const double sigma = theta[0], rho = theta[1], c = theta[2], x = 0.03 + 0.02 * double(sensor % 12);
  const double impedance = rho * c, steel = 4.0e7, reflect = (steel - impedance) / (steel + impedance);
  const double pressure = 25e6, modulus = 200e9 * 0.04;
  const auto smooth_step = [](double z) { return 0.5 * (1 + std::tanh(z)); };
  const double ring = 2 * std::numbers::pi * 22e3 / std::sqrt(1 + rho / 9000.0) * (1 + 0.05 * double(sensor % 5));
  double strain = 1.2e-5 * std::exp(-t / 2e-4) * std::sin(2 * std::numbers::pi * 3.1e4 * t) * smooth_step((t - x / 5200) / 2e-6);
  const double travel[4] = {x, 0.10 - 0.2 * x, 0.19 + 0.5 * x, 0.42 - x};
  double amplitude = 1;
  for (const double distance : travel) {
    const double after = t - distance / c;
    double p = amplitude * pressure * std::exp(-std::max(after, 0.0) / 1.2e-4) * smooth_step(after * c / 0.015);
    if (p < 0) p = -sigma - (pressure * 0.05) * (1 - std::exp((p + sigma) / (pressure * 0.05))) * (p < -sigma ? 1 : 0) + (p > -sigma ? sigma + p : 0);
    const double wall = after > 0 ? 1 - std::cos(ring * after) * std::exp(-after / 2.5e-4) : 0;
    strain += p / modulus * wall;
    amplitude *= -0.75 * reflect;
  }
  return strain;
}

/// Records of `mimic_strain` over the seed paper's cutoff and density ranges and c between the given bounds [m/s].
inline Archive mimic_records(std::size_t runs, std::size_t sensors, std::size_t times, double density_low, double c_low, double c_high, std::uint64_t seed) {
  return archive_of({bounded("tensile_cutoff", 0, 1.5e6), bounded("density", density_low, 13600), bounded("sound_speed", c_low, c_high)}, sensors, times, 1e-3,
                    runs, seed, [](const Eigen::VectorXd& theta, std::size_t s, double t) { return mimic_strain(theta, s, t); });
}

}  // namespace calomel
