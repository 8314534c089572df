#pragma once
/// Sampling a density that is dear by means of a cheap one: Christen and Fox 2005, J. Comput. Graph. Stat. 14, 795.
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
    v("settle", settle, {.range = at_least(0), .doc = "last transitions of the warm-up that ask the true model already; those before ask the emulator alone"});
  }
};

/// A transition lets DRAM go `first_stage` transitions from x on the cheap density p*, frozen, to y, and accepts y with
///   a = min(1, p(y) p*(x) / (p(x) p*(y))),
/// one evaluation of p, none where y = x. DRAM is reversible for p*, so that the chain is for p, whatever p* is; how well p* stands in for p decides the
/// acceptance alone. In the warm-up DRAM learns on p* alone and p is not asked, but for the last `settle` transitions, which carry the chain from p* to p. It
/// begins where p* is positive. warmup: transitions that learn. Errors: those of dram_chain(); NumericsError where either density is NaN, naming the place.
std::unique_ptr<MarkovChain> delayed_acceptance_chain(const LogDensity& cheap, const LogDensity& exact, const DelayedAcceptanceOptions& options,
                                                      const DramOptions& dram, const Eigen::MatrixXd& covariance, int warmup);

/// The entry of the catalogue.
SamplerEntry delayed_acceptance_sampler();

}  // namespace calomel
