#pragma once
/// Surrogate "mode_gaussian_process": one Gaussian process for each proper orthogonal mode of the histories.
#include "forward/surrogate/trained_map.hpp"
#include "forward/surrogate/gaussian_process.hpp"
#include "forward/surrogate/input_scaling.hpp"
#include "forward/surrogate/modes.hpp"

namespace calomel {

/// Higdon et al. 2008, section 2.2: independent processes on the whitened mode coefficients. Deterministic, cheap for a
/// few hundred runs (n^3 a step and mode), with a predictive variance that includes the discarded modes.
class ModeGaussianProcess final : public TrainedMap {
 public:
  static std::unique_ptr<TrainedMap> train(const TrainingSet& set, const SurrogateOptions& options, std::uint64_t seed, int threads, TrainingRecord& record);
  static std::unique_ptr<TrainedMap> load(const NetcdfReader& file, const std::string& prefix);

  [[nodiscard]] Eigen::MatrixXf histories(const Eigen::MatrixXd& thetas, int threads) const override;
  [[nodiscard]] HistoryBasis basis() const override;
  [[nodiscard]] Eigen::MatrixXf coefficients(const Eigen::MatrixXd& thetas) const override;
  [[nodiscard]] Eigen::VectorXd vector_jacobian_product(const Eigen::VectorXd& theta, const Eigen::VectorXd& weights) const override;
  [[nodiscard]] Eigen::VectorXd variance(const Eigen::VectorXd& theta) const override;
  void save(NetcdfWriter& file, const std::string& prefix) const override;

 private:
  ModeGaussianProcess(InputScaling inputs, ModeBasis basis, Eigen::MatrixXd x, Eigen::MatrixXd z, std::vector<GaussianProcess> processes)
      : inputs_(std::move(inputs)), basis_(std::move(basis)), x_(std::move(x)), z_(std::move(z)), processes_(std::move(processes)) {}
  /// Means of the whitened coefficients, (modes, n).
  [[nodiscard]] Eigen::MatrixXd whitened(const Eigen::MatrixXd& thetas, int threads) const;
  InputScaling inputs_;
  ModeBasis basis_;
  Eigen::MatrixXd x_;  ///< training features, (features, n_train)
  Eigen::MatrixXd z_;  ///< whitened coefficients, (modes, n_train)
  std::vector<GaussianProcess> processes_;
};

}  // namespace calomel
