#pragma once
/// The part on quantities of the whole run, dissipated energy and time at the cutoff, where sensitivity.json has them.
#include "apps/report/data/study.hpp"
#include "apps/report/parts/html.hpp"

namespace calomel {

/// For each quantity: its mean and standard deviation, the source of its shares or the reason why it has none, and its table of total indices. Empty without
/// such quantities.
Html run_totals_part(const Study& study);

}  // namespace calomel
