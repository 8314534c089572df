#pragma once
/// Chains of a posterior and its prior, as the report shows them.
#include "apps/report/report.hpp"
#include "apps/report/study.hpp"
#include "apps/report/table.hpp"

namespace calomel {

/// Quantities that the drawings of a posterior show: at most six, those of the case's parameters first; indices into the draws' names. Ones with a draw that is
/// not finite are left out.
std::vector<std::size_t> shown_quantities(const Draws& draws, const ReportInput& input);

/// {quantities: [{label, r_hat, ess, trace: (chain, point), ranks: (chain, bin)}], iterations: (point), chains, of: number of chains, bins, expected: draws of
/// a chain in a bin,
///  spread: [two standard deviations of that by quantity]}.
/// A trace is thinned evenly; ranks are those among the draws of all chains, counted by chain in 20 bins of equal width (Vehtari et al. 2021, Bayesian Analysis
/// 16, 667, section 5): chains that have the same distribution have the same count in each but for chance, whose two standard deviations, 2 sqrt(n/20 19/20
/// tau) with tau draws for one that is independent, are `spread`. At most sixteen chains. Null without draws.
Json chains_json(const Study& study, const ReportInput& input);

/// Median and half width (half of what 68 % lie between) of every quantity before and after the records; how many times narrower it has become, and how far it
/// has moved in half widths of the prior, where that is more than bounds.
Table prior_table(const Study& study, const ReportInput& input);

/// Densities before and after: {panels: [{label, span, prior: {span, density}, posterior: {span, density}}]}; null without the prior's draws.
Json priors_json(const Study& study, const ReportInput& input);

/// Where draws break off: at an end of what they cover, more than a fifth of the draws that the fullest tenth of a standard deviation has stand in the
/// outermost one. A bound, or the end of the emulator's box, cuts the density there.
struct BrokenOff {
  std::string name;
  double at = 0;
};
std::vector<BrokenOff> broken_off(const Draws& draws);

/// Whether the prior of a quantity says more than its bounds.
bool informed(const std::string& name, const Study& study, const ReportInput& input);

}  // namespace calomel
