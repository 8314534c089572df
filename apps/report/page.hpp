#pragma once
/// The sections of the page in their order, and the data of its drawings.
#include <cstddef>

#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/html.hpp"

namespace calomel {

/// All sections after the first screen.
Html sections_html(const Study& study, const ReportInput& input);

/// Limits of the data of the drawings.
struct DrawingLimits {
  std::size_t samples = 3000;  ///< a trace
  std::size_t quads = 24000;   ///< a surface
  std::size_t points = 2000;   ///< a scatter plot
};

/// The data of the drawings: {target, histories, diagnosis, diagnosis_histories, convergence, ridge, loss, decay, design, corner, predictive, priors, chains,
/// sensitivity}. A part whose artefact is missing is null.
Json page_data(const Study& study, const ReportInput& input, const DrawingLimits& limits);

}  // namespace calomel
