#include "forward/mechanism/left_states.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace calomel {

namespace {

constexpr double picture_interval = 4e-6;  ///< about [s]
constexpr double least_span = 2e-3;        ///< [s]
constexpr double records_spanned = 3;

/// Symmetric taps, sum 1, of a low pass that leaves all below `highest` and nothing above 3 `highest` [Hz]: a sinc of 2 `highest` under Blackman's window,
/// whose transition is 5.5 / length wide.
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

void add(std::vector<Vec3>& to, double weight, const std::vector<Vec3>& field) {
  to.resize(field.size(), Vec3{});
  for (std::size_t i = 0; i < field.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) to[i][c] += weight * field[i][c];
}

}  // namespace

LeftStates::LeftStates(double record, double output_interval, double highest)
    : interval_(output_interval > picture_interval ? output_interval / std::ceil(output_interval / picture_interval)
                                                   : output_interval * std::round(picture_interval / output_interval)),
      taps_(low_pass_taps(highest, interval_)),
      sums_(count) {
  const double half = double(taps_.size() / 2) * interval_, first = record + half, span = std::max(least_span, records_spanned * record);
  for (std::size_t k = 1; k <= count; ++k) {
    const double turns = double(k) * std::numbers::phi;
    times_.push_back(interval_ * std::round((first + span * (turns - std::floor(turns))) / interval_));
    end_ = std::max(end_, times_.back() + half);
  }
}

void LeftStates::take(const FieldSnapshot& picture) {
  const auto half = std::llround(double(taps_.size() / 2));
  for (std::size_t k = 0; k < count; ++k) {
    const auto from = std::llround((picture.time - times_[k]) / interval_);
    if (std::abs(from) > half || std::abs(picture.time - times_[k] - double(from) * interval_) > 0.01 * interval_) continue;
    const double tap = taps_[std::size_t(from + half)];
    add(sums_[k].displacement, tap, picture.displacement), add(sums_[k].velocity, tap, picture.velocity);
  }
}

std::vector<LeftState> LeftStates::states() const {
  std::vector<LeftState> all = sums_;
  LeftState mean;
  for (const auto& s : sums_) add(mean.displacement, 1.0 / count, s.displacement), add(mean.velocity, 1.0 / count, s.velocity);
  for (auto& s : all) add(s.displacement, -1, mean.displacement), add(s.velocity, -1, mean.velocity);
  return all;
}

LeftState together(const std::vector<LeftState>& states, const std::vector<double>& shares) {
  LeftState sum;
  for (std::size_t k = 0; k < shares.size(); ++k)
    if (shares[k] != 0) add(sum.displacement, shares[k], states[k].displacement), add(sum.velocity, shares[k], states[k].velocity);
  return sum;
}

}  // namespace calomel
