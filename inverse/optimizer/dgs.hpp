#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "inverse/optimizer/optimizer.hpp"

namespace calomel {

/// Adaptive directional Gaussian smoothing, `[spe.dgs]`.
struct DgsOptions {
  int quadrature = 3;
  int line_search = 20;
  double radius = 0.25;
  double longest_step = 1.0;
  double shortest_step = 1e-4;
  double tolerance = 1e-3;
  int reset_after = 10;
  std::string basis = "random";

  template <class V>
  void visit(V& v) {
    v("quadrature", quadrature,
      {.range = between(2, 15), .doc = "M, Gauss-Hermite points a direction; the middle one of an odd M has no weight and costs nothing"});
    v("line_search", line_search, {.range = between(2, 200), .doc = "steps that an iteration's line search tries"});
    v("radius", radius,
      {.range = {.low = 0, .high = 2, .low_open = true}, .doc = "sigma_0, smoothing radius at the start and after a reset, in units of the scaled box"});
    v("longest_step", longest_step, {.range = {.low = 0, .high = 4, .low_open = true}, .doc = "first step of the line search, in units of the scaled box"});
    v("shortest_step", shortest_step, {.range = {.low = 0, .high = 1, .low_open = true}, .doc = "its last step; those between fall by one factor"});
    v("tolerance", tolerance, {.range = between(0, 1), .doc = "gamma: relative change of the value below which an iteration has stalled"});
    v("reset_after", reset_after, {.range = at_least(1), .doc = "least number of iterations between two resets of the radius"});
    v("basis", basis, {.doc = "directions of an iteration: the coordinates (as published) or a random rotation of them", .choices = {"random", "coordinates"}});
  }
  /// Errors: InputError when the steps do not descend.
  void validate() const;
};

struct DgsTrial {
  Eigen::VectorXd x;          ///< best point, in the unit box
  double f = 0;               ///< its value
  std::vector<double> trace;  ///< (iterations + 1) best value
};

/// Evaluations of one iteration of one trial in d dimensions.
std::size_t dgs_evaluations(const DgsOptions& options, std::size_t d);

/// Minimises `function` on the unit box, one trial from each start, all trials in step so that a batch holds the points of all.
/// Along each direction xi_k of an orthonormal basis the derivative of the Gaussian-smoothed function is
///   D_k = 1 / (sqrt(pi) sigma) sum_m w_m f(x + sqrt(2) sigma v_m xi_k) sqrt(2) v_m
/// with the Gauss-Hermite nodes v_m and weights w_m; points beyond the box are taken where they project onto it. The step goes
/// against g = sum_k D_k xi_k; its length alpha is the best of a ladder from the longest to the shortest step (0 when none lowers
/// the value), and sigma <- (sigma + alpha) / 2. When the value changes by less than `tolerance`, and the last reset is
/// `reset_after` iterations past, sigma is the first radius again. Tran and Zhang 2020, arXiv:2011.02009; seed paper, Algorithm 2.
/// starts: (d, trials). The stream of a trial depends on (seed, its index) alone.
std::vector<DgsTrial> minimise_dgs(const BatchFunction& function, const Eigen::MatrixXd& starts, const DgsOptions& options, int iterations, std::uint64_t seed);

/// The same as a pagmo algorithm of equal cost with the others: generations x population evaluations in all, on as many trials of
/// about 50 iterations as these pay for, from the best of the first population.
struct DirectionalGaussianSmoothing {
  int generations = 100;
  unsigned seed = 1;
  DgsOptions options;
  [[nodiscard]] pagmo::population evolve(pagmo::population population) const;
  void set_seed(unsigned s) { seed = s; }
  [[nodiscard]] std::string get_name() const { return "DGS, adaptive"; }
};

}  // namespace calomel
