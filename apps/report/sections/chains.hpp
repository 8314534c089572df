#pragma once
/// Chains of a posterior and its prior, for the section "Posterior".
#include <cstddef>
#include <string>
#include <vector>

#include "apps/report/data/report_input.hpp"
#include "apps/report/data/study.hpp"
#include "apps/report/parts/table.hpp"

namespace calomel {

/// The quantities in the drawings of a posterior, as indices into the names of the draws. There are at most six; those of the case's parameters come first.
/// A quantity with a draw that is not finite is left out.
std::vector<std::size_t> shown_quantities(const Draws& draws, const ReportInput& input);

/// The data of the chains' plots: {quantities: [{label, r_hat, ess, trace: (chain, point), ranks: (chain, bin)}], iterations: (point), chains, of: number of
/// chains, bins, expected: draws of a chain in a bin, spread: (quantity), two standard deviations of that number}.
/// Traces are thinned evenly, and at most sixteen chains are drawn. Ranks are those among the draws of all chains, counted by chain in 20 bins of equal width
/// (Vehtari et al. 2021, Bayesian Analysis 16, 667, section 5). Chains with the same distribution have equal counts up to chance. `spread` is
/// 2 sqrt(n/20 19/20 tau), where tau draws count as one independent draw. Null without draws.
Json chains_json(const Study& study, const ReportInput& input);

/// Median and half width (half of the central 68 % interval) of every quantity before and after the records, and the ratio of the half widths. A quantity whose
/// prior is more than bounds also has its move in half widths of the prior.
Table prior_table(const Study& study, const ReportInput& input);

/// The densities before and after the records: {panels: [{label, span, prior: {span, density}, posterior: {span, density}}]}. Null without draws of the prior.
Json priors_json(const Study& study, const ReportInput& input);

/// A quantity whose density is cut at `at`, by a bound or by the end of the emulator's box.
struct BrokenOff {
  std::string name;
  double at = 0;
};
/// The quantities whose density is cut. The criterion: the outermost slice of a tenth of the half width holds more than a fifth of the draws of the fullest
/// one.
std::vector<BrokenOff> broken_off(const Draws& draws);

/// Whether the prior of a quantity is more than bounds.
bool informed(const std::string& name, const Study& study, const ReportInput& input);

}  // namespace calomel
