#pragma once
/// The seam of the house: a ForwardModel turns parameters into sensor histories. The built-in solver, a surrogate and
/// an external model are all ForwardModels, so inverse/ and uq/ never know which they hold.
#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "forward/parameter.hpp"

namespace calomel {

/// What a model takes and gives. One condition (an operating point such as a beam power) is the common case.
struct ModelShape {
  std::vector<Parameter> parameters;    ///< in declared order; `nominal` is filled
  std::vector<std::string> conditions;  ///< at least one; {"default"} when the case lists none
  std::vector<std::string> sensors;
  std::vector<double> times;    ///< [s], common to all sensors
  std::string unit = "strain";  ///< of the values
  [[nodiscard]] std::size_t values() const { return conditions.size() * sensors.size() * times.size(); }
  /// Position of (condition, sensor, time) in a value vector: time is the last axis.
  [[nodiscard]] std::size_t at(std::size_t condition, std::size_t sensor, std::size_t time) const {
    return (condition * sensors.size() + sensor) * times.size() + time;
  }
};

/// One evaluation. Arrays are (condition, sensor, time) row-major, see ModelShape::at; empty when a model has none.
struct Prediction {
  bool ok = true;
  bool lost = false;                 ///< it failed because there was no response; another attempt may succeed
  std::string message;               ///< why it failed: step, element, parameters
  std::vector<double> mean;          ///< ensemble mean over pulse energies [-]
  std::vector<double> energy_slope;  ///< gradient of the strain with respect to the relative pulse energy [-]
  std::vector<double> scatter;       ///< sd of the single pulses about mean + slope (a - 1) [-]
  std::vector<float> pulses;         ///< (pulse, condition, sensor, time): the single pulses [-]
  std::vector<double> energies;      ///< relative energy of each pulse [-]
};

/// Histories as an offset plus fixed directions times coefficients that depend on the parameters.
struct HistoryBasis {
  Eigen::VectorXf offset;      ///< (values)
  Eigen::MatrixXf directions;  ///< (values, n_directions)
  [[nodiscard]] bool empty() const { return offset.size() == 0; }
  /// The same with further directions.
  [[nodiscard]] HistoryBasis with(const Eigen::MatrixXd& more) const;
};

class ForwardModel {
 public:
  virtual ~ForwardModel() = default;
  [[nodiscard]] virtual const ModelShape& shape() const = 0;

  /// One evaluation at `theta` (n_parameters, declared order, natural units). Safe to call from several threads at once.
  /// A failed run is a Prediction with ok = false, not an exception; exceptions are for the user's and our own mistakes.
  [[nodiscard]] virtual Prediction evaluate(std::span<const double> theta) const = 0;

  /// Called after each point of `predictions`, one at a time: points finished, and points in all.
  using Predicted = std::function<void(std::size_t done, std::size_t total)>;
  /// Many points at once, with the reason where one failed. thetas: (n_parameters, n). The default evaluates one by one on `threads` threads; the true model
  /// makes them by its executor.
  [[nodiscard]] virtual std::vector<Prediction> predictions(const Eigen::MatrixXd& thetas, int threads, const Predicted& predicted = {}) const;

  /// Means only, for many points at once. thetas: (n_parameters, n); result: (shape().values(), n), NaN columns where a run failed.
  /// The default evaluates one by one on `threads` threads; surrogates override it.
  [[nodiscard]] virtual Eigen::MatrixXf means(const Eigen::MatrixXd& thetas, int threads) const;

  /// Whether `vector_jacobian_product` is there (a surrogate has it, the explicit solver does not).
  [[nodiscard]] virtual bool has_gradient() const { return false; }
  /// Gradient of sum_i weights_i mean_i(theta) with respect to theta, shape (n_parameters).
  [[nodiscard]] virtual Eigen::VectorXd vector_jacobian_product(std::span<const double> theta, std::span<const double> weights) const;

  /// Offset and directions of a model whose means are offset + directions * coefficients(theta), so that many points can be scored without writing their
  /// histories; empty (the default) for one that is not of this form.
  [[nodiscard]] virtual HistoryBasis basis() const { return {}; }
  /// thetas: (n_parameters, n); result: (n_directions, n), NaN columns where a run failed. Of a model with a basis.
  [[nodiscard]] virtual Eigen::MatrixXf coefficients(const Eigen::MatrixXd& thetas) const;
};

/// Nominal values of the parameters, in declared order.
std::vector<double> nominal(const ModelShape& shape);

}  // namespace calomel
