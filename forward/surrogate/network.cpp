#include "forward/surrogate/network.hpp"

#include <cmath>

#include "base/errors.hpp"

namespace calomel {
namespace {

const std::vector<std::string> activation_names = {"identity", "relu", "tanh", "silu"};

template <class Matrix>
Matrix activate(Activation kind, const Matrix& z) {
  switch (kind) {
    case Activation::relu:
      return z.cwiseMax(typename Matrix::Scalar(0));
    case Activation::tanh:
      return z.array().tanh().matrix();
    case Activation::silu:
      return (z.array() / (1 + (-z.array()).exp())).matrix();
    case Activation::identity:
      break;
  }
  return z;
}

/// Multiplies `d` by the activation's derivative at z (a = activate(z)).
template <class Matrix>
void times_derivative(Activation kind, const Matrix& z, const Matrix& a, Matrix& d) {
  using Scalar = typename Matrix::Scalar;
  switch (kind) {
    case Activation::relu:
      d = (z.array() > Scalar(0)).select(d, Scalar(0)).eval();
      break;
    case Activation::tanh:
      d.array() *= 1 - a.array().square();
      break;
    case Activation::silu: {
      const auto logistic = (1 / (1 + (-z.array()).exp())).eval();
      d.array() *= logistic * (1 + z.array() * (1 - logistic));
      break;
    }
    case Activation::identity:
      break;
  }
}

}  // namespace

Activation activation_named(const std::string& name) {
  for (std::size_t i = 0; i < activation_names.size(); ++i)
    if (activation_names[i] == name) return Activation(i);
  throw InputError({.problem = "no activation of this name",
                    .key = "activation",
                    .value = '"' + name + '"',
                    .range = join(activation_names),
                    .suggestion = name_suggestion(name, activation_names)});
}

std::string name_of(Activation activation) { return activation_names[std::size_t(activation)]; }

template <class Scalar>
Network<Scalar>::Network(const std::vector<int>& widths, Activation hidden, RandomStream& random) : activation_(hidden) {
  expect(widths.size() >= 2, "a network has at least an input and an output width");
  for (std::size_t l = 1; l < widths.size(); ++l) {
    Layer layer{typename Layer::Weights(widths[l], widths[l - 1]), Layer::Vector::Zero(widths[l])};
    const double bound = std::sqrt(6.0 / (widths[l] + widths[l - 1]));
    for (Eigen::Index i = 0; i < layer.W.size(); ++i) layer.W.data()[i] = Scalar(random.uniform(-bound, bound));
    layers_.push_back(std::move(layer));
  }
}

template <class Scalar>
Network<Scalar>::Network(std::vector<Layer> layers, Activation hidden) : layers_(std::move(layers)), activation_(hidden) {
  expect(!layers_.empty(), "a network has at least one layer");
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    expect(layers_[l].b.size() == layers_[l].outputs(), "a layer has as many biases as outputs");
    if (l > 0) expect(layers_[l].inputs() == layers_[l - 1].outputs(), "neighbouring layers of a network fit");
  }
}

template <class Scalar>
std::size_t Network<Scalar>::weights() const {
  std::size_t n = 0;
  for (const auto& l : layers_) n += std::size_t(l.W.size() + l.b.size());
  return n;
}

template <class Scalar>
typename Network<Scalar>::Matrix Network<Scalar>::forward(const Matrix& x) const {
  Matrix h = x;
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    Matrix z = layers_[l].b.replicate(1, h.cols());
    z.noalias() += layers_[l].W * h;
    h = l + 1 < layers_.size() ? activate(activation_, z) : std::move(z);
  }
  return h;
}

template <class Scalar>
typename Network<Scalar>::Matrix Network<Scalar>::hidden(const Matrix& x, Tape& tape) const {
  tape.before.clear();
  tape.after.assign(1, x);
  for (std::size_t l = 0; l + 1 < layers_.size(); ++l) {
    Matrix z = layers_[l].b.replicate(1, x.cols());
    z.noalias() += layers_[l].W * tape.after.back();
    tape.after.push_back(activate(activation_, z));
    tape.before.push_back(std::move(z));
  }
  return tape.after.back();
}

template <class Scalar>
void Network<Scalar>::output_rows(const Matrix& h, Eigen::Index first, Eigen::Index count, Eigen::Ref<Matrix> y) const {
  const Layer& last = layers_.back();
  y = last.b.segment(first, count).replicate(1, h.cols());
  y.noalias() += last.W.middleRows(first, count) * h;
}

template <class Scalar>
typename Network<Scalar>::Matrix Network<Scalar>::backward_hidden(const Tape& tape, Matrix dh, std::vector<Layer>* gradient) const {
  const std::size_t hidden_layers = layers_.size() - 1;
  if (gradient) gradient->resize(std::max(gradient->size(), hidden_layers));
  for (std::size_t l = hidden_layers; l-- > 0;) {
    times_derivative(activation_, tape.before[l], tape.after[l + 1], dh);
    if (gradient) {
      (*gradient)[l].W.noalias() = dh * tape.after[l].transpose();
      (*gradient)[l].b = dh.rowwise().sum();
    }
    Matrix dx(layers_[l].inputs(), dh.cols());
    dx.noalias() = layers_[l].W.transpose() * dh;
    dh = std::move(dx);
  }
  return dh;
}

template <class Scalar>
typename Network<Scalar>::Matrix Network<Scalar>::backward(const Tape& tape, const Matrix& dy, std::vector<Layer>* gradient) const {
  const Layer& last = layers_.back();
  if (gradient) {
    gradient->resize(layers_.size());
    gradient->back().W.noalias() = dy * tape.after.back().transpose();
    gradient->back().b = dy.rowwise().sum();
  }
  Matrix dh(last.inputs(), dy.cols());
  dh.noalias() = last.W.transpose() * dy;
  return backward_hidden(tape, std::move(dh), gradient);
}

template class Network<float>;
template class Network<double>;

}  // namespace calomel
