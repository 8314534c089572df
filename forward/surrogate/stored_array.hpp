#pragma once
/// Eigen matrices and lists of whole numbers in the netCDF file of a surrogate, bit for bit.
#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "base/netcdf_file.hpp"

namespace calomel {

/// Stores a matrix as a variable (row, column) with dimensions of its own.
template <class Scalar>
void store(NetcdfWriter& file, const std::string& name, const Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>& m, const Attributes& attributes = {}) {
  const Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = m;
  file.dimension(name + "_row", std::size_t(m.rows()));
  file.dimension(name + "_column", std::size_t(m.cols()));
  file.variable(name, {name + "_row", name + "_column"}, std::span<const Scalar>(rows.data(), std::size_t(rows.size())), attributes);
}

inline void store(NetcdfWriter& file, const std::string& name, const std::vector<int>& values) {
  file.dimension(name + "_index", values.size());
  file.variable(name, {name + "_index"}, std::span<const int>(values));
}

/// Errors: InputError when the variable is missing or no matrix.
template <class Scalar>
Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> stored_matrix(const NetcdfReader& file, const std::string& name) {
  const auto shape = file.shape(name);
  if (shape.size() != 2) throw InputError({.problem = "the variable " + name + " of a surrogate file has two dimensions, this one has not"});
  const auto values = file.doubles(name);
  Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> m{Eigen::Index(shape[0]), Eigen::Index(shape[1])};
  for (Eigen::Index r = 0; r < m.rows(); ++r)
    for (Eigen::Index c = 0; c < m.cols(); ++c) m(r, c) = Scalar(values[std::size_t(r * m.cols() + c)]);
  return m;
}

}  // namespace calomel
