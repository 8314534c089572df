#pragma once
/// The power of an experiment before it is made: which omitted mechanisms a diagnosis of its records would name, and from which strength on.
#include <optional>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "uq/diagnosis/screening.hpp"
#include "uq/diagnosis/verdict.hpp"

namespace calomel {

/// `[power]`: the experiment that is planned.
struct PowerOptions {
  int pulses = 20;
  double noise = 3e-6;
  double noise_time = 5e-6;
  double energy_sd = 0.015;
  int gauges = 6;
  std::vector<double> energies{0.5, 2};

  template <class V>
  void visit(V& v) {
    v("pulses", pulses, {.range = between(2, 100000), .doc = "recorded pulses of each gauge"});
    v("noise", noise, {.range = above(0), .doc = "sd of a gauge's noise in one pulse, in the sensors' unit"});
    v("noise_time", noise_time, {.unit = "s", .range = at_least(0), .doc = "its correlation time"});
    v("energy_sd", energy_sd, {.range = between(0, 0.5), .doc = "relative sd of the energy from pulse to pulse"});
    v("gauges", gauges,
      {.range = between(0, 100), .doc = "further gauges that are tried, one at a time, distributed over the outer surface away from the case's own"});
    v("energies", energies,
      {.range = above(0), .doc = "further beam powers that are tried, one at a time, as multiples of the case's own, where it has one condition"});
  }
};

/// An experiment, as a part of all observations that were planned.
struct Plan {
  std::string name;
  std::vector<std::size_t> observations;  ///< indices into the problem's
};

/// The strength from which on one number of one mechanism would be named.
struct Detectable {
  std::string mechanism;
  std::string place;           ///< wall or gauge that it is about, or empty
  bool of_gauge = false;       ///< the place is a gauge
  std::string number;          ///< name of the parameter
  double off = 0;              ///< the case's number where the mechanism is off; infinite where it is then none
  std::optional<double> from;  ///< the value nearest to off, on the side that is screened, at which it would be named; none within its range
  double farthest = 0;         ///< end of its range on that side
  double share = 2;            ///< share of its range that is needed; 2 where the whole range is not enough
  std::string limited_by;      ///< label of the candidate that competes just below that strength; empty: the evidence itself is not enough
};

struct PlanPower {
  Plan plan;
  std::vector<Detectable> numbers;
  double gain = 0;  ///< over the first plan: mean over its numbers of log(share needed there / here)
};

/// For each plan and each number alone, the least strength at which records with it, and expected noise, would pass the gates of evidence and of lead, to first
/// order about the fit: log B of its own candidate at least `log_bayes_factor`, and `lead` above every other group's. `fit`: to planned records in which
/// nothing is missing, of all observations of all plans; `screened`: candidates about it.
[[nodiscard]] std::vector<PlanPower> power(const PosteriorFit& fit, const Problem& problem, const std::vector<ParameterGroup>& groups,
                                           const std::vector<ScreenedCandidate>& screened, const std::vector<Plan>& plans, const Gates& gates = {});

}  // namespace calomel
