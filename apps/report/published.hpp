#pragma once
/// The answers that were published for mercury's parameters, where the case asks for the same three.
#include <string>
#include <vector>

#include "apps/report/report.hpp"
#include "apps/report/study.hpp"

namespace calomel {

struct PublishedAnswer {
  std::string label;  ///< "ENC, published"
  Json theta;         ///< {NAME of the case's parameter: value}
};

/// Radaideh et al. 2022, arXiv:2202.09353, the table of the best calibrated parameters. Empty unless the case's parameters are density, sound speed and tensile
/// cutoff of
/// `[material.mercury]`, and its own density is mercury's.
std::vector<PublishedAnswer> published_answers(const ReportInput& input);

/// Who published them, what they are, and where they lie in this posterior, in its standard deviations and by rho c. HTML; empty without answers or draws.
std::string published_paragraph(const Study& study, const ReportInput& input);

}  // namespace calomel
