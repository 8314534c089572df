#include "forward/surrogate/modes.hpp"

#include "base/errors.hpp"
#include "base/linear_algebra.hpp"
#include "base/parallel.hpp"
#include "forward/surrogate/stored_array.hpp"

namespace calomel {

ModeBasis::ModeBasis(const Eigen::MatrixXf& histories, std::size_t series, const ModeOptions& options) {
  const Eigen::Index n = histories.cols(), values = histories.rows();
  expect(n >= 2, "modes are found from at least two runs");
  expect(series > 0 && values % Eigen::Index(series) == 0, "a history is a whole number of series");
  const Eigen::MatrixXd all = histories.cast<double>();
  const Eigen::VectorXd mean = all.rowwise().mean();
  Eigen::MatrixXd centred = all.colwise() - mean;
  mean_ = mean.cast<float>();
  scale_ = Eigen::VectorXf::Ones(values);
  if (options.per_sensor_scaling) {
    const Eigen::Index times = values / Eigen::Index(series);
    for (Eigen::Index s = 0; s < Eigen::Index(series); ++s) {
      const double rms = std::sqrt(centred.middleRows(s * times, times).squaredNorm() / double(times * n));
      if (rms > 0) scale_.segment(s * times, times).setConstant(float(rms));
    }
    centred.array().colwise() /= scale_.cast<double>().array();
  }
  const SingularValues svd = singular_values(centred);
  const Eigen::VectorXd& s = svd.values;
  const double total = s.squaredNorm();
  Eigen::Index kept = 0;
  double carried = 0;
  // Modes below 1e-6 of the first are rounding of the single-precision histories.
  while (kept < s.size() && kept < options.most && kept < n - 1 && carried < options.energy * total && s[kept] > 1e-6 * s[0]) {
    carried += s[kept] * s[kept];
    ++kept;
  }
  energy_ = total > 0 ? carried / total : 1;
  vectors_ = svd.left.leftCols(kept).cast<float>();
  deviation_ = s.head(kept) / std::sqrt(double(n));
  const Eigen::MatrixXd missed = svd.left.rightCols(s.size() - kept) * s.tail(s.size() - kept).asDiagonal();
  discarded_ = (missed.rowwise().squaredNorm().array() / double(n) * scale_.cast<double>().array().square()).cast<float>();
  make_map();
}

void ModeBasis::make_map() { map_ = scale_.asDiagonal() * vectors_ * deviation_.cast<float>().asDiagonal(); }

Eigen::MatrixXd ModeBasis::whitened(const Eigen::MatrixXf& histories) const {
  const Eigen::MatrixXf centred = ((histories.colwise() - mean_).array().colwise() / scale_.array()).matrix();
  return deviation_.cwiseInverse().asDiagonal() * (vectors_.transpose() * centred).cast<double>();
}

Eigen::MatrixXf ModeBasis::histories(const Eigen::MatrixXd& whitened, int threads) const {
  const Eigen::MatrixXf z = whitened.cast<float>();
  Eigen::MatrixXf y(values(), z.cols());
  constexpr Eigen::Index rows = 1024;
  parallel_for(std::size_t((values() + rows - 1) / rows), threads, [&](std::size_t block) {
    const Eigen::Index first = Eigen::Index(block) * rows, count = std::min(rows, values() - first);
    auto part = y.middleRows(first, count);
    part.noalias() = map_.middleRows(first, count) * z;
    part.colwise() += mean_.segment(first, count);
  });
  return y;
}

Eigen::VectorXd ModeBasis::vector_jacobian_product(const Eigen::VectorXd& weights) const {
  Eigen::VectorXd g = Eigen::VectorXd::Zero(modes());
  for (Eigen::Index i = 0; i < weights.size(); ++i) g += weights[i] * map_.row(i).transpose().cast<double>();
  return g;
}

Eigen::VectorXd ModeBasis::variance(const Eigen::VectorXd& of_whitened) const {
  return map_.cast<double>().cwiseAbs2() * of_whitened + discarded_.cast<double>();
}

void ModeBasis::save(NetcdfWriter& file, const std::string& prefix) const {
  store(file, prefix + "mode_mean", Eigen::MatrixXf(mean_), {{"long_name", "mean over the training runs"}});
  store(file, prefix + "mode_scale", Eigen::MatrixXf(scale_));
  store(file, prefix + "mode_discarded_variance", Eigen::MatrixXf(discarded_));
  store(file, prefix + "mode_vectors", vectors_, {{"long_name", "proper orthogonal modes in columns"}});
  store(file, prefix + "mode_deviation", Eigen::MatrixXd(deviation_), {{"long_name", "standard deviation of the coefficients"}});
  store(file, prefix + "mode_energy", Eigen::MatrixXd(Eigen::MatrixXd::Constant(1, 1, energy_)));
}

ModeBasis ModeBasis::load(const NetcdfReader& file, const std::string& prefix) {
  ModeBasis b;
  b.mean_ = stored_matrix<float>(file, prefix + "mode_mean");
  b.scale_ = stored_matrix<float>(file, prefix + "mode_scale");
  b.discarded_ = stored_matrix<float>(file, prefix + "mode_discarded_variance");
  b.vectors_ = stored_matrix<float>(file, prefix + "mode_vectors");
  b.deviation_ = stored_matrix<double>(file, prefix + "mode_deviation");
  b.energy_ = file.doubles(prefix + "mode_energy")[0];
  b.make_map();
  return b;
}

}  // namespace calomel
