#include "forward/surrogate/network_training.hpp"

#include <cmath>

#include "base/errors.hpp"
#include "base/parallel.hpp"

namespace calomel {
namespace {

/// Loss summed over the entries, and its derivative times `scale` in place of the error.
template <class Derived>
double loss_of_error(Loss loss, double scale, Eigen::MatrixBase<Derived>& error) {
  using Scalar = typename Derived::Scalar;
  if (loss == Loss::mae) {
    const double sum = error.cwiseAbs().template cast<double>().sum();
    error = (error.array().sign() * Scalar(scale)).matrix();
    return sum;
  }
  const double sum = error.template cast<double>().squaredNorm();
  error *= Scalar(2 * scale);
  return sum;
}

template <class Scalar>
double mean_loss(const Network<Scalar>& network, const typename Network<Scalar>::Matrix& x, const typename Network<Scalar>::Matrix& y, Loss loss, int threads) {
  typename Network<Scalar>::Tape tape;
  const auto h = network.hidden(x, tape);
  const Eigen::Index rows = NetworkTrainer<Scalar>::rows_per_block, n = y.rows();
  std::vector<double> sums(std::size_t((n + rows - 1) / rows));
  parallel_for(sums.size(), threads, [&](std::size_t b) {
    const Eigen::Index first = Eigen::Index(b) * rows, count = std::min(rows, n - first);
    typename Network<Scalar>::Matrix error(count, y.cols());
    network.output_rows(h, first, count, error);
    error -= y.middleRows(first, count);
    sums[b] = loss_of_error(loss, 1, error);
  });
  double sum = 0;
  for (double s : sums) sum += s;
  return sum / double(y.size());
}

template <class Scalar>
std::vector<DenseLayer<Scalar>> zeros_like(const std::vector<DenseLayer<Scalar>>& layers) {
  auto z = layers;
  for (auto& l : z) l.W.setZero(), l.b.setZero();
  return z;
}

}  // namespace

template <class Scalar>
void Adam::update(Scalar* x, const Scalar* g, Scalar* m, Scalar* v, Eigen::Index size, bool decays) const {
  using Array = Eigen::Array<Scalar, Eigen::Dynamic, 1>;
  const Scalar b1 = Scalar(beta1), b2 = Scalar(beta2);
  const double correct1 = 1 - std::pow(beta1, step), correct2 = 1 - std::pow(beta2, step);
  const Scalar rate1 = Scalar(rate / correct1), root2 = Scalar(1 / std::sqrt(correct2)), eps = Scalar(epsilon);
  const Scalar keep = Scalar(1 - (decays ? rate * decay : 0));
  // In short pieces, so that the moments are still in cache when the weights are moved.
  constexpr Eigen::Index piece = 1024;
  for (Eigen::Index i = 0; i < size; i += piece) {
    const Eigen::Index n = std::min(piece, size - i);
    Eigen::Map<const Array> G(g + i, n);
    Eigen::Map<Array> X(x + i, n), M(m + i, n), V(v + i, n);
    M = b1 * M + (1 - b1) * G;
    V = b2 * V + (1 - b2) * G * G;
    X = keep * X - rate1 * M / (root2 * V.sqrt() + eps);
  }
}
template void Adam::update(float*, const float*, float*, float*, Eigen::Index, bool) const;
template void Adam::update(double*, const double*, double*, double*, Eigen::Index, bool) const;

double PlateauSchedule::next(double loss) {
  if (!started_ || loss < best_) {
    best_ = loss;
    waited_ = 0;
    started_ = true;
  } else if (++waited_ >= patience_) {
    rate_ *= factor_;
    waited_ = 0;
  }
  return rate_;
}

template <class Scalar>
NetworkTrainer<Scalar>::NetworkTrainer(Network<Scalar>& network, const NetworkTraining& options, int threads)
    : network_(network), options_(options), threads_(threads), gradient_(network.layers()), m_(zeros_like(network.layers())), v_(m_) {
  adam_.rate = options.learning_rate;
  adam_.decay = options.weight_decay;
}

template <class Scalar>
void NetworkTrainer<Scalar>::update(Layer& layer, const Layer& gradient, Layer& m, Layer& v) const {
  adam_.update(layer.W.data(), gradient.W.data(), m.W.data(), v.W.data(), layer.W.size(), true);
  adam_.update(layer.b.data(), gradient.b.data(), m.b.data(), v.b.data(), layer.b.size(), false);
}

template <class Scalar>
double NetworkTrainer<Scalar>::step(const Matrix& x, const Matrix& y) {
  expect(x.cols() == y.cols() && y.rows() == network_.outputs(), "a training step gets as many targets as the network has outputs");
  ++adam_.step;
  const Matrix h = network_.hidden(x, tape_);
  Layer& last = network_.layers().back();
  Layer &dlast = gradient_.back(), &m = m_.back(), &v = v_.back();
  const Eigen::Index n = y.rows();
  const std::size_t blocks = std::size_t((n + rows_per_block - 1) / rows_per_block);
  const double scale = 1.0 / double(y.size());
  std::vector<double> losses(blocks);
  std::vector<Matrix> dh(blocks);
  // Forward, loss, backward and Adam of one block of output rows while they are in cache.
  parallel_for(blocks, threads_, [&](std::size_t block) {
    const Eigen::Index first = Eigen::Index(block) * rows_per_block, count = std::min(rows_per_block, n - first);
    Matrix error(count, y.cols());
    network_.output_rows(h, first, count, error);
    error -= y.middleRows(first, count);
    losses[block] = loss_of_error(options_.loss, scale, error);
    dh[block].noalias() = last.W.middleRows(first, count).transpose() * error;
    auto dW = dlast.W.middleRows(first, count);
    dW.noalias() = error * h.transpose();
    dlast.b.segment(first, count) = error.rowwise().sum();
    const Eigen::Index at = first * last.W.cols(), size = count * last.W.cols();
    adam_.update(last.W.data() + at, dlast.W.data() + at, m.W.data() + at, v.W.data() + at, size, true);
    adam_.update(last.b.data() + first, dlast.b.data() + first, m.b.data() + first, v.b.data() + first, count, false);
  });
  double loss = 0;
  for (double l : losses) loss += l;
  for (std::size_t b = 1; b < blocks; ++b) dh[0] += dh[b];
  network_.backward_hidden(tape_, std::move(dh[0]), &gradient_);
  for (std::size_t l = 0; l + 1 < network_.layers().size(); ++l) update(network_.layers()[l], gradient_[l], m_[l], v_[l]);
  return loss * scale;
}

template <class Scalar>
NetworkSummary train_network(Network<Scalar>& network, const typename Network<Scalar>::Matrix& x, const typename Network<Scalar>::Matrix& y,
                             const typename Network<Scalar>::Matrix& x_test, const typename Network<Scalar>::Matrix& y_test, const NetworkTraining& options,
                             RandomStream& random, int threads) {
  expect(x.cols() == y.cols() && x.cols() > 0, "a network is trained on at least one sample");
  NetworkSummary summary;
  NetworkTrainer<Scalar> trainer(network, options, threads);
  PlateauSchedule schedule(options.learning_rate, options.plateau_factor, options.plateau_patience);
  const Eigen::Index n = x.cols(), batch = std::min<Eigen::Index>(options.batch_size, n);
  auto mean = zeros_like(network.layers());
  int in_mean = 0;
  for (int epoch = 0; epoch < options.epochs; ++epoch) {
    const auto order = random.permutation(std::size_t(n));
    double sum = 0;
    for (Eigen::Index first = 0; first < n; first += batch) {
      const Eigen::Index count = std::min(batch, n - first);
      typename Network<Scalar>::Matrix xb(x.rows(), count), yb(y.rows(), count);
      for (Eigen::Index i = 0; i < count; ++i) {
        const auto from = Eigen::Index(order[std::size_t(first + i)]);
        xb.col(i) = x.col(from);
        yb.col(i) = y.col(from);
      }
      sum += trainer.step(xb, yb) * double(count);
    }
    summary.train_loss.push_back(sum / double(n));
    if (!std::isfinite(summary.train_loss.back()))
      throw NumericsError("surrogate network: the loss is not finite in epoch " + std::to_string(epoch + 1) + "; a smaller learning_rate helps");
    if (x_test.cols() > 0) summary.test_loss.push_back(mean_loss(network, x_test, y_test, options.loss, threads));
    trainer.adam().rate = schedule.next(summary.train_loss.back());
    if (options.averaged && 4 * (epoch + 1) > 3 * options.epochs) {
      ++in_mean;
      for (std::size_t l = 0; l < mean.size(); ++l) {
        mean[l].W += (network.layers()[l].W - mean[l].W) / Scalar(in_mean);
        mean[l].b += (network.layers()[l].b - mean[l].b) / Scalar(in_mean);
      }
    }
  }
  if (in_mean > 0) network.layers() = std::move(mean);
  summary.final_rate = schedule.rate();
  return summary;
}
#define CALOMEL_INSTANTIATE(S)                                                                                                        \
  template class NetworkTrainer<S>;                                                                                                   \
  template NetworkSummary train_network(Network<S>&, const Network<S>::Matrix&, const Network<S>::Matrix&, const Network<S>::Matrix&, \
                                        const Network<S>::Matrix&, const NetworkTraining&, RandomStream&, int)
CALOMEL_INSTANTIATE(float);
CALOMEL_INSTANTIATE(double);
#undef CALOMEL_INSTANTIATE

}  // namespace calomel
