#pragma once
/// A feedforward network of dense layers with its gradients by back-propagation (Rumelhart, Hinton and Williams 1986).
/// Templated on the scalar: single precision in use, double precision where gradients are checked.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/random.hpp"

namespace calomel {

enum class Activation { identity, relu, tanh, silu };

/// "relu", "tanh", "silu" (x times its logistic function, also called swish: Ramachandran et al. 2017).
/// Errors: InputError naming the known ones.
Activation activation_named(const std::string& name);
std::string name_of(Activation activation);

/// Weights and biases of y = W x + b. W: (outputs, inputs), row-major so that blocks of outputs are contiguous.
template <class Scalar>
struct DenseLayer {
  using Weights = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  Weights W;
  Vector b;
  [[nodiscard]] Eigen::Index inputs() const { return W.cols(); }
  [[nodiscard]] Eigen::Index outputs() const { return W.rows(); }
};

template <class Scalar>
class Network {
 public:
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  using Layer = DenseLayer<Scalar>;

  /// What a forward pass leaves for the backward pass.
  struct Tape {
    std::vector<Matrix> before;  ///< W x + b of each layer passed, (outputs, samples)
    std::vector<Matrix> after;   ///< input, then the activated output of each layer passed
  };

  /// widths: inputs, hidden..., outputs (at least two numbers). Weights uniform on +-sqrt(6 / (inputs + outputs)) of a
  /// layer, biases zero (Glorot and Bengio 2010), drawn in layer order, row by row.
  Network(const std::vector<int>& widths, Activation hidden, RandomStream& random);
  /// From given layers; the output layer is linear, all before it are activated.
  Network(std::vector<Layer> layers, Activation hidden);

  [[nodiscard]] const std::vector<Layer>& layers() const { return layers_; }
  [[nodiscard]] std::vector<Layer>& layers() { return layers_; }
  [[nodiscard]] Activation activation() const { return activation_; }
  [[nodiscard]] Eigen::Index inputs() const { return layers_.front().inputs(); }
  [[nodiscard]] Eigen::Index outputs() const { return layers_.back().outputs(); }
  [[nodiscard]] std::size_t weights() const;

  /// x: (inputs, samples); result: (outputs, samples).
  [[nodiscard]] Matrix forward(const Matrix& x) const;
  /// The activated output of the last hidden layer, (its width, samples), leaving the tape for `backward_hidden`.
  Matrix hidden(const Matrix& x, Tape& tape) const;
  /// The output layer on `h`, rows [first, first + count) alone.
  void output_rows(const Matrix& h, Eigen::Index first, Eigen::Index count, Eigen::Ref<Matrix> y) const;

  /// dh: derivative of the loss by the last hidden layer's activated output. Fills `gradient` (one entry a hidden layer)
  /// where it is given and returns the derivative by the network's input, (inputs, samples).
  Matrix backward_hidden(const Tape& tape, Matrix dh, std::vector<Layer>* gradient) const;
  /// dy: derivative of the loss by the output, (outputs, samples); as above, with every layer in `gradient`.
  Matrix backward(const Tape& tape, const Matrix& dy, std::vector<Layer>* gradient) const;

 private:
  std::vector<Layer> layers_;
  Activation activation_;
};

extern template class Network<float>;
extern template class Network<double>;

}  // namespace calomel
