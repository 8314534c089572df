#pragma once
/// The starts of chains and walkers.
#include <Eigen/Core>
#include <functional>
#include <string>

#include "base/frame_file.hpp"
#include "base/random.hpp"
#include "uq/log_density.hpp"

namespace calomel {

/// ln p(x), minus infinity outside the support. Errors: NumericsError, naming the place, where it is NaN or plus infinity.
double checked_log_density(const LogDensity& density, const Eigen::VectorXd& x);
/// The place in words, as "x1 = 1, x2 = -3".
std::string place_text(const LogDensity& density, const Eigen::VectorXd& x);

/// A mode that is known beforehand.
struct StartMode {
  Eigen::VectorXd mean;        ///< (d)
  Eigen::MatrixXd covariance;  ///< (d, d)
  double weight = 1;           ///< share of the jumps that lead there; the weights of all modes sum to 1
};

/// A point where the density is positive, with its log density.
struct Beginning {
  Eigen::VectorXd x;
  double log_density = 0;
};
/// Draws x = mean + w L z with z ~ N(0, 1), again while the density is zero there; w is `width` at first and 0.95 times as large after each refusal.
/// factor: L, (d, d). Errors: NumericsError after 200 refusals, naming `whose` ("chain 2").
Beginning drawn_beginning(const std::function<double(const Eigen::VectorXd&)>& log_density, const Eigen::VectorXd& mean, const Eigen::MatrixXd& factor,
                          double width, RandomStream& random, const std::string& whose);

/// The lower Cholesky factor. Errors: InputError when the covariance is not positive definite.
Eigen::MatrixXd covariance_factor(const Eigen::MatrixXd& covariance, std::size_t dimension);

/// Writes a matrix or vector into a saved chain, and reads one of the same size back. Errors: ContractFailure for another size.
void save_matrix(ByteWriter& out, const Eigen::Ref<const Eigen::MatrixXd>& m);
void restore_matrix(ByteReader& in, Eigen::Ref<Eigen::MatrixXd> m);

}  // namespace calomel
