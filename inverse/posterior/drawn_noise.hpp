#pragma once
/// What is not known of the emulator's numerical noise itself: draws of its hyperparameters by a Bayesian bootstrap of the runs' residuals.
#include <cstdint>
#include <vector>

#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

/// One draw of the hyperparameters, and the posterior that they give.
struct DrawnNoise {
  LogPosterior posterior;
  std::vector<double> noise_ratio;  ///< (levels) s_l^2 / s_0^2
  double scale = 1;                 ///< trace of the noise's covariance over that of its estimate
};

/// Draws of the numerical noise's covariance and of the ratio of the meshes' noises, each with the posterior on the emulator that follows from them:
///
///   a = nu Dirichlet(1 - h_1, ..., 1 - h_n),  Sigma = 1/nu sum_i a_i e_i e_i' / (1 - h_i),
///
/// e_i the residual of run i over its level's noise, h_i its leverage, nu = sum (1 - h_i) = runs less coefficients (Rubin 1981, Ann. Stat. 9, 130, whose
/// weights are Dirichlet(1, ..., 1)). A run counts for what the fit leaves of its square: the mean of the draws is the estimate, and a variance has the
/// relative variance 2 / (nu + 1) of a Gaussian's with nu squares, also where coefficients are nearly as many as runs. Each draw smooths variance and
/// correlation as the estimate does (numerical_noise), and fits the coefficients again with its own ratio. What the coefficients are not known by, given the
/// hyperparameters, is in the density already (v Sigma), so that the weights do not enter the least squares.
///
/// Draw b comes from the stream (seed, b) alone. Empty where the runs carry no noise. fit: of `in`.
[[nodiscard]] std::vector<DrawnNoise> draw_noise(const PosteriorInputs& in, const PosteriorFit& fit, int draws, std::uint64_t seed, int threads);

/// The weights a alone, (runs): nu Dirichlet(left), nu = sum left. left: (runs), above 0.
[[nodiscard]] Eigen::VectorXd bootstrap_weights(const Eigen::VectorXd& left, std::uint64_t seed, std::uint64_t draw);

}  // namespace calomel
