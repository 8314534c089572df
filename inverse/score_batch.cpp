#include <algorithm>
#include <cmath>
#include <limits>

#include "inverse/problem.hpp"

namespace calomel {

namespace {

/// Sums of one sensor's samples for one column.
struct Sums {
  float absolute = 0, squares = 0, inside = 0, over = 0, under = 0;
};

/// One pass over the samples. Lanes that do not count have weight 0 and the empty band (0, 0).
Sums sum_up(const float* __restrict y, const Observation& o, std::size_t n) {
  const float* __restrict mean = o.mean_f.data();
  const float* __restrict weight = o.weight_f.data();
  const float* __restrict low = o.low_f.data();
  const float* __restrict high = o.high_f.data();
  const float* __restrict inverse_width = o.inverse_width_f.data();
  float absolute = 0, squares = 0, inside = 0, over = 0, under = 0;
#pragma omp simd reduction(+ : absolute, squares, inside) reduction(max : over, under)
  for (std::size_t t = 0; t < n; ++t) {
    const float d = weight[t] * (y[t] - mean[t]);
    absolute += std::abs(d);
    squares += d * d;
    const float above_low = y[t] > low[t] ? 1.0f : 0.0f;
    const float below_high = y[t] < high[t] ? 1.0f : 0.0f;
    inside += above_low * below_high;
    const float a = (y[t] - high[t]) * inverse_width[t], b = (low[t] - y[t]) * inverse_width[t];
    over = a > over ? a : over;
    under = b > under ? b : under;
  }
  return {absolute, squares, inside, over, under};
}

}  // namespace

BatchScore score_batch(const Problem& problem, const Eigen::MatrixXf& values) {
  expect(std::size_t(values.rows()) == problem.shape.values(), "a score is of a model's whole output");
  const std::size_t n = std::size_t(values.cols()), samples = problem.time.size();
  BatchScore out;
  for (auto* v : {&out.accuracy, &out.mae, &out.nrmse, &out.delta1, &out.delta2}) v->assign(n, 0.0);
  std::vector<float> buffer(problem.same_grid ? 0 : samples);
  std::size_t with_band = 0;
  for (const auto& o : problem.observations) {  // the bands of one sensor stay in the cache for all columns
    double norm = 0;
    for (std::size_t t = 0; t < samples; ++t)
      if (o.compared[t]) norm += o.mean[t] * o.mean[t];
    with_band += o.banded_samples > 0;
    for (std::size_t i = 0; i < n; ++i) {
      const float* y = values.col(Eigen::Index(i)).data() + problem.shape.at(o.condition, o.sensor, 0);
      if (problem.same_grid) {
        y += problem.first;
      } else {
        for (std::size_t t = 0; t < samples; ++t) {
          const auto& s = problem.stencils[t];
          float sum = 0;
          for (std::size_t j = 0; j < 4; ++j)
            if (s.weight[j] != 0) sum += float(s.weight[j]) * y[s.index[j]];
          buffer[t] = sum;
        }
        y = buffer.data();
      }
      const Sums s = sum_up(y, o, samples);
      if (o.banded_samples > 0) out.accuracy[i] += 100.0 * double(s.inside) / double(o.banded_samples);
      out.mae[i] += problem.mae_scale * double(s.absolute) / double(o.samples);
      out.delta1[i] += std::sqrt(double(s.squares) / norm);
      out.delta2[i] += double(s.over) + double(s.under);
    }
  }
  const double count = double(problem.observations.size());
  for (std::size_t i = 0; i < n; ++i) {
    if (with_band > 0) out.accuracy[i] /= double(with_band);
    out.mae[i] /= count;
    out.nrmse[i] = out.delta1[i] / count;
    if (!std::isfinite(out.mae[i])) out.accuracy[i] = out.mae[i] = out.nrmse[i] = out.delta1[i] = out.delta2[i] = std::numeric_limits<double>::quiet_NaN();
  }
  return out;
}

}  // namespace calomel
