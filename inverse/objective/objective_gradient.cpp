#include "inverse/objective/objective_gradient.hpp"

#include <array>
#include <cmath>

namespace calomel {

namespace {

enum Average { accuracy, mae, nrmse, delta1, delta2, averages };
using Averages = std::array<double, averages>;

double formula_of(const Objective& objective, const Averages& a) { return objective.formula(a[accuracy], a[mae], a[nrmse], a[delta1], a[delta2]); }

/// d formula / d averages by central differences; exact for the linear formulas of the catalogue but for rounding.
Averages gradient_of(const Objective& objective, const Averages& at) {
  Averages gradient{};
  for (std::size_t k = 0; k < averages; ++k) {
    const double h = 1e-3 * std::max(1.0, std::abs(at[k]));
    Averages up = at, down = at;
    up[k] += h;
    down[k] -= h;
    gradient[k] = (formula_of(objective, up) - formula_of(objective, down)) / (2 * h);
  }
  return gradient;
}

double logistic(double z) { return z > 0 ? 1 / (1 + std::exp(-z)) : std::exp(z) / (1 + std::exp(z)); }

/// The contribution of one observation to the averages, and the gradient of each with respect to the history on the record times.
struct Part {
  Averages value{};
  std::array<std::vector<double>, averages> gradient;
};

Part part_of(const Problem& problem, const Observation& o, const std::vector<double>& y, double width) {
  Part p;
  for (auto& s : p.gradient) s.assign(y.size(), 0.0);
  double norm = 0, squares = 0, over = 0, under = 0;
  std::size_t over_at = y.size(), under_at = y.size();
  for (std::size_t t = 0; t < y.size(); ++t) {
    if (!o.compared[t]) continue;
    const double d = y[t] - o.mean[t];
    norm += o.mean[t] * o.mean[t];
    squares += d * d;
    p.value[mae] += problem.mae_scale * std::abs(d) / double(o.samples);
    p.gradient[mae][t] = problem.mae_scale * (d > 0 ? 1 : d < 0 ? -1 : 0) / double(o.samples);
    if (!o.banded[t]) continue;
    const double band = o.high[t] - o.low[t], h = width * band;
    const double a = logistic((y[t] - o.low[t]) / h), b = logistic((o.high[t] - y[t]) / h);
    p.value[accuracy] += 100 * a * b / double(o.banded_samples);
    p.gradient[accuracy][t] = 100 * a * b * (b - a) / h / double(o.banded_samples);
    if (const double e = (y[t] - o.high[t]) / band; e > over) over = e, over_at = t;
    if (const double e = (o.low[t] - y[t]) / band; e > under) under = e, under_at = t;
  }
  const double rrmse = std::sqrt(squares / norm);
  p.value[delta1] = rrmse;
  p.value[delta2] = over + under;
  for (std::size_t t = 0; t < y.size(); ++t)
    if (o.compared[t] && squares > 0) p.gradient[delta1][t] = (y[t] - o.mean[t]) / std::sqrt(squares * norm);
  if (over_at < y.size()) p.gradient[delta2][over_at] += 1 / (o.high[over_at] - o.low[over_at]);
  if (under_at < y.size()) p.gradient[delta2][under_at] -= 1 / (o.high[under_at] - o.low[under_at]);
  return p;
}

/// Adds the gradient with respect to the model's values, from that with respect to the history on the record times.
void add_model_gradient(const Problem& problem, const Observation& o, const std::vector<double>& by_record, std::vector<double>& weights) {
  const std::size_t base = problem.shape.at(o.condition, o.sensor, 0);
  for (std::size_t t = 0; t < by_record.size(); ++t) {
    if (by_record[t] == 0) continue;
    if (problem.same_grid) {
      weights[base + problem.first + t] += by_record[t];
      continue;
    }
    const auto& s = problem.stencils[t];
    for (std::size_t j = 0; j < 4; ++j)
      if (s.weight[j] != 0) weights[base + s.index[j]] += s.weight[j] * by_record[t];
  }
}

}  // namespace

ObjectiveGradient objective_gradient(const Problem& problem, const Objective& objective, std::span<const double> values, double width) {
  ObjectiveGradient out;
  const double sign = objective.maximise ? -1 : 1;
  std::vector<Part> parts;
  Averages total{};
  double banded = 0;
  for (const auto& o : problem.observations) {
    parts.push_back(
        part_of(problem, o, on_record_times(problem, values.subspan(problem.shape.at(o.condition, o.sensor, 0), problem.shape.times.size())), width));
    for (std::size_t k = 0; k < averages; ++k) total[k] += parts.back().value[k];
    banded += o.banded_samples > 0;
  }
  const double count = double(problem.observations.size());
  const Averages share{banded > 0 ? 1 / banded : 0, 1 / count, 1 / count, 1, 1};
  total[nrmse] = total[delta1];
  for (std::size_t k = 0; k < averages; ++k) total[k] *= share[k];
  const Averages by = gradient_of(objective, total);
  out.cost = objective.cost(formula_of(objective, total));
  out.weights.assign(values.size(), 0.0);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    auto& p = parts[i];
    std::vector<double> sum(p.gradient[mae].size());
    for (std::size_t t = 0; t < sum.size(); ++t)
      sum[t] = sign * (by[accuracy] * share[accuracy] * p.gradient[accuracy][t] + by[mae] * share[mae] * p.gradient[mae][t] +
                       (by[nrmse] * share[nrmse] + by[delta1]) * p.gradient[delta1][t] + by[delta2] * p.gradient[delta2][t]);
    add_model_gradient(problem, problem.observations[i], sum, out.weights);
  }
  return out;
}

}  // namespace calomel
