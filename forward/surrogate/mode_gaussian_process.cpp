#include "forward/surrogate/mode_gaussian_process.hpp"

#include <algorithm>
#include <optional>

#include "base/parallel.hpp"
#include "forward/surrogate/stored_array.hpp"

namespace calomel {

std::unique_ptr<TrainedMap> ModeGaussianProcess::train(const TrainingSet& set, const SurrogateOptions& options, std::uint64_t, int threads,
                                                       TrainingRecord& record) {
  InputScaling inputs(set.parameters, Coordinates::log, 0, 1);
  ModeBasis basis(set.histories, set.series, options.modes);
  record.modes = int(basis.modes());
  record.mode_energy = basis.energy();
  const Eigen::MatrixXd x = inputs.features(set.theta), z = basis.whitened(set.histories);
  // Two starts, long and short length scales; a mode does not know of its neighbours, so threads do not matter.
  Eigen::VectorXd kappa0(x.rows());
  for (Eigen::Index f = 0; f < x.rows(); ++f) kappa0[f] = -inputs.log_ratio(f) / 2;
  std::vector<std::optional<GaussianProcess>> fitted{std::size_t(basis.modes())};
  parallel_for(fitted.size(), threads, [&](std::size_t k) {
    const Eigen::VectorXd zk = z.row(Eigen::Index(k));
    GaussianProcessHyperparameters best;
    double least = std::numeric_limits<double>::infinity();
    for (const double length : {1.0, 0.3}) {
      const GaussianProcessHyperparameters start{Eigen::VectorXd::Constant(x.rows(), std::log(length)), kappa0, -6};
      auto h = fit_hyperparameters(x, zk, kappa0, start, options.gaussian_process.iterations);
      const double cost = negative_log_posterior(x, zk, kappa0, h.packed(), nullptr);
      if (cost < least) {
        least = cost;
        best = std::move(h);
      }
    }
    if (best.kappa.size() == 0) throw NumericsError("surrogate: no Gaussian process could be fitted to mode " + std::to_string(k + 1));
    fitted[k].emplace(x, zk, std::move(best));
  });
  std::vector<GaussianProcess> processes;
  for (auto& p : fitted) processes.push_back(std::move(*p));
  return std::unique_ptr<TrainedMap>(new ModeGaussianProcess(std::move(inputs), std::move(basis), x, z, std::move(processes)));
}

Eigen::MatrixXd ModeGaussianProcess::whitened(const Eigen::MatrixXd& thetas, int threads) const {
  const Eigen::MatrixXd x = inputs_.features(thetas);
  Eigen::MatrixXd z(basis_.modes(), x.cols());
  parallel_for(processes_.size(), threads, [&](std::size_t k) { z.row(Eigen::Index(k)) = processes_[k].means(x).transpose(); });
  return z;
}

Eigen::MatrixXf ModeGaussianProcess::histories(const Eigen::MatrixXd& thetas, int threads) const {
  return basis_.histories(whitened(thetas, threads), threads);
}

HistoryBasis ModeGaussianProcess::basis() const { return {basis_.mean(), basis_.map()}; }

Eigen::MatrixXf ModeGaussianProcess::coefficients(const Eigen::MatrixXd& thetas) const { return whitened(thetas, 1).cast<float>(); }

Eigen::VectorXd ModeGaussianProcess::vector_jacobian_product(const Eigen::VectorXd& theta, const Eigen::VectorXd& weights) const {
  const Eigen::VectorXd x = inputs_.features(theta).col(0), dz = basis_.vector_jacobian_product(weights);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(x.size());
  for (std::size_t k = 0; k < processes_.size(); ++k) g += dz[Eigen::Index(k)] * processes_[k].gradient(x);
  return inputs_.vector_jacobian_product(theta, g);
}

Eigen::VectorXd ModeGaussianProcess::variance(const Eigen::VectorXd& theta) const {
  const Eigen::VectorXd x = inputs_.features(theta).col(0);
  Eigen::VectorXd v(basis_.modes());
  for (std::size_t k = 0; k < processes_.size(); ++k) v[Eigen::Index(k)] = processes_[k].variance(x);
  return basis_.variance(v);
}

void ModeGaussianProcess::save(NetcdfWriter& file, const std::string& prefix) const {
  inputs_.save(file, prefix);
  basis_.save(file, prefix);
  store(file, prefix + "training_features", x_);
  store(file, prefix + "training_coefficients", z_);
  Eigen::MatrixXd packed(2 * x_.rows() + 1, basis_.modes());
  for (std::size_t k = 0; k < processes_.size(); ++k) packed.col(Eigen::Index(k)) = processes_[k].hyperparameters().packed();
  store(file, prefix + "hyperparameters", packed, {{"long_name", "log lengths, warps, log nugget; a column a mode"}});
}

std::unique_ptr<TrainedMap> ModeGaussianProcess::load(const NetcdfReader& file, const std::string& prefix) {
  const auto x = stored_matrix<double>(file, prefix + "training_features"), z = stored_matrix<double>(file, prefix + "training_coefficients");
  const auto packed = stored_matrix<double>(file, prefix + "hyperparameters");
  std::vector<GaussianProcess> processes;
  for (Eigen::Index k = 0; k < z.rows(); ++k) processes.emplace_back(x, z.row(k).transpose(), GaussianProcessHyperparameters::unpacked(packed.col(k)));
  return std::unique_ptr<TrainedMap>(new ModeGaussianProcess(InputScaling::load(file, prefix), ModeBasis::load(file, prefix), x, z, std::move(processes)));
}

}  // namespace calomel
