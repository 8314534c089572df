#include "forward/line/bar_wave.hpp"

#include <gsl/gsl_fft_halfcomplex.h>
#include <gsl/gsl_fft_real.h>
#include <gsl/gsl_spline.h>

#include <bit>
#include <cmath>
#include <memory>
#include <numbers>

namespace calomel {

BarWave::BarWave(const Signal& drive, double longest) {
  const std::size_t n = drive.value.size(), gap = std::size_t(std::ceil(std::max(0.0, longest) / drive.interval)) + 1;
  const std::size_t size = std::bit_ceil(2 * n + 2 * gap);  // record, descent, and room for the delay before it would come round
  spectrum_.assign(size, 0.0);
  std::copy(drive.value.begin(), drive.value.end(), spectrum_.begin());
  for (std::size_t i = 0; i < n; ++i) spectrum_[n + i] = drive.value.back() * 0.5 * (1 + std::cos(std::numbers::pi * double(i + 1) / double(n)));
  gsl_fft_real_radix2_transform(spectrum_.data(), 1, size);
  omega_.resize(size / 2);
  for (std::size_t i = 0; i < omega_.size(); ++i) omega_[i] = 2 * std::numbers::pi * double(i + 1) / (double(size) * drive.interval);
}

std::vector<double> BarWave::at(double distance, std::span<const std::complex<double>> wavenumber, double delay) const {
  const std::size_t n = spectrum_.size();
  std::vector<double> u = spectrum_;
  for (std::size_t i = 1; i <= n / 2; ++i) {
    const double real = wavenumber[i - 1].real() * distance + omega_[i - 1] * delay, decay = std::exp(wavenumber[i - 1].imag() * distance);
    const double c = decay * std::cos(real), s = -decay * std::sin(real);
    if (i == n / 2) {
      u[i] *= c;
    } else {
      const double a = u[i], b = u[n - i];
      u[i] = a * c - b * s;
      u[n - i] = a * s + b * c;
    }
  }
  gsl_fft_halfcomplex_radix2_inverse(u.data(), 1, n);
  return u;
}

std::vector<double> resampled(double begin, double interval, std::span<const double> samples, std::span<const double> time) {
  std::vector<double> out(time.size());
  bool aligned = true;
  for (const double t : time) {
    const double i = (t - begin) / interval;
    expect(i < double(samples.size()) - 0.5, "a time lies within the samples");
    aligned = aligned && std::abs(i - std::round(i)) < 1e-6;
  }
  std::unique_ptr<gsl_spline, decltype(&gsl_spline_free)> spline(nullptr, gsl_spline_free);
  if (!aligned) {
    std::vector<double> x(samples.size());
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = double(i);
    spline.reset(gsl_spline_alloc(gsl_interp_cspline, x.size()));
    gsl_spline_init(spline.get(), x.data(), samples.data(), x.size());
  }
  for (std::size_t k = 0; k < time.size(); ++k) {
    const double i = (time[k] - begin) / interval;
    if (i < -1e-6) continue;
    out[k] = aligned ? samples[std::size_t(std::llround(i))] : gsl_spline_eval(spline.get(), std::clamp(i, 0.0, double(samples.size() - 1)), nullptr);
  }
  return out;
}

}  // namespace calomel
