#pragma once
/// Training of a feedforward network: Adam, the plateau schedule, seeded mini-batches.
#include <cstdint>
#include <string>
#include <vector>

#include "forward/surrogate/network.hpp"

namespace calomel {

/// Adam (Kingma and Ba 2015, algorithm 1): m <- b1 m + (1 - b1) g, v <- b2 v + (1 - b2) g^2,
/// x <- x - rate (m / (1 - b1^t)) / (sqrt(v / (1 - b2^t)) + epsilon); with `decay`, x also shrinks by rate decay x
/// (decoupled weight decay, Loshchilov and Hutter 2019).
struct Adam {
  double rate = 1e-3;
  double beta1 = 0.9;
  double beta2 = 0.999;
  double epsilon = 1e-7;
  double decay = 0;
  int step = 0;  ///< t, counted up by the owner before the updates of a step

  /// One update of `size` numbers at x with gradient g and moments m, v (start at zero).
  template <class Scalar>
  void update(Scalar* x, const Scalar* g, Scalar* m, Scalar* v, Eigen::Index size, bool decays) const;
};

/// Multiplies the rate by `factor` after `patience` epochs in a row in which the monitored loss did not fall below its best.
class PlateauSchedule {
 public:
  PlateauSchedule(double rate, double factor, int patience) : rate_(rate), factor_(factor), patience_(patience) {}
  /// Takes the loss of the epoch that ended; returns the rate of the next one.
  double next(double loss);
  [[nodiscard]] double rate() const { return rate_; }

 private:
  double rate_, factor_;
  int patience_, waited_ = 0;
  double best_ = 0;
  bool started_ = false;
};

enum class Loss { mae, mse };

struct NetworkTraining {
  double learning_rate = 9.5e-4;
  double plateau_factor = 0.95;
  int plateau_patience = 5;
  int batch_size = 8;
  int epochs = 100;  ///< passes over the samples
  Loss loss = Loss::mae;
  double weight_decay = 0;
  bool averaged = false;  ///< keep the mean of the weights over the last quarter of the epochs (Izmailov et al. 2018)
};

struct NetworkSummary {
  std::vector<double> train_loss;  ///< mean over an epoch's batches, during training
  std::vector<double> test_loss;   ///< at the end of each epoch, on the held-out samples; for information only, never used in training
  double final_rate = 0;
};

/// One Adam step at a time. The output layer is worked in fixed blocks of rows on `threads` threads, each block summing
/// for itself and the blocks being added in order, so that the result does not depend on the number of threads.
template <class Scalar>
class NetworkTrainer {
 public:
  using Matrix = typename Network<Scalar>::Matrix;
  static constexpr Eigen::Index rows_per_block = 512;

  NetworkTrainer(Network<Scalar>& network, const NetworkTraining& options, int threads);
  /// x: (inputs, samples), y: (outputs, samples). Returns the loss before the step: the mean over samples and outputs of
  /// |error| (MAE) or error^2 (MSE).
  double step(const Matrix& x, const Matrix& y);
  [[nodiscard]] Adam& adam() { return adam_; }

 private:
  using Layer = DenseLayer<Scalar>;
  void update(Layer& layer, const Layer& gradient, Layer& m, Layer& v) const;
  Network<Scalar>& network_;
  NetworkTraining options_;
  int threads_;
  Adam adam_;
  typename Network<Scalar>::Tape tape_;
  std::vector<Layer> gradient_, m_, v_;
};

/// Trains in place. x, y: samples in columns; x_test, y_test are only monitored and may be empty.
/// The plateau rule watches the training loss, so held-out samples remain unseen. Deterministic for a given stream.
template <class Scalar>
NetworkSummary train_network(Network<Scalar>& network, const typename Network<Scalar>::Matrix& x, const typename Network<Scalar>::Matrix& y,
                             const typename Network<Scalar>::Matrix& x_test, const typename Network<Scalar>::Matrix& y_test, const NetworkTraining& options,
                             RandomStream& random, int threads);

}  // namespace calomel
