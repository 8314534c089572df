#include "forward/surrogate/mode_network.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "forward/surrogate/network_training.hpp"
#include "forward/surrogate/published_network.hpp"
#include "forward/surrogate/stored_array.hpp"

namespace calomel {
namespace {

/// The decay whose network errs least on a fifth of the training runs that it did not see.
double chosen_decay(const std::vector<int>& widths, const ModeNetworkOptions& own, const NetworkTraining& training, const Eigen::MatrixXf& x,
                    const Eigen::MatrixXf& y, std::uint64_t seed, int threads) {
  const Eigen::Index n = x.cols(), held_out = std::max<Eigen::Index>(1, n / 5);
  RandomStream shuffle(seed, 50);
  const auto order = shuffle.permutation(std::size_t(n));
  Eigen::MatrixXf x_in(x.rows(), n - held_out), y_in(y.rows(), n - held_out), x_out(x.rows(), held_out), y_out(y.rows(), held_out);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto from = Eigen::Index(order[std::size_t(i)]);
    if (i < held_out) {
      x_out.col(i) = x.col(from);
      y_out.col(i) = y.col(from);
    } else {
      x_in.col(i - held_out) = x.col(from);
      y_in.col(i - held_out) = y.col(from);
    }
  }
  std::vector<double> error(own.weight_decay.size());
  parallel_for(error.size(), threads, [&](std::size_t i) {
    RandomStream random(seed, 51);
    Network<float> network(widths, activation_named(own.activation), random);
    NetworkTraining one = training;
    one.weight_decay = own.weight_decay[i];
    train_network<float>(network, x_in, y_in, Eigen::MatrixXf(x.rows(), 0), Eigen::MatrixXf(y.rows(), 0), one, random, 1);
    error[i] = (network.forward(x_out) - y_out).cast<double>().squaredNorm();
  });
  return own.weight_decay[std::size_t(std::min_element(error.begin(), error.end()) - error.begin())];
}

}  // namespace

std::unique_ptr<TrainedMap> ModeNetwork::train(const TrainingSet& set, const SurrogateOptions& options, std::uint64_t seed, int threads,
                                               TrainingRecord& record) {
  const ModeNetworkOptions& own = options.mode_network;
  InputScaling inputs(set.parameters, Coordinates::both, -1, 1);
  ModeBasis basis(set.histories, set.series, options.modes);
  record.modes = int(basis.modes());
  record.mode_energy = basis.energy();
  Eigen::VectorXf weight = Eigen::VectorXf::Ones(basis.modes());
  for (Eigen::Index k = 0; k < basis.modes(); ++k) weight[k] = float(std::pow(basis.deviation()[k] / basis.deviation()[0], 1 - own.whitening));
  const auto targets = [&](const Eigen::MatrixXf& histories) -> Eigen::MatrixXf { return weight.asDiagonal() * basis.whitened(histories).cast<float>(); };
  const Eigen::MatrixXf x = inputs.features(set.theta).cast<float>(), y = targets(set.histories);
  Eigen::MatrixXf x_test(x.rows(), 0), y_test(y.rows(), 0);
  if (set.test_theta.cols() > 0) {
    x_test = inputs.features(set.test_theta).cast<float>();
    y_test = targets(set.test_histories);
  }

  std::vector<int> widths{int(inputs.features())};
  widths.insert(widths.end(), own.layers.begin(), own.layers.end());
  widths.push_back(int(basis.modes()));
  NetworkTraining training{.learning_rate = own.learning_rate,
                           .plateau_factor = options.plateau_factor,
                           .plateau_patience = options.plateau_patience,
                           .batch_size = own.batch_size,
                           .epochs = options.epochs * own.passes_per_epoch,
                           .loss = Loss::mse,
                           .averaged = true};
  training.weight_decay = own.weight_decay.size() > 1 ? chosen_decay(widths, own, training, x, y, seed, threads) : own.weight_decay[0];
  std::vector<std::unique_ptr<Network<float>>> trained{std::size_t(own.members)};
  std::vector<NetworkSummary> summaries(trained.size());
  parallel_for(trained.size(), threads, [&](std::size_t i) {
    RandomStream random(seed, 100 + i);
    trained[i] = std::make_unique<Network<float>>(widths, activation_named(own.activation), random);
    summaries[i] = train_network<float>(*trained[i], x, y, x_test, y_test, training, random, 1);
  });
  std::vector<Network<float>> members;
  for (auto& m : trained) members.push_back(std::move(*m));
  record.epochs = training.epochs;
  record.train_loss = summaries[0].train_loss;
  record.test_loss = summaries[0].test_loss;
  return std::unique_ptr<TrainedMap>(new ModeNetwork(std::move(inputs), std::move(basis), std::move(weight), std::move(members)));
}

HistoryBasis ModeNetwork::basis() const { return {basis_.mean(), basis_.map()}; }

Eigen::MatrixXf ModeNetwork::coefficients(const Eigen::MatrixXd& thetas) const {
  const Eigen::MatrixXf x = inputs_.features(thetas).cast<float>();
  Eigen::MatrixXf sum = members_[0].forward(x);
  for (std::size_t i = 1; i < members_.size(); ++i) sum += members_[i].forward(x);
  const Eigen::VectorXf share = (weight_ * float(members_.size())).cwiseInverse();
  return share.asDiagonal() * sum;
}

Eigen::MatrixXf ModeNetwork::histories(const Eigen::MatrixXd& thetas, int threads) const {
  return basis_.histories(coefficients(thetas).cast<double>(), threads);
}

Eigen::VectorXd ModeNetwork::vector_jacobian_product(const Eigen::VectorXd& theta, const Eigen::VectorXd& weights) const {
  const Eigen::MatrixXf x = inputs_.features(theta).cast<float>();
  const Eigen::MatrixXf dy = (basis_.vector_jacobian_product(weights).cast<float>().array() / (weight_ * float(members_.size())).array()).matrix();
  Eigen::VectorXd g = Eigen::VectorXd::Zero(x.rows());
  for (const auto& member : members_) {
    Network<float>::Tape tape;
    member.hidden(x, tape);
    g += member.backward(tape, dy, nullptr).col(0).cast<double>();
  }
  return inputs_.vector_jacobian_product(theta, g);
}

Eigen::VectorXd ModeNetwork::variance(const Eigen::VectorXd& theta) const {
  const Eigen::MatrixXf x = inputs_.features(theta).cast<float>();
  Eigen::MatrixXd z(basis_.modes(), Eigen::Index(members_.size()));
  for (std::size_t i = 0; i < members_.size(); ++i) z.col(Eigen::Index(i)) = (members_[i].forward(x).col(0).array() / weight_.array()).matrix().cast<double>();
  const Eigen::VectorXd mean = z.rowwise().mean();
  const Eigen::VectorXd of_members = (z.colwise() - mean).rowwise().squaredNorm() / double(std::max<std::size_t>(1, members_.size() - 1));
  return basis_.variance(of_members);
}

void ModeNetwork::save(NetcdfWriter& file, const std::string& prefix) const {
  inputs_.save(file, prefix);
  basis_.save(file, prefix);
  store(file, prefix + "mode_weight", Eigen::MatrixXf(weight_));
  store(file, prefix + "members", std::vector<int>{int(members_.size())});
  for (std::size_t i = 0; i < members_.size(); ++i) save_network(file, prefix + "member_" + std::to_string(i) + '_', members_[i]);
}

std::unique_ptr<TrainedMap> ModeNetwork::load(const NetcdfReader& file, const std::string& prefix) {
  std::vector<Network<float>> members;
  const int n = file.integers(prefix + "members")[0];
  for (int i = 0; i < n; ++i) members.push_back(load_network(file, prefix + "member_" + std::to_string(i) + '_'));
  return std::unique_ptr<TrainedMap>(
      new ModeNetwork(InputScaling::load(file, prefix), ModeBasis::load(file, prefix), stored_matrix<float>(file, prefix + "mode_weight"), std::move(members)));
}

}  // namespace calomel
