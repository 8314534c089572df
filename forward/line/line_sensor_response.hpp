#pragma once
/// What a station's channel makes of its history: y = g L2[L1[x]] with a lag of first order L1, tau dy/dt + y = x, a Butterworth low pass of second order L2,
/// and a gain g; for all stations, or of one in its own table. Before the record the first value is used. Off: tau = 0, no low pass, g = 1.
#include "forward/line/line_mechanism.hpp"

namespace calomel {

/// Default prior ranges, which follow the time scale of the line.
struct LineSensorRanges {
  double lag_low, lag_high;    ///< [s]
  double pass_low, pass_high;  ///< [Hz]
};
LineMechanismEntry line_sensor_response(const LineSensorRanges& ranges);

/// y from tau dy/dt + y = x, exact for x linear between samples, from y = x at the first.
void first_order_lag(double tau, double interval, std::span<double> y);

}  // namespace calomel
