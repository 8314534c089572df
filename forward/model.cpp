#include "forward/model.hpp"

#include <limits>
#include <mutex>

#include "base/parallel.hpp"

namespace calomel {

std::vector<Prediction> ForwardModel::predictions(const Eigen::MatrixXd& thetas, int threads, const Predicted& predicted) const {
  std::vector<Prediction> out(std::size_t(thetas.cols()));
  std::mutex one;
  std::size_t done = 0;
  parallel_for(out.size(), threads, [&](std::size_t i) {
    out[i] = evaluate({thetas.col(Eigen::Index(i)).data(), std::size_t(thetas.rows())});
    const std::lock_guard guard(one);
    ++done;
    if (predicted) predicted(done, out.size());
  });
  return out;
}

Eigen::MatrixXf ForwardModel::means(const Eigen::MatrixXd& thetas, int threads) const {
  Eigen::MatrixXf out(Eigen::Index(shape().values()), thetas.cols());
  parallel_for(std::size_t(thetas.cols()), threads, [&](std::size_t i) {
    const Eigen::Index column(i);
    const Prediction p = evaluate({thetas.col(column).data(), std::size_t(thetas.rows())});
    if (p.ok)
      for (Eigen::Index k = 0; k < out.rows(); ++k) out(k, column) = float(p.mean[std::size_t(k)]);
    else
      out.col(column).setConstant(std::numeric_limits<float>::quiet_NaN());
  });
  return out;
}

HistoryBasis HistoryBasis::with(const Eigen::MatrixXd& more) const {
  HistoryBasis b{offset, Eigen::MatrixXf(directions.rows(), directions.cols() + more.cols())};
  b.directions << directions, more.cast<float>();
  return b;
}

Eigen::MatrixXf ForwardModel::coefficients(const Eigen::MatrixXd&) const {
  expect(false, "coefficients are only asked of a model with a basis");
  return {};
}

Eigen::VectorXd ForwardModel::vector_jacobian_product(std::span<const double>, std::span<const double>) const {
  expect(false, "vector_jacobian_product is only called where has_gradient() is true");
  return {};
}

std::vector<double> nominal(const ModelShape& shape) {
  std::vector<double> theta;
  for (const auto& p : shape.parameters) {
    expect(p.nominal.has_value(), "a model's shape carries every nominal value");
    theta.push_back(*p.nominal);
  }
  return theta;
}

}  // namespace calomel
