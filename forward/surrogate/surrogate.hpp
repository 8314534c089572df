#pragma once
/// A trained surrogate as a ForwardModel: the emulated mean and, where the archive has them, the energy slope and the
/// scatter of single pulses.
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "forward/campaign/archive.hpp"
#include "forward/surrogate/trained_map.hpp"

namespace calomel {

class Surrogate final : public ForwardModel {
 public:
  /// The emulators of one campaign; `slope` and `scatter` may be null. `held_out`: mean squared error of the mean over
  /// the held-out runs (values), in the data's unit squared. `variance_factor`: what the kind's own variance is multiplied
  /// by, so that on the held-out runs it is not smaller than the errors were; at least 1.
  struct Parts {
    std::string kind;
    ModelShape shape;
    std::unique_ptr<TrainedMap> mean, slope, scatter;
    Eigen::VectorXf held_out;
    double variance_factor = 1;
  };
  explicit Surrogate(Parts parts);

  [[nodiscard]] const ModelShape& shape() const override { return parts_.shape; }
  [[nodiscard]] const std::string& kind() const { return parts_.kind; }
  /// A point outside the bounds of the campaign is a failed run: the surrogate knows nothing there.
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override;
  [[nodiscard]] Eigen::MatrixXf means(const Eigen::MatrixXd& thetas, int threads) const override;
  [[nodiscard]] HistoryBasis basis() const override { return parts_.mean->basis(); }
  [[nodiscard]] Eigen::MatrixXf coefficients(const Eigen::MatrixXd& thetas) const override;
  [[nodiscard]] bool has_gradient() const override { return true; }
  [[nodiscard]] Eigen::VectorXd vector_jacobian_product(std::span<const double> theta, std::span<const double> weights) const override;

  /// Variance of (model - surrogate) at theta (values), in the data's unit squared: the kind's predictive variance
  /// times the factor found on held-out runs, discarded modes included, where it has one; else the mean squared error over the held-out runs.
  [[nodiscard]] Eigen::VectorXd error_variance(std::span<const double> theta) const;
  /// Mean squared error over the held-out runs (values), anywhere in the box.
  [[nodiscard]] const Eigen::VectorXf& held_out_error() const { return parts_.held_out; }

  /// netCDF, atomically; `load_surrogate` gives a surrogate of the same bytes of prediction.
  void save(const std::filesystem::path& path) const;

 private:
  [[nodiscard]] bool inside(const double* theta, std::string* why) const;
  /// A function of many points, with columns of NaN where a point lies outside the campaign's bounds.
  [[nodiscard]] Eigen::MatrixXf at_inside(const Eigen::MatrixXd& thetas, const std::function<Eigen::MatrixXf(const Eigen::MatrixXd&)>& of) const;
  Parts parts_;
};

/// Errors: InputError when the file is absent or no surrogate of this program.
std::unique_ptr<Surrogate> load_surrogate(const std::filesystem::path& path);

}  // namespace calomel
