#pragma once
/// Surrogate "mode_network": small smooth networks from parameters to the modes of the histories.
#include "forward/surrogate/trained_map.hpp"
#include "forward/surrogate/input_scaling.hpp"
#include "forward/surrogate/modes.hpp"
#include "forward/surrogate/network.hpp"

namespace calomel {

/// A few networks from different starts and shuffles, averaged (Lakshminarayanan et al. 2017), each from the parameters
/// (linear and, where positive, logarithmic too) to whitened mode coefficients times deviation^(1 - whitening).
/// Their scatter, with the discarded modes, is the predictive variance.
class ModeNetwork final : public TrainedMap {
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
  ModeNetwork(InputScaling inputs, ModeBasis basis, Eigen::VectorXf weight, std::vector<Network<float>> members)
      : inputs_(std::move(inputs)), basis_(std::move(basis)), weight_(std::move(weight)), members_(std::move(members)) {}
  InputScaling inputs_;
  ModeBasis basis_;
  Eigen::VectorXf weight_;  ///< a network's output = weight * whitened coefficient, (modes)
  std::vector<Network<float>> members_;
};

}  // namespace calomel
