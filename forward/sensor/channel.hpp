#pragma once
/// What a recording channel does to a history on equidistant times that is 0 before its start.
#include <span>

namespace calomel {

/// y(t) <- y(t - delay) [s]: cubic Hermite through the samples; the last value is held.
void shift(double delay, double interval, std::span<double> y);

/// Second-order Butterworth low pass with -3 dB at `cutoff` [Hz], exact for a history that is linear between samples:
/// y'' + sqrt(2) w y' + w^2 y = w^2 x, w = 2 pi cutoff, from rest.
void low_pass(double cutoff, double interval, std::span<double> y);

}  // namespace calomel
