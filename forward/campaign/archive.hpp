#pragma once
/// A campaign's archive: every design point with its prediction or the reason why there is none.
#include <Eigen/Core>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "forward/model.hpp"

namespace calomel {

/// Order of the flag meanings of `status` in campaign.nc.
enum class RunStatus : int { done = 0, failed = 1 };

struct Archive {
  ModelShape shape;                  ///< parameters, conditions, sensors, times of the runs
  std::string design;                ///< sobol, latin_hypercube, chebyshev
  Eigen::MatrixXd theta;             ///< (n_parameters, n_runs), natural units
  std::vector<RunStatus> status;     ///< (n_runs)
  std::vector<std::string> message;  ///< (n_runs), empty where done
  Eigen::MatrixXf mean;              ///< (values, n_runs) [-], NaN where failed; values as ModelShape::at
  Eigen::MatrixXf energy_slope;      ///< the same shape, or empty
  Eigen::MatrixXf scatter;           ///< the same shape, or empty

  [[nodiscard]] std::size_t runs() const { return status.size(); }
  /// Indices of the runs that are done.
  [[nodiscard]] std::vector<std::size_t> completed() const {
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < status.size(); ++i)
      if (status[i] == RunStatus::done) rows.push_back(i);
    return rows;
  }
};

/// Density of a design's measure at `unit` (coordinates scaled to [0, 1]) relative to uniform: 1 for sobol and
/// latin_hypercube, prod 1 / (pi sqrt(x (1 - x))) for chebyshev.
double design_density(const std::string& design, const Eigen::VectorXd& unit);

/// Reads campaign.nc. Errors: InputError when it is absent or of another form.
Archive read_archive(const std::filesystem::path& path);

}  // namespace calomel
