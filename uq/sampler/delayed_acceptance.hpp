#pragma once
/// Sampling of an expensive density by means of a cheap one: Christen and Fox 2005, J. Comput. Graph. Stat. 14, 795.
#include <Eigen/Core>
#include <memory>

#include "base/options.hpp"
#include "uq/sampler/dram.hpp"
#include "uq/sampler/markov_chain.hpp"

namespace calomel {

/// `[sampler.delayed_acceptance]`.
struct DelayedAcceptanceOptions {
  int first_stage = 50;
  int settle = 20;

  template <class V>
  void visit(V& v) {
    v("first_stage", first_stage, {.range = at_least(1), .doc = "transitions of DRAM on the emulator between two runs of the true model"});
    v("settle", settle, {.range = at_least(0), .doc = "last transitions of the warm-up that already use the true model; earlier ones use the emulator alone"});
  }
};

/// Makes a chain of two stages. A transition runs frozen DRAM for `first_stage` transitions on the cheap density p*, from x to y, and accepts y with
///   a = min(1, p(y) p*(x) / (p(x) p*(y))),
/// with one evaluation of p, or none where y = x. DRAM is reversible for p*, hence the chain is reversible for p, whatever p* is; the quality of p* decides the
/// acceptance alone. In the warm-up DRAM adapts on p* and p is not evaluated, except in the last `settle` transitions, which carry the chain from p* to p. The
/// chain begins where p* is positive. warmup: transitions that adapt. Errors: those of dram_chain(); NumericsError where either density is NaN, naming the
/// place.
std::unique_ptr<MarkovChain> delayed_acceptance_chain(const LogDensity& cheap, const LogDensity& exact, const DelayedAcceptanceOptions& options,
                                                      const DramOptions& dram, const Eigen::MatrixXd& covariance, int warmup);

/// The entry of the catalogue.
SamplerEntry delayed_acceptance_sampler();

}  // namespace calomel
