#include "forward/surrogate/published_network.hpp"

#include "base/parallel.hpp"
#include "forward/surrogate/network_training.hpp"
#include "forward/surrogate/stored_array.hpp"

namespace calomel {

void save_network(NetcdfWriter& file, const std::string& prefix, const Network<float>& network) {
  store(file, prefix + "layers", std::vector<int>{int(network.layers().size()), int(network.activation())});
  for (std::size_t l = 0; l < network.layers().size(); ++l) {
    store(file, prefix + "weights_" + std::to_string(l), Eigen::MatrixXf(network.layers()[l].W));
    store(file, prefix + "biases_" + std::to_string(l), Eigen::MatrixXf(network.layers()[l].b));
  }
}

Network<float> load_network(const NetcdfReader& file, const std::string& prefix) {
  const auto head = file.integers(prefix + "layers");
  std::vector<DenseLayer<float>> layers;
  for (int l = 0; l < head[0]; ++l)
    layers.push_back({stored_matrix<float>(file, prefix + "weights_" + std::to_string(l)), stored_matrix<float>(file, prefix + "biases_" + std::to_string(l))});
  return {std::move(layers), Activation(head[1])};
}

std::unique_ptr<TrainedMap> PublishedNetwork::train(const TrainingSet& set, const SurrogateOptions& options, std::uint64_t seed, int threads,
                                                    TrainingRecord& record) {
  InputScaling inputs(set.parameters, Coordinates::linear, 0, 1);
  const Eigen::VectorXf mean = set.histories.cast<double>().rowwise().mean().cast<float>();
  Eigen::MatrixXf y = set.histories.colwise() - mean;
  const double deviation = std::sqrt(y.cast<double>().squaredNorm() / double(y.size()));
  const float scale = deviation > 0 ? float(deviation) : 1.0f;
  y /= scale;
  Eigen::MatrixXf test = set.test_histories;
  if (test.cols() > 0) test = (test.colwise() - mean) / scale;

  std::vector<int> widths{int(inputs.features())};
  widths.insert(widths.end(), options.layers.begin(), options.layers.end());
  widths.push_back(int(set.histories.rows()));
  RandomStream random(seed, 1);
  Network<float> network(widths, activation_named(options.activation), random);
  const NetworkTraining training{.learning_rate = options.learning_rate,
                                 .plateau_factor = options.plateau_factor,
                                 .plateau_patience = options.plateau_patience,
                                 .batch_size = options.batch_size,
                                 .epochs = options.epochs,
                                 .loss = options.loss == "mae" ? Loss::mae : Loss::mse};
  const Eigen::MatrixXf x = inputs.features(set.theta).cast<float>();
  Eigen::MatrixXf x_test(inputs.features(), 0);
  if (test.cols() > 0) x_test = inputs.features(set.test_theta).cast<float>();
  auto summary = train_network<float>(network, x, y, x_test, test, training, random, threads);
  record.epochs = options.epochs;
  record.train_loss = std::move(summary.train_loss);
  record.test_loss = std::move(summary.test_loss);
  return std::unique_ptr<TrainedMap>(new PublishedNetwork(std::move(inputs), std::move(network), mean, scale));
}

Eigen::MatrixXf PublishedNetwork::histories(const Eigen::MatrixXd& thetas, int threads) const {
  Network<float>::Tape tape;
  const Eigen::MatrixXf h = network_.hidden(inputs_.features(thetas).cast<float>(), tape);
  Eigen::MatrixXf y(network_.outputs(), thetas.cols());
  constexpr Eigen::Index rows = 1024;
  parallel_for(std::size_t((y.rows() + rows - 1) / rows), threads, [&](std::size_t block) {
    const Eigen::Index first = Eigen::Index(block) * rows, count = std::min(rows, y.rows() - first);
    Eigen::MatrixXf part(count, y.cols());
    network_.output_rows(h, first, count, part);
    y.middleRows(first, count) = (part * scale_).colwise() + mean_.segment(first, count);
  });
  return y;
}

HistoryBasis PublishedNetwork::basis() const {
  const auto& last = network_.layers().back();
  return {mean_ + scale_ * last.b, scale_ * last.W};
}

Eigen::MatrixXf PublishedNetwork::coefficients(const Eigen::MatrixXd& thetas) const {
  Network<float>::Tape tape;
  return network_.hidden(inputs_.features(thetas).cast<float>(), tape);
}

Eigen::VectorXd PublishedNetwork::vector_jacobian_product(const Eigen::VectorXd& theta, const Eigen::VectorXd& weights) const {
  Network<float>::Tape tape;
  network_.hidden(inputs_.features(theta).cast<float>(), tape);
  const Eigen::MatrixXf dy = weights.cast<float>() * scale_;
  return inputs_.vector_jacobian_product(theta, network_.backward(tape, dy, nullptr).col(0).cast<double>());
}

void PublishedNetwork::save(NetcdfWriter& file, const std::string& prefix) const {
  inputs_.save(file, prefix);
  save_network(file, prefix, network_);
  store(file, prefix + "output_mean", Eigen::MatrixXf(mean_));
  store(file, prefix + "output_scale", Eigen::MatrixXf(Eigen::MatrixXf::Constant(1, 1, scale_)));
}

std::unique_ptr<TrainedMap> PublishedNetwork::load(const NetcdfReader& file, const std::string& prefix) {
  return std::unique_ptr<TrainedMap>(new PublishedNetwork(InputScaling::load(file, prefix), load_network(file, prefix),
                                                          stored_matrix<float>(file, prefix + "output_mean"),
                                                          stored_matrix<float>(file, prefix + "output_scale")(0, 0)));
}

}  // namespace calomel
