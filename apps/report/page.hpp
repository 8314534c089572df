#pragma once
/// The words of the page and the data of its drawings.
#include "apps/report/report.hpp"
#include "apps/report/study.hpp"

namespace calomel {

/// First screen: the case, what was run, what came out in plain words, and the warnings. HTML.
std::string header_html(const Study& study, const ReportInput& input);
/// All sections after it. HTML.
std::string sections_html(const Study& study, const ReportInput& input);
/// What the scripts draw: {target, histories, convergence, ridge, loss, decay, design, corner, predictive, priors, chains, sensitivity}; parts that are not
/// there are null. At most `samples` a trace, `quads` a surface and `points` a scatter plot.
Json page_data(const Study& study, const ReportInput& input, std::size_t samples, std::size_t quads, std::size_t points);

}  // namespace calomel
