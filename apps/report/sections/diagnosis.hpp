#pragma once
/// The section of the diagnosis, and its verdict for the first screen.
#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/html.hpp"

namespace calomel {

/// The two sentences of the verdict, for the top of the page; empty without a diagnosis. The sentences come from diagnosis.json.
Html verdict_html(const Study& study);

/// The body of the section; empty without a diagnosis.
Html diagnosis_section(const Study& study, const ReportInput& input);

/// The data of its plots, without the histories: {gauges: [{name, mismatch, significant}], rows, times: {axis, columns, cells}, bands: {axis, columns, cells},
/// bars: [{label, probability, strong}]}. Null without a diagnosis.
Json diagnosis_drawings(const Study& study);

}  // namespace calomel
