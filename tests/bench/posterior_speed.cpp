// Evaluations of the posterior's density with its exact gradient, by the number of compared values: four parameters and the multiple beyond the finest mesh, 60
// runs on two meshes.
#include <benchmark/benchmark.h>

#include <cmath>

#include "forward/emulator/infill.hpp"
#include "inverse/posterior/log_posterior.hpp"
#include "tests/unit/inverse/lines.hpp"

namespace calomel {
namespace {

LogPosterior posterior_of(int values) {
  std::vector<Parameter> parameters;
  for (int k = 0; k < 4; ++k) parameters.push_back(normal_parameter("p" + std::to_string(k), 1, 0.1));
  std::vector<AnalyticModel::Function> sensors;
  for (int s = 0; s < 11; ++s)
    sensors.push_back([s](auto p, double t) { return p[0] * std::sin(6e4 * p[1] * t + s) + p[2] * std::cos(9e4 * t) * std::exp(-1e3 * p[3] * t); });
  const AnalyticModel model(parameters, sensors, 1000, 1e-6);
  const auto recordings = pulses_of(model, {1, 1, 1, 1}, {.pulses = 12, .noise = 0.05}, 1);
  const RecordingOptions recording_options;
  const Problem problem = make_problem(model.shape(), recordings, recording_options);
  const ErrorOptions options{.values = values, .band = 1e6};
  const ErrorModel errors(problem, recordings, recording_options, options, {});
  const EmulatorBox box(parameters, std::vector<double>(4, 0.9), std::vector<double>(4, 1.1));
  const Eigen::MatrixXd u = first_design(4, 45, 1);
  EmulatorRuns runs{.u = Eigen::MatrixXd(4, 60), .level = {}, .levels = 2};
  Eigen::MatrixXd histories(Eigen::Index(model.shape().values()), 60);
  RandomStream random(1, 0);
  for (Eigen::Index i = 0; i < 60; ++i) {
    runs.u.col(i) = u.col(i % 45);
    runs.level.push_back(i < 45 ? 1 : 0);
    const auto p = model.evaluate(box.theta(runs.u.col(i)));
    for (Eigen::Index v = 0; v < histories.rows(); ++v) histories(v, i) = p.mean[std::size_t(v)] * (i < 45 ? 0.97 : 1) + 0.01 * random.normal();
  }
  const Eigen::MatrixXd outputs = errors.grid().apply(histories);
  const MultilevelRegression e(runs, outputs, Eigen::VectorXd::Ones(outputs.rows()));
  std::vector<Prior> priors;
  for (const auto& p : parameters) priors.emplace_back(p);
  return {box, e, e.fit(outputs), {{errors}}, numerical_noise(errors.grid(), e.residuals(outputs), e.freedom(), 25e-6), priors, {}};
}

void density_with_gradient(benchmark::State& state) {
  const LogPosterior posterior = posterior_of(int(state.range(0)));
  Eigen::VectorXd q = Eigen::VectorXd::Zero(posterior.dimension()), gradient;
  for (auto _ : state) {
    q[0] += 1e-6;
    benchmark::DoNotOptimize(posterior.log_density(q, &gradient));
  }
  state.counters["values"] = double(posterior.values());
  state.counters["evaluations/s"] = benchmark::Counter(double(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(density_with_gradient)->Arg(200)->Arg(400)->Arg(800);

}  // namespace
}  // namespace calomel
