#pragma once
/// `[posterior]`: what `calomel sample` does with the emulator that it has fitted.
#include <string>
#include <vector>

#include "base/options.hpp"
#include "inverse/posterior/compared_errors.hpp"

namespace calomel {

struct PosteriorOptions {
  int hyperparameter_draws = 6;
  int refinements = 3;
  std::vector<std::string> compare;

  template <class V>
  void visit(V& v) {
    v("hyperparameter_draws", hyperparameter_draws,
      {.range = between(0, 100),
       .doc = "draws of the numerical noise's covariance and of the meshes' noise ratio, over which the likelihood is averaged; 0 or 1: their estimate alone"});
    v("refinements", refinements,
      {.range = between(0, 20),
       .doc = "greatest number of refinements: the emulator is trained on further runs and fitted again if runs of the true model at the posterior's draws "
              "contradict it"});
    v("compare", compare,
      {.doc = "further posteriors on the same emulator and runs under other error models (theory/posterior.md); they show the influence of the assumed errors",
       .choices = compared_forms()});
  }
};

}  // namespace calomel
