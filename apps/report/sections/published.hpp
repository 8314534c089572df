#pragma once
/// The published values of mercury's parameters, for cases that infer the same three.
#include <string>
#include <vector>

#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/html.hpp"

namespace calomel {

/// A published calibration.
struct PublishedAnswer {
  std::string label;  ///< "ENC, published"
  Json theta;         ///< {NAME of the case's parameter: value}
};

/// The best calibrated parameters of Radaideh et al. 2022, arXiv:2202.09353. Empty unless the case infers density, sound speed and tensile cutoff of
/// `[material.mercury]`, no more and no fewer, and has the density of mercury.
std::vector<PublishedAnswer> published_answers(const ReportInput& input);

/// The published values, their source, their distances from this posterior in its standard deviations, and rho c. Empty without published values or draws.
Html published_paragraph(const Study& study, const ReportInput& input);

}  // namespace calomel
