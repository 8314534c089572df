#pragma once
/// What the report says of numbers of the whole run, dissipated energy and time at the cutoff, where sensitivity.json has them.
#include <string>
#include <vector>

#include "apps/report/study.hpp"

namespace calomel {

/// Whether a quantity of sensitivity.json is a number of the whole run.
bool is_run_total(const std::string& quantity);

/// Their names, in the order of the report.
const std::vector<std::string>& run_total_names();

/// "dissipated energy"
std::string plain_run_total(const std::string& quantity);

/// For each: how great it is and varies, what its shares are those of, what is said where it has none; then its table of total indices. Empty without any.
/// HTML.
std::string run_totals_part(const Study& study);

}  // namespace calomel
