#pragma once
/// Surrogate "network": the published one, from parameters to every sample of every sensor.
#include "forward/surrogate/trained_map.hpp"
#include "forward/surrogate/input_scaling.hpp"
#include "forward/surrogate/network.hpp"

namespace calomel {

/// Stores a network's layers and activation. `load_network` reads them back bit for bit.
void save_network(NetcdfWriter& file, const std::string& prefix, const Network<float>& network);
Network<float> load_network(const NetcdfReader& file, const std::string& prefix);

/// Feedforward network on the parameters scaled to [0, 1] by their bounds; the histories are centred by their mean over
/// the training runs and divided by one number, the overall standard deviation, so that the loss remains the MAE in
/// strain up to that factor. Defaults: the seed paper's table of hyperparameters (layers 242, 191, 128, 108, 94, 72,
/// ReLU, Adam at 9.5e-4 with the plateau rule, batch 8, 100 epochs, MAE). Initial weights as in Keras (Glorot uniform).
class PublishedNetwork final : public TrainedMap {
 public:
  static std::unique_ptr<TrainedMap> train(const TrainingSet& set, const SurrogateOptions& options, std::uint64_t seed, int threads, TrainingRecord& record);
  static std::unique_ptr<TrainedMap> load(const NetcdfReader& file, const std::string& prefix);

  [[nodiscard]] Eigen::MatrixXf histories(const Eigen::MatrixXd& thetas, int threads) const override;
  [[nodiscard]] HistoryBasis basis() const override;
  [[nodiscard]] Eigen::MatrixXf coefficients(const Eigen::MatrixXd& thetas) const override;
  [[nodiscard]] Eigen::VectorXd vector_jacobian_product(const Eigen::VectorXd& theta, const Eigen::VectorXd& weights) const override;
  void save(NetcdfWriter& file, const std::string& prefix) const override;

 private:
  PublishedNetwork(InputScaling inputs, Network<float> network, Eigen::VectorXf mean, float scale)
      : inputs_(std::move(inputs)), network_(std::move(network)), mean_(std::move(mean)), scale_(scale) {}
  InputScaling inputs_;
  Network<float> network_;
  Eigen::VectorXf mean_;  ///< (values)
  float scale_;
};

}  // namespace calomel
