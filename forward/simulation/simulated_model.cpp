#include "forward/simulation/simulated_model.hpp"

#include <limits>

namespace calomel {

Prediction SimulatedModel::evaluate(std::span<const double> theta) const {
  const RunRequest request = request_at(shape().parameters, theta);
  if (!kept_) return runs_.evaluate(request);
  return runs_.get({&request, 1})[0].prediction();
}

std::vector<RunRecord> SimulatedModel::records(const Eigen::MatrixXd& thetas, const Runs::Progress& progress) const {
  std::vector<RunRequest> requests;
  for (Eigen::Index i = 0; i < thetas.cols(); ++i) requests.push_back(request_at(shape().parameters, {thetas.col(i).data(), std::size_t(thetas.rows())}));
  return runs_.get(requests, progress);
}

std::vector<Prediction> SimulatedModel::predictions(const Eigen::MatrixXd& thetas, int threads, const Predicted& predicted) const {
  if (!kept_) return ForwardModel::predictions(thetas, threads, predicted);
  const auto all = records(thetas, [&](std::size_t done, std::size_t total) {
    if (predicted && done > 0) predicted(done, total);
    if (progress_) progress_(done, total);
  });
  std::vector<Prediction> out;
  for (const auto& r : all) out.push_back(r.prediction());
  return out;
}

Eigen::MatrixXf SimulatedModel::means(const Eigen::MatrixXd& thetas, int threads) const {
  if (!kept_) return ForwardModel::means(thetas, threads);
  Eigen::MatrixXf out = Eigen::MatrixXf::Constant(Eigen::Index(shape().values()), thetas.cols(), std::numeric_limits<float>::quiet_NaN());
  const auto all = records(thetas, progress_);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].done) out.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXf>(all[i].mean.data(), out.rows());
  return out;
}

}  // namespace calomel
