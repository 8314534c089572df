#include <algorithm>
#include <cmath>
#include <limits>

#include "inverse/objective/score_sums.hpp"

namespace calomel {

namespace {

/// One pass over the samples. Lanes that do not count have weight 0 and the empty band (0, 0).
ScoreSums sum_up(const float* __restrict y, const Observation& o, std::size_t n) {
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

ObservedSize size_of(const Observation& o) {
  ObservedSize size{double(o.samples), double(o.banded_samples), 0};
  for (std::size_t t = 0; t < o.mean.size(); ++t)
    if (o.compared[t]) size.norm += o.mean[t] * o.mean[t];
  return size;
}

BatchScoreSum::BatchScoreSum(std::size_t columns, double mae_scale) : mae_scale_(mae_scale) {
  for (auto* v : {&score_.accuracy, &score_.mae, &score_.nrmse, &score_.delta1, &score_.delta2}) v->assign(columns, 0.0);
}

void BatchScoreSum::add(const ObservedSize& size, std::span<const ScoreSums> sums) {
  ++observations_;
  with_band_ += size.banded > 0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const ScoreSums& s = sums[i];
    if (size.banded > 0) score_.accuracy[i] += 100.0 * double(s.inside) / size.banded;
    score_.mae[i] += mae_scale_ * double(s.absolute) / size.samples;
    score_.delta1[i] += std::sqrt(double(s.squares) / size.norm);
    score_.delta2[i] += double(s.over) + double(s.under);
  }
}

BatchScore BatchScoreSum::averages() && {
  BatchScore& out = score_;
  for (std::size_t i = 0; i < out.mae.size(); ++i) {
    if (with_band_ > 0) out.accuracy[i] /= double(with_band_);
    out.mae[i] /= double(observations_);
    out.nrmse[i] = out.delta1[i] / double(observations_);
    if (!std::isfinite(out.mae[i])) out.accuracy[i] = out.mae[i] = out.nrmse[i] = out.delta1[i] = out.delta2[i] = std::numeric_limits<double>::quiet_NaN();
  }
  return std::move(score_);
}

BatchScore score_batch(const Problem& problem, const Eigen::MatrixXf& values) {
  expect(std::size_t(values.rows()) == problem.shape.values(), "a score is of a model's whole output");
  const std::size_t n = std::size_t(values.cols()), samples = problem.time.size();
  BatchScoreSum out(n, problem.mae_scale);
  std::vector<float> buffer(problem.same_grid ? 0 : samples);
  std::vector<ScoreSums> sums(n);
  for (const auto& o : problem.observations) {  // the bands of one sensor remain in the cache for all columns
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
      sums[i] = sum_up(y, o, samples);
    }
    out.add(size_of(o), sums);
  }
  return std::move(out).averages();
}

}  // namespace calomel
