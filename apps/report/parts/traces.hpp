#pragma once
/// Time histories for the page (thinned, as compact JSON) and for CSV (whole).
#include <cstddef>
#include <string>

#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"

namespace calomel {

/// The plots' data: {unit, time_unit, thinned, samples, time, series: [{key, label, hidden}], conditions: [{name, sensors: [{name, KEY: [...], low: [...],
/// high: [...]}]}]}. Series are "measured", "nominal" and the methods. Null when there are no histories. A trace has at most `most` samples.
Json histories_json(const Study& study, const ReportInput& input, std::size_t most);

/// The same of diagnosis.nc. Series are "measured", "base" and "explained", and the predictions "held_out_base" and "held_out_explained" of gauges that were
/// left out of the fit. A series with `hidden` is switched off at first. `scores` has a line by gauge.
Json diagnosis_histories_json(const Study& study, const ReportInput& input, std::size_t most);

/// The posterior predictions of every record. Series are "predicted" with `predicted_low` and `predicted_high` where posterior.nc has errors, "draws" with
/// `draws_low` and `draws_high`, and "measured". `scores` has the share of each gauge's record that lies within the predicted band.
Json predictive_histories_json(const Study& study, const ReportInput& input, std::size_t most);

/// Every history at every one of its own times: condition, sensor, time_s, measured_mean, band_low, band_high, nominal, METHOD... in the display unit. A column
/// that has no sample at a time is empty there. Empty when there are no histories.
std::string histories_csv(const Study& study, const ReportInput& input);
/// The same of diagnosis.nc.
std::string diagnosis_histories_csv(const Study& study, const ReportInput& input);
/// The same of posterior.nc.
std::string predictive_histories_csv(const Study& study, const ReportInput& input);

}  // namespace calomel
