#pragma once
/// The fit that map.compare_with names.
#include <filesystem>

#include "inverse/map/map.hpp"

namespace calomel {

/// A finished fit of the same records by a model with fewer parameters, in the larger one's.
struct NestedFit {
  NestedModel model;                                  ///< name and added
  std::vector<std::pair<Eigen::Index, double>> held;  ///< added parameters at their nominal values
  std::vector<double> theta;                          ///< its mode, (n_parameters), nuisances included
  std::vector<double> history;                        ///< prediction of its finest mesh there, (values)
};

/// `parameters`: of the posterior, the nuisances after the `own` ones of the case. `recordings`: hash of their file; finest: element size [m].
/// Errors: InputError naming map.compare_with where there is no such fit, it is of other records or another product, was made on other meshes, or sought a
/// parameter that is not this case's, or all of them.
NestedFit read_nested_fit(const std::filesystem::path& directory, const std::vector<Parameter>& parameters, std::size_t own, const MapOptions& options,
                          const std::string& recordings);

/// Errors: InputError where this model at the nested mode is not the nested model. `record`: of this model's finest mesh there.
void expect_nested(const NestedFit& nested, const RunRecord& record, const MapOptions& options);

}  // namespace calomel
