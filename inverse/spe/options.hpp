#pragma once
/// Options of sparse polynomial expansion calibration, table `[spe]`.
#include <string>
#include <vector>

#include "base/options.hpp"
#include "inverse/calibration/correction_report.hpp"
#include "inverse/objective/objective.hpp"
#include "inverse/optimizer/dgs.hpp"

namespace calomel {

/// What is published (seed paper, section "Sparse Polynomial Expansion Results") and where the defaults differ from it: docs/theory/spe.md.
struct SpeOptions {
  std::string objective = "paper_spe";
  std::string transform = "none";
  std::vector<int> total_degree{10, 11, 12, 13, 14, 15, 16, 17, 18};
  std::vector<int> tensor_product{5, 6, 7, 8, 9, 10, 11};
  std::vector<int> hyperbolic_cross{};
  std::vector<int> sparse_grid{};
  std::vector<int> adaptive{};
  int most_terms = 10000;
  std::string lambda_scale = "cross_validation";
  std::vector<double> lambdas{0.25, 0.5, 1, 2, 4};
  bool penalise_constant = false;
  double validation_fraction = 0.2;
  bool refit = true;
  int trials = 50;
  int iterations = 100;
  DgsOptions dgs;
  double bandwidth = 0.05;
  int candidates = 8;
  int refinements = 2;
  double separation = 0.03;
  int known_candidates = 2;
  int zoom = 4;
  int zoom_runs = 25;
  bool mesh_correction = true;

  template <class V>
  void visit(V& v) {
    v("objective", objective, {.doc = "the misfit that the polynomials approximate", .choices = objectives().names()});
    v("transform", transform, {.doc = "none: of the misfit itself, as published; log: of its logarithm", .choices = {"none", "log"}});
    v("total_degree", total_degree, {.range = between(1, 40), .doc = "orders of the total-degree spaces"});
    v("tensor_product", tensor_product, {.range = between(1, 40), .doc = "orders of the tensor-product spaces"});
    v("hyperbolic_cross", hyperbolic_cross, {.range = between(1, 1000), .doc = "orders of the hyperbolic-cross spaces, for many parameters"});
    v("sparse_grid", sparse_grid,
      {.range = between(1, 12), .doc = "levels of the spaces of Smolyak's construction: high degrees in one parameter at a time, low ones in products"});
    v("adaptive", adaptive,
      {.range = between(1, 100),
       .doc = "rounds of adaptive spaces, which grow where the fit puts its weight and keep the set with the least cross-validated error"});
    v("most_terms", most_terms, {.range = between(10, 1e5), .doc = "spaces with more terms than this are left out with a warning"});
    v("lambda_scale", lambda_scale,
      {.doc = "what spe.lambdas are multiples of: 1 (absolute, as published), the least value at which every coefficient vanishes, or the best value of each "
              "space",
       .choices = {"absolute", "lambda_max", "validation", "cross_validation"}});
    v("lambdas", lambdas,
      {.range = above(0),
       .doc = "weights of the l1 norm in |A z - d|^2 + lambda |z|_1, one surrogate each; published 100, 500, 1000, 1500, 2000",
       .least_size = 1});
    v("penalise_constant", penalise_constant, {.doc = "whether the constant term pays the penalty, as published"});
    v("validation_fraction", validation_fraction, {.range = between(0.05, 0.5), .doc = "share of the runs that is held out"});
    v.renamed("folds", "there are always five folds of the training runs");
    v("refit", refit, {.doc = "fit again to all runs, held-out ones included, before the search (errors are those of the first fit)"});
    v("trials", trials, {.range = between(1, 10000), .doc = "searches of each surrogate from random starts"});
    v("iterations", iterations, {.range = between(1, 100000), .doc = "of a search"});
    v.table("dgs", dgs, "directional Gaussian smoothing");
    v.renamed("merge", "ends of searches within 2 % of the bounds are always one optimum of a surrogate");
    v("bandwidth", bandwidth,
      {.range = {.low = 0, .high = 1, .low_open = true}, .doc = "sd of the Gaussian that smooths the pooled optima, in units of the bounds"});
    v("candidates", candidates, {.range = between(1, 50), .doc = "modes, or optima where modes run out, that are re-run in the true model"});
    v("refinements", refinements,
      {.range = between(0, 20), .doc = "times that the candidates' true misfits join the runs and everything is fitted and searched again; 0 as published"});
    v("separation", separation,
      {.range = between(0, 0.5), .doc = "least distance of two candidates, the largest over the parameters in units of their bounds"});
    v("known_candidates", known_candidates,
      {.range = between(0, 20), .doc = "best runs of the campaign that are candidates too, which costs no run; 0 as published"});
    v("zoom", zoom,
      {.range = between(0, 10),
       .doc = "rounds in which the box shrinks to half of each side about the best run that is known, and the surrogates are fitted to the runs inside; 0 as "
              "published"});
    v("zoom_runs", zoom_runs, {.range = between(10, 1000), .doc = "new runs of the true model in the box of each of these rounds"});
    visit_mesh_correction(v, mesh_correction);
  }
  /// Errors: InputError when no space is listed.
  void validate() const;
};

}  // namespace calomel
