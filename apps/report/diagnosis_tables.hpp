#pragma once
/// What the report shows of diagnosis.json; all empty where there is none. The sentences themselves are apps/presentation/diagnosis_words'.
#include <string>

#include "apps/report/report.hpp"
#include "apps/report/study.hpp"
#include "apps/report/table.hpp"

namespace calomel {

/// By gauge: mismatch in units of what errors make, q-value, misfits of the fits with it and without it.
Table mismatch_table(const Study& study);
/// Mismatch and q-value of each gauge in each window of time, of all gauges in it, and of each gauge over the whole record.
Table mismatch_map_table(const Study& study);
/// Mismatch and q-value by band of frequencies.
Table band_table(const Study& study);
/// Probability of each explanation, what it accounts for, what it does for gauges that were left out, its size.
Table explanation_table(const Study& study);
/// Why each is named or is not, and what would change that.
Table reason_table(const Study& study);
/// The terms that would do what is missing, where the verdict is unknown.
Table missing_table(const Study& study);
/// Every number of the explanations that were fitted.
Table effect_table(const Study& study);
/// The case's own parameters by the handbook, before and after, with their distances from the handbook in its deviations.
Table handbook_table(const Study& study, const ReportInput& input);

/// The two sentences of the verdict, for the top of the page. HTML.
std::string verdict_html(const Study& study);
/// The section. HTML.
std::string diagnosis_section(const Study& study, const ReportInput& input);
/// What its scripts draw, without the histories: {gauges: [{name, mismatch, significant}], map: {...}, bands: [...], bars: [...]}. Null where there is none.
Json diagnosis_drawings(const Study& study);

}  // namespace calomel
