#pragma once
/// What data pin and what they leave free: principal directions of the curvature in the logarithms of the parameters.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "forward/parameter.hpp"
#include "forward/simulation/inference_hints.hpp"

namespace calomel {

/// A direction of the Hessian in the logarithms of the positive parameters.
struct Direction {
  Eigen::VectorXd exponents;  ///< unit vector over the positive parameters
  double value = 0;           ///< of the product of powers
  double sd = 0;              ///< of its logarithm, posterior
  double data_sd = 0;         ///< by the data alone; infinity where they say nothing
  double prior_sd = 0;        ///< before the data
  bool pinned = false;        ///< the data determine it: data_sd is far below prior_sd
  std::string product;        ///< its name, "density^0.71 sound_speed^0.70"
};

/// A product of powers and its 95 % interval.
struct Combination {
  std::string name;
  double value = 0, low = 0, high = 0;
  double relative_sd = 0;  ///< of the logarithm
};

struct Identification {
  std::vector<std::size_t> parameters;    ///< the positive ones among the keys of interest, or all positive ones where fewer than two of these are
  std::vector<Direction> directions;      ///< best determined first; empty where no parameter is positive
  std::vector<Combination> combinations;  ///< the named products whose parameters are all there
};

/// data: curvature of -log likelihood by the parameters, the posterior's precision less the prior's, (n, n) in their own units; covariance: of the posterior,
/// the same units; prior_sd: (n). keys: of the parameters of interest; products: that are reported beside the directions.
Identification identify(const std::vector<Parameter>& parameters, const std::vector<double>& theta, const Eigen::MatrixXd& data,
                        const Eigen::MatrixXd& covariance, const Eigen::VectorXd& prior_sd, const std::vector<std::string>& keys,
                        const std::vector<PowerProduct>& products);

}  // namespace calomel
