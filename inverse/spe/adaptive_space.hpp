#pragma once
/// A polynomial space that grows where the fit puts its weight.
#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "inverse/spe/surrogates.hpp"

namespace calomel {

inline const std::string adaptive_kind = "adaptive";

/// Degrees of a downward-closed set, (d, terms) in lexicographic order: from total degree 1 on, in each of at most `rounds` rounds the admissible
/// neighbours (those whose every predecessor is in the set) of the terms with half of the fit's squared weight join; the set with the least
/// cross-validated error of the training runs is returned. No set has more than `most_terms`. After Chkifa, Cohen and Schwab 2015, J. Math. Pures
/// Appl. 103, with the l1 fit in place of interpolation.
Eigen::MatrixXi adaptive_degrees(const ScatteredData& data, int rounds, std::size_t most_terms, bool penalise_constant, int folds, std::uint64_t seed);

}  // namespace calomel
