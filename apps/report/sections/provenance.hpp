#pragma once
/// The section "Provenance".
#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/table.hpp"

namespace calomel {

/// Version, seed, identity and hashes of the inputs of every artefact.
Table provenance_table(const Study& study);

/// The body of the section.
Html provenance_section(const Study& study, const ReportInput& input);

}  // namespace calomel
