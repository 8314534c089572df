#pragma once
/// Designs of experiments: where in the box of parameters a campaign runs the model.
#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "base/registry.hpp"

namespace calomel {

/// One way to fill the unit cube, and the measure that its points follow.
struct Design {
  std::string measure;  ///< name of the measure, for the archive
  /// Points in the unit cube, shape (dimensions, runs), a function of its arguments alone.
  /// Errors: InputError when the design cannot fill so many dimensions.
  Eigen::MatrixXd (*points)(std::size_t dimensions, std::size_t runs, std::uint64_t seed);
  /// Density of the measure relative to uniform at a point of the unit cube.
  double (*density)(const Eigen::VectorXd& unit);
};

/// sobol, latin_hypercube, chebyshev.
const Registry<Design>& designs();

inline constexpr std::size_t sobol_dimensions = 40;  ///< that Sobol' points reach

/// Sobol' points (Sobol' 1967; GSL's generator with the origin put back in front) under a random digital shift by
/// `seed` (L'Ecuyer and Lemieux 2002, section 3.3): of the first 2^m points one lies in each of the 2^m equal intervals of
/// every coordinate. Errors: InputError beyond sobol_dimensions.
Eigen::MatrixXd sobol_points(std::size_t dimensions, std::size_t runs, std::uint64_t seed);
/// Latin hypercube (McKay, Beckman and Conover 1979): every coordinate has one point in each of `runs` equal intervals.
Eigen::MatrixXd latin_hypercube_points(std::size_t dimensions, std::size_t runs, std::uint64_t seed);
/// sobol_points as far as there are such, a Latin hypercube of more dimensions.
Eigen::MatrixXd space_filling_points(std::size_t dimensions, std::size_t runs, std::uint64_t seed);

/// sobol_points u carried to the Chebyshev (arcsine) measure, x = (1 - cos(pi u)) / 2: dense at the faces, where
/// polynomial surrogates need their points.
Eigen::MatrixXd chebyshev_points(std::size_t dimensions, std::size_t runs, std::uint64_t seed);

}  // namespace calomel
