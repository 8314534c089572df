#pragma once
/// Proper orthogonal modes of the training histories (Sirovich 1987): the singular vectors of the centred histories.
#include <Eigen/Core>
#include <string>

#include "base/netcdf_file.hpp"
#include "base/options.hpp"

namespace calomel {

struct ModeOptions {
  double energy = 0.99999;
  int most = 400;
  bool per_sensor_scaling = true;

  template <class V>
  void visit(V& v) {
    v("energy", energy, {.range = {.low = 0, .high = 1, .low_open = true}, .doc = "share of the variance of the training histories that the kept modes carry"});
    v("most", most, {.range = at_least(1), .doc = "at most so many modes"});
    v("per_sensor_scaling", per_sensor_scaling, {.doc = "give every sensor the same variance before the modes are found"});
  }
};

/// history = mean + scale * (vectors * coefficients); the scale is one number a sensor.
class ModeBasis {
 public:
  /// histories: (values, n_runs), at least two runs; `series`: number of (condition, sensor) rows in a history, each of
  /// values / series times.
  ModeBasis(const Eigen::MatrixXf& histories, std::size_t series, const ModeOptions& options);

  [[nodiscard]] Eigen::Index values() const { return mean_.size(); }
  [[nodiscard]] Eigen::Index modes() const { return deviation_.size(); }
  /// Mean history (values), and scale * vectors * deviation (values, modes): a history is the mean plus the map times whitened coefficients.
  [[nodiscard]] const Eigen::VectorXf& mean() const { return mean_; }
  [[nodiscard]] const auto& map() const { return map_; }
  /// Orthonormal columns, (values, modes).
  [[nodiscard]] const Eigen::MatrixXf& vectors() const { return vectors_; }
  /// Standard deviation of each mode's coefficient over the training runs, decreasing, (modes).
  [[nodiscard]] const Eigen::VectorXd& deviation() const { return deviation_; }
  /// Share of the training variance in the kept modes.
  [[nodiscard]] double energy() const { return energy_; }

  /// Whitened coefficients (unit variance over the training runs), (modes, n).
  [[nodiscard]] Eigen::MatrixXd whitened(const Eigen::MatrixXf& histories) const;
  /// Histories from whitened coefficients, (values, n), in fixed blocks of rows on `threads` threads.
  [[nodiscard]] Eigen::MatrixXf histories(const Eigen::MatrixXd& whitened, int threads) const;
  /// Gradient by the values (values) turned into one by the whitened coefficients (modes).
  [[nodiscard]] Eigen::VectorXd vector_jacobian_product(const Eigen::VectorXd& weights) const;
  /// Variance of the values from independent variances of the whitened coefficients (modes), discarded modes included.
  [[nodiscard]] Eigen::VectorXd variance(const Eigen::VectorXd& of_whitened) const;

  void save(NetcdfWriter& file, const std::string& prefix) const;
  static ModeBasis load(const NetcdfReader& file, const std::string& prefix);

 private:
  ModeBasis() = default;
  void make_map();
  Eigen::VectorXf mean_, scale_;  ///< (values)
  Eigen::VectorXf discarded_;     ///< variance of the values over the training runs that the kept modes miss, (values)
  Eigen::MatrixXf vectors_;       ///< (values, modes)
  Eigen::VectorXd deviation_;     ///< (modes)
  double energy_ = 0;
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> map_;  ///< scale * vectors * deviation
};

}  // namespace calomel
