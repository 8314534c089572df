#pragma once
/// Time histories for the page (thinned, as compact JSON) and for CSV (whole).
#include <span>

#include "apps/report/report.hpp"
#include "apps/report/study.hpp"

namespace calomel {

/// `x` rounded to `digits` significant digits, so that its shortest text has no more; null when not finite.
Json rounded(double x, int digits);

/// Values of (times, values) at `at` by linear interpolation; NaN outside the times. Times rise.
std::vector<double> interpolated(std::span<const double> times, std::span<const double> values, std::span<const double> at);

/// How `n` samples become at most `most`: windows of equal count, each of which keeps its least and its greatest value in
/// the order in which they come, so that no peak is lost.
class Thinning {
 public:
  Thinning(std::size_t n, std::size_t most);
  [[nodiscard]] std::vector<double> times(std::span<const double> t) const;
  [[nodiscard]] std::vector<double> extremes(std::span<const double> values) const;
  [[nodiscard]] bool active() const { return width_ > 1; }

 private:
  std::size_t n_, width_ = 1;
};

/// The plots' data: {unit, thinned, time: [us], series: [{key, label}], conditions: [{name, sensors: [{name, KEY: [...],
/// low: [...], high: [...]}]}]}; series are "measured", "nominal" and the methods. Null when there are no histories.
/// `most`: samples a trace at most.
Json histories_json(const Study& study, const ReportInput& input, std::size_t most);

/// The same of diagnosis.nc; series are "measured", "base", "explained" and each of the latter as it predicts gauges that were left out, "held_out_base" and
/// "held_out_explained"; a series that is `hidden` is switched off at first. `scores`: a line by gauge.
Json diagnosis_histories_json(const Study& study, const ReportInput& input, std::size_t most);

/// What the posterior predicts of every record; series are "predicted", with `predicted_low` and `predicted_high` where errors are told, "draws" with
/// `draws_low` and `draws_high`, and "measured". `scores`: by gauge how much of the record lies within what is predicted.
Json predictive_histories_json(const Study& study, const ReportInput& input, std::size_t most);

/// Every history at every one of its own times: condition, sensor, time_s, measured_mean, band_low, band_high, nominal,
/// METHOD... in the display unit; a column that has no sample at a time is empty there. Empty text when there are none.
std::string histories_csv(const Study& study, const ReportInput& input);
/// The same of diagnosis.nc.
std::string diagnosis_histories_csv(const Study& study, const ReportInput& input);
/// The same of posterior.nc.
std::string predictive_histories_csv(const Study& study, const ReportInput& input);

}  // namespace calomel
