#pragma once
/// Tables of the diagnosis, from diagnosis.json. They are empty without it.
#include <optional>
#include <string>

#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/table.hpp"

namespace calomel {

/// By gauge: the mismatch in units of the errors, its q-value, and the misfits of the fits with this gauge and without it.
Table mismatch_table(const Study& study);
/// The misfit of each condition by the fit to the other conditions.
Table condition_table(const Study& study);
/// Mismatch and q-value of each gauge in each window of time, and of all gauges in it.
Table mismatch_map_table(const Study& study);
/// Mismatch and q-value of each gauge in each band of frequencies, and of all gauges in it.
Table band_table(const Study& study);
/// The probability of each explanation, its share of the mismatch, its effect on gauges that were left out of the fit, and its size.
Table explanation_table(const Study& study);
/// The reason why each explanation is named or not, and what would change that.
Table reason_table(const Study& study);
/// The terms that would act like the missing physics, when the verdict is unknown.
Table missing_table(const Study& study);
/// Every parameter of the explanations that were fitted.
Table effect_table(const Study& study);
/// The case's own parameters by the handbook, before and after, with their distances from the handbook in its standard deviations.
Table handbook_table(const Study& study, const ReportInput& input);

/// diagnosis.json; null without a diagnosis.
const Json& diagnosis_summary(const Study& study);
/// The part of diagnosis.json on gauges, windows of time and bands of frequency.
const Json& diagnosis_location(const Study& study);
/// The root mean square mismatch of a part in units of the errors.
std::optional<double> mismatch(const Json& part);
/// Whether a part with this q-value shows more than chance: below 0.05.
bool significant(const std::optional<double>& q);
/// The unit of frequencies beside times in the unit `time`.
DisplayUnit frequency_unit(const DisplayUnit& time);
/// The title of an entry of the ranking: a mechanism by its plain name, with its own in brackets; "none" and "unknown" in words.
std::string explanation_title(const Json& entry);
/// Whether the verdict names this explanation.
bool in_verdict(const Study& study, const std::string& name);

}  // namespace calomel
