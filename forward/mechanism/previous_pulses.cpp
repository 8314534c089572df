#include "forward/mechanism/previous_pulses.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/linear_algebra.hpp"

namespace calomel {

namespace {

using Complex = std::complex<double>;
constexpr std::size_t most_modes = 8;

/// Symmetric taps, sum 1, of a low pass that leaves all below `highest` and nothing above 3 `highest` [Hz]: a sinc of 2 `highest` under Blackman's window, whose
/// transition is 5.5 / length wide.
std::vector<double> low_pass_taps(double highest, double interval) {
  const auto half = std::ptrdiff_t(std::ceil(0.5 * 5.5 / (2 * highest * interval)));
  std::vector<double> taps;
  double sum = 0;
  for (std::ptrdiff_t k = -half; k <= half; ++k) {
    const double x = std::numbers::pi * double(k), window = 0.42 + 0.5 * std::cos(x / double(half + 1)) + 0.08 * std::cos(2 * x / double(half + 1));
    const double argument = 4 * highest * interval * x;
    taps.push_back(window * (k == 0 ? 1 : std::sin(argument) / argument));
    sum += taps.back();
  }
  for (auto& t : taps) t /= sum;
  return taps;
}

/// The signals after `begin`, low-passed, at a quarter of the period of `highest` or a little less.
struct Late {
  double interval = 0, first = 0;  ///< between samples, and of the first one [s]
  Eigen::MatrixXd samples;         ///< (time, sensor)
  std::vector<double> taps;        ///< of the low pass, at the ring-down's interval
};

Late late_part(const RingDown& r, double begin, double highest) {
  const std::size_t times = r.strain.size() / r.sensors, every = std::max<std::size_t>(1, std::size_t(1 / (4 * highest * r.interval)));
  Late late{.interval = double(every) * r.interval, .taps = low_pass_taps(highest, r.interval)};
  const std::size_t half = late.taps.size() / 2, first = std::size_t(std::ceil(begin / r.interval - 1e-9)) + half;
  late.first = double(first) * r.interval;
  const std::size_t count = first + half < times ? (times - 1 - half - first) / every + 1 : 0;
  late.samples = Eigen::MatrixXd::Zero(Eigen::Index(count), Eigen::Index(r.sensors));
  for (std::size_t s = 0; s < r.sensors; ++s)
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < late.taps.size(); ++k)
        late.samples(Eigen::Index(i), Eigen::Index(s)) += late.taps[k] * r.strain[s * times + first + i * every + k - half];
  return late;
}

/// z of the signals sum c z^n: eigenvalues of the map that moves the signal space by one sample.
Eigen::VectorXcd poles(const Late& late) {
  constexpr Eigen::Index greatest_window = 60, greatest_order = 32;
  constexpr double least_share = 1e-9;  // of the strongest direction's energy; the rest is rounding
  const Eigen::Index count = late.samples.rows(), window = std::min(greatest_window, count / 2);
  if (window < 3) return {};
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(window, window);
  for (Eigen::Index s = 0; s < late.samples.cols(); ++s)
    for (Eigen::Index k = 0; k + window <= count; ++k) {
      const auto h = late.samples.col(s).segment(k, window);
      covariance += h * h.transpose();
    }
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  const double strongest = eigen.values(window - 1);
  Eigen::Index order = 0;
  while (order < std::min(greatest_order, window / 2) && eigen.values(window - 1 - order) > least_share * strongest) ++order;
  if (order == 0) return {};
  const Eigen::MatrixXd space = eigen.vectors.rightCols(order), early = space.topRows(window - 1), later = space.bottomRows(window - 1);
  return eigenvalues(inverse_symmetric(early.transpose() * early) * (early.transpose() * later));
}

/// Complex amplitudes (pole, sensor) at t = 0 of the signal before the low pass, by least squares; of a complex pair c of x = Re(c z^n), for the one above.
Eigen::MatrixXcd amplitudes(const Late& late, const RingDown& r, const std::vector<Complex>& rates) {
  const auto columns = Eigen::Index(2 * rates.size());
  Eigen::MatrixXd basis(late.samples.rows(), columns);
  for (Eigen::Index n = 0; n < basis.rows(); ++n)
    for (std::size_t j = 0; j < rates.size(); ++j) {
      const Complex e = std::exp(rates[j] * (double(n) * late.interval));
      basis(n, Eigen::Index(2 * j)) = e.real(), basis(n, Eigen::Index(2 * j + 1)) = -e.imag();
    }
  const Eigen::MatrixXd fit = solve_symmetric(basis.transpose() * basis, Eigen::MatrixXd(basis.transpose() * late.samples));
  Eigen::MatrixXcd c(Eigen::Index(rates.size()), late.samples.cols());
  const auto half = std::ptrdiff_t(late.taps.size() / 2);
  for (std::size_t j = 0; j < rates.size(); ++j) {
    Complex response = 0;  // of the low pass to exp(rate t)
    for (std::size_t k = 0; k < late.taps.size(); ++k) response += late.taps[k] * std::exp(rates[j] * (double(std::ptrdiff_t(k) - half) * r.interval));
    for (Eigen::Index s = 0; s < c.cols(); ++s) c(Eigen::Index(j), s) = Complex(fit(Eigen::Index(2 * j), s), fit(Eigen::Index(2 * j + 1), s)) / response * std::exp(-rates[j] * late.first);
  }
  return c;
}

}  // namespace

std::vector<WetMode> wet_modes(const RingDown& r, double begin, std::size_t most, double highest) {
  const Late late = late_part(r, begin, highest);
  const double length = double(late.samples.rows()) * late.interval;
  std::vector<Complex> rates;  // of all that the low pass leaves, decay and frequency; one of each pair
  const Eigen::VectorXcd z = poles(late);
  for (Eigen::Index i = 0; i < z.size(); ++i)
    if (z(i).imag() >= 0 && std::abs(z(i)) > 0.1) rates.push_back(std::log(z(i)) / late.interval);
  if (rates.empty()) return {};
  for (auto& rate : rates) rate = {std::min(rate.real(), 0.0), rate.imag()};  // it may stay or die away
  const Eigen::MatrixXcd c = amplitudes(late, r, rates);
  struct Found {
    double energy;
    WetMode mode;
  };
  std::vector<Found> found;
  for (std::size_t j = 0; j < rates.size(); ++j) {
    const double frequency = rates[j].imag() / (2 * std::numbers::pi), decay = -rates[j].real();
    if (frequency * length < 1 || frequency >= highest || decay > 0.5 * rates[j].imag()) continue;  // less than a period, or no oscillation
    const auto row = Eigen::Index(j);
    Complex squares = 0;
    double energy = 0;
    for (Eigen::Index s = 0; s < c.cols(); ++s) squares += c(row, s) * c(row, s), energy += std::norm(c(row, s));
    const Complex phase = std::exp(Complex(0, -0.5 * std::arg(squares)));  // greatest sum of squares of the real parts
    WetMode mode{.omega = rates[j].imag(), .decay = decay, .shape = {}};
    for (Eigen::Index s = 0; s < c.cols(); ++s) mode.shape.push_back((c(row, s) * phase).real() * std::exp(-decay * begin));
    energy *= std::exp(-2 * decay * begin) * (decay * length > 1e-6 ? (1 - std::exp(-2 * decay * length)) / (2 * decay) : length);
    found.push_back({energy, std::move(mode)});
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.energy > b.energy; });
  found.resize(std::min(found.size(), most));
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.mode.omega < b.mode.omega; });
  std::vector<WetMode> modes;
  for (auto& f : found) modes.push_back(std::move(f.mode));
  return modes;
}

namespace {

std::string key(const char* of, std::size_t mode) { return std::string(of) + '_' + std::to_string(mode + 1); }

void add_ringing(const MechanismValues& v, const RingDown& r, double interval, std::span<double> histories) {
  const std::size_t times = histories.size() / r.sensors;
  const auto modes = wet_modes(r, double(times - 1) * interval, most_modes);
  for (std::size_t j = modes.size(); j < most_modes; ++j)
    for (const char* of : {"cos", "sin"})
      if (v[key(of, j)] != 0)
        throw InputError({.problem = "the model rings in " + std::to_string(modes.size()) + " wet modes below 10 kHz, this is one more",
                          .key = "mechanism.previous_pulses." + key(of, j),
                          .value = number_text(v[key(of, j)]),
                          .suggestion = "leave it at 0"});
  for (std::size_t j = 0; j < modes.size(); ++j) {
    const double a = v[key("cos", j)], b = v[key("sin", j)];
    if (a == 0 && b == 0) continue;
    for (std::size_t i = 0; i < times; ++i) {
      const double t = double(i) * interval, phase = modes[j].omega * t, q = (a * std::cos(phase) + b * std::sin(phase)) * std::exp(-modes[j].decay * t) - a;
      for (std::size_t s = 0; s < r.sensors; ++s) histories[s * times + i] += q * modes[j].shape[s];
    }
  }
}

}  // namespace

MechanismEntry previous_pulses() {
  std::vector<MechanismKey> keys;
  for (std::size_t j = 0; j < most_modes; ++j)
    for (const char* of : {"cos", "sin"})
      keys.push_back({.name = key(of, j), .unit = "", .off = 0, .low = -1, .high = 1,
                      .doc = std::string(*of == 'c' ? "A" : "B") + " of wet mode " + std::to_string(j + 1) + " at the start of the record, in what one pulse leaves when its own ends"});
  return {.law = "s(t) = r(t) - r(0), r = sum_j phi_sj (A_j cos w_j t + B_j sin w_j t) exp(-zeta_j w_j t)",
          .plain = "what earlier pulses left ringing",
          .check = "see how long before each record the last pulse came, and take records of single pulses",
          .keys = std::move(keys), .cost = 3, .superpose = add_ringing};
}

}  // namespace calomel
