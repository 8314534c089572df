#pragma once
/// The report of the artefacts in --out: report.html, with --csv its tables.
#include "base/errors.hpp"

namespace calomel {

struct StageCall;

/// Errors: InputError where there is nothing to report; see write_report.
ExitStatus report_stage(StageCall& call);

}  // namespace calomel
