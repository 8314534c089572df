// What runs that are added near the optimum save against a design drawn at once.
//
//   bench_adaptive_design prefix CASE.toml FROM_DIR TO_DIR [--set KEY=VALUE]...
//     The first campaign.runs points of the finished campaign in FROM_DIR as the journal of a campaign in TO_DIR, which `calomel campaign` with the same
//     settings then finishes without a run: the points of the Sobol' and Chebyshev designs are a sequence. Both with campaign.keep_pulses=false.
//
//   bench_adaptive_design errors CASE.toml REFERENCE_DIR TEST_DIR OUT_DIR... [--set KEY=VALUE]...
//     Errors of the surrogates in each OUT_DIR, with the added runs kriged onto them where map.json tells of some, at points that none of them has seen: 40
//     spread over the bounds and 24 about the optimum in REFERENCE_DIR, in the ellipsoid where chi-squared is less than 20 above its least by its map.json.
//     Their true runs are kept in TEST_DIR. Prints Markdown.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "apps/study_case.hpp"
#include "base/artefact.hpp"
#include "base/netcdf_file.hpp"
#include "base/parallel.hpp"
#include "base/provenance.hpp"
#include "base/random.hpp"
#include "forward/built_in_model.hpp"
#include "forward/campaign/added_runs.hpp"
#include "forward/campaign/design.hpp"
#include "forward/campaign/repeatability_floor.hpp"
#include "forward/surrogate/surrogate.hpp"
#include "forward/surrogate/training.hpp"
#include "inverse/refined_model.hpp"

using namespace calomel;
using std::filesystem::path;

namespace {

constexpr std::size_t wide_points = 40, local_points = 24;
constexpr double far_enough = 20;  ///< of chi-squared above its least: the region that matters
constexpr double silent = 0.02;    ///< windows whose signal is less than this share of the gauge's greatest are left out

struct Words {
  std::vector<std::string> plain, overrides;
};

Words words_of(int argc, char** argv) {
  Words w;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "--set" && i + 1 < argc)
      w.overrides.emplace_back(argv[++i]);
    else
      w.plain.emplace_back(argv[i]);
  }
  return w;
}

void prefix(const Words& w) {
  const auto study = StudyCase::read(w.plain.at(1), w.overrides);
  const path from = w.plain.at(2), to = w.plain.at(3);
  const auto archive = read_archive(from / "campaign.nc");
  Json options = study.model_options();
  options["campaign"] = identity_options(study.campaign);
  const Provenance provenance{.stage = "campaign", .options = std::move(options), .seed = read_json(from / "campaign.json").at("provenance").at("seed"), .inputs = study.model_inputs()};
  make_directory(to);
  Journal journal(to / "campaign.journal", provenance);
  const auto column = [](const Eigen::MatrixXf& m, std::size_t i) {
    return m.size() == 0 ? std::vector<float>() : std::vector<float>(m.col(Eigen::Index(i)).begin(), m.col(Eigen::Index(i)).end());
  };
  for (std::size_t i = 0; i < std::size_t(study.campaign.runs); ++i) {
    if (journal.contains(i)) continue;
    RunRecord record{.done = archive.status.at(i) == RunStatus::done, .message = archive.message.at(i)};
    if (record.done) record.mean = column(archive.mean, i), record.energy_slope = column(archive.energy_slope, i), record.scatter = column(archive.scatter, i);
    journal.append(i, record);
  }
}

/// map.json as far as it is needed here.
struct Fit {
  Eigen::VectorXd theta;
  Eigen::MatrixXd covariance;
  int added = 0, pairs = 0, model_runs = 0;
};

Fit read_fit(const path& directory, const std::vector<Parameter>& parameters) {
  const Json j = read_json(directory / "map.json");
  const auto n = Eigen::Index(parameters.size());
  Fit f{Eigen::VectorXd(n), Eigen::MatrixXd(n, n), 0, 0, j.at("model_runs")};
  for (Eigen::Index a = 0; a < n; ++a) {
    f.theta[a] = j.at("theta").at(parameters[std::size_t(a)].name);
    for (Eigen::Index b = 0; b < n; ++b) f.covariance(a, b) = j.at("covariance").at(std::size_t(a)).at(std::size_t(b));
  }
  if (j.contains("added_runs") && !j.at("added_runs").at("rounds").empty()) {
    const Json& last = j.at("added_runs").at("rounds").back();
    f.added = last.at("runs"), f.pairs = last.at("pairs");
  }
  return f;
}

/// Points uniform over the bounds, then points uniform in the ellipsoid about the reference (those beyond the bounds are drawn anew). (n_parameters, all)
Eigen::MatrixXd test_points(const std::vector<Parameter>& parameters, const Fit& reference) {
  const auto n = Eigen::Index(parameters.size());
  Eigen::VectorXd low(n), high(n);
  for (Eigen::Index k = 0; k < n; ++k) low[k] = parameters[std::size_t(k)].min, high[k] = parameters[std::size_t(k)].max;
  Eigen::MatrixXd points(n, Eigen::Index(wide_points + local_points));
  const Eigen::MatrixXd units = sobol_points(std::size_t(n), wide_points, 77);
  for (Eigen::Index i = 0; i < units.cols(); ++i) points.col(i) = low + units.col(i).cwiseProduct(high - low);
  const Eigen::MatrixXd root = reference.covariance.llt().matrixL();
  RandomStream random(77, 1);
  for (auto i = Eigen::Index(wide_points); i < points.cols();) {
    Eigen::VectorXd z = Eigen::VectorXd::NullaryExpr(n, [&] { return random.normal(); });
    z *= std::sqrt(far_enough) * std::pow(random.uniform(), 1 / double(n)) / z.norm();
    points.col(i) = reference.theta + root * z;
    if ((points.col(i).array() >= low.array()).all() && (points.col(i).array() <= high.array()).all()) ++i;
  }
  return points;
}

/// True runs at the points; those that failed are left out of both. The first `wide` columns are the wide ones that came through.
struct Truth {
  Eigen::MatrixXd theta;
  Eigen::MatrixXf values;
  Eigen::Index wide = 0;
};

Truth true_runs(const StudyCase& study, const BuiltInModel& model, const Eigen::MatrixXd& points, const path& directory) {
  make_directory(directory);
  Json options = study.model_options();
  options["campaign"] = {{"pulses", study.campaign.pulses}, {"pulse_energy_sd", study.campaign.pulse_energy_sd}};
  AddedRuns runs(model, nullptr, {.stage = "test_runs", .options = std::move(options), .seed = 77, .inputs = study.model_inputs()}, directory);
  const auto all = runs.run(points, std::vector<bool>(std::size_t(points.cols()), false), default_threads());
  Truth t{Eigen::MatrixXd(points.rows(), points.cols()), Eigen::MatrixXf(Eigen::Index(model.shape().values()), points.cols())};
  Eigen::Index n = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i].done()) continue;
    t.theta.col(n) = points.col(Eigen::Index(i));
    t.values.col(n++) = Eigen::Map<const Eigen::VectorXf>(all[i].working.mean.data(), t.values.rows());
    if (i < wide_points) t.wide = n;
  }
  t.theta.conservativeResize(Eigen::NoChange, n), t.values.conservativeResize(Eigen::NoChange, n);
  return t;
}

/// |error| / |true| of each column, their median.
double median_relative(const Eigen::MatrixXf& predicted, const Eigen::MatrixXf& actual) {
  std::vector<double> e;
  for (Eigen::Index i = 0; i < actual.cols(); ++i) e.push_back(double((predicted.col(i) - actual.col(i)).norm() / actual.col(i).norm()));
  std::nth_element(e.begin(), e.begin() + std::ptrdiff_t(e.size() / 2), e.end());
  return e[e.size() / 2];
}

/// Root mean square error over the runs of each gauge and window of the floor, over the floor there; windows without a signal left out. Ascending.
std::vector<double> over_the_floor(const Eigen::MatrixXf& predicted, const Eigen::MatrixXf& actual, const RepeatabilityFloor& floor, const ModelShape& shape) {
  std::vector<double> ratios;
  const std::size_t windows = floor.window_begin.size();
  for (std::size_t s = 0; s < shape.sensors.size() * shape.conditions.size(); ++s) {
    const double* signal = floor.signal.data() + s * windows;
    const double greatest = *std::max_element(signal, signal + windows);
    for (std::size_t w = 0; w < windows; ++w) {
      if (signal[w] < silent * greatest) continue;
      double squares = 0;
      std::size_t count = 0;
      for (std::size_t t = 0; t < shape.times.size(); ++t)
        if (shape.times[t] >= floor.window_begin[w] && shape.times[t] < floor.window_end[w]) {
          const auto row = Eigen::Index(s * shape.times.size() + t);
          squares += double((predicted.row(row) - actual.row(row)).squaredNorm()), count += std::size_t(actual.cols());
        }
      ratios.push_back(std::sqrt(squares / double(count)) / floor.sd[s * windows + w]);
    }
  }
  std::sort(ratios.begin(), ratios.end());
  return ratios;
}

/// Runs of added_runs.nc on the case's own mesh, as columns: parameters, then values.
std::pair<Eigen::MatrixXd, Eigen::MatrixXd> added_values(const path& directory, int count) {
  const NetcdfReader file(directory / "added_runs.nc");
  const auto theta = file.doubles("theta"), strain = file.doubles("strain");
  const auto status = file.integers("status");
  const std::size_t n = status.size();
  expect(n >= std::size_t(count), "added_runs.nc holds the runs that map.json tells of");
  const Eigen::Map<const Eigen::MatrixXd> points(theta.data(), Eigen::Index(theta.size() / n), Eigen::Index(n)), values(strain.data(), Eigen::Index(strain.size() / n), Eigen::Index(n));
  std::vector<Eigen::Index> done;
  for (int i = 0; i < count; ++i)
    if (status[std::size_t(i)] == 0) done.push_back(i);
  return {points(Eigen::all, done), values(Eigen::all, done)};
}

void errors(const Words& w) {
  const auto study = StudyCase::read(w.plain.at(1), w.overrides);
  const BuiltInModel model(study.forward, {.pulses = study.campaign.pulses, .energy_sd = study.campaign.pulse_energy_sd}, 1);
  const auto& parameters = model.shape().parameters;
  const Fit reference = read_fit(w.plain.at(2), parameters);
  const auto floor = read_floor(read_json(path(w.plain.at(2)) / "floor.json"));
  const Truth truth = true_runs(study, model, test_points(parameters, reference), w.plain.at(3));
  const auto d = model.describe();
  const auto finer = finer_model(model);
  const double one = double(study.campaign.pulses) * double(d.elements) * double(d.steps);
  const double fine = finer ? double(study.campaign.pulses) * double(finer->describe().elements) * double(finer->describe().steps) : 0;
  fmt::print("{} runs over the bounds, {} about the reference; an ensemble mean is {:.3g} element-steps, one of half the element size {:.3g}\n\n", truth.wide, truth.theta.cols() - truth.wide, one, fine);
  fmt::print("| directory | surrogate | campaign | added | with a finer partner | candidates and polish | element-steps | R2 over the bounds | error over the bounds | error near the optimum | "
             "error over floor: median, worst | gauges and windows below half the floor | distance from the reference [sd] |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (std::size_t i = 4; i < w.plain.size(); ++i) {
    const path out = w.plain[i];
    const auto surrogate = load_surrogate(out / "surrogate.nc");
    const bool fitted = std::filesystem::exists(out / "map.json");
    const Fit fit = fitted ? read_fit(out, parameters) : Fit{};
    const RefinedModel::Variance variance = [&](std::span<const double> theta) { return surrogate->error_variance(theta); };
    std::unique_ptr<RefinedModel> refined;
    if (fit.added >= 2) {
      const auto [theta, values] = added_values(out, fit.added);
      refined = std::make_unique<RefinedModel>(*surrogate, variance, theta, values);
    }
    const ForwardModel& used = refined ? static_cast<const ForwardModel&>(*refined) : *surrogate;
    const Eigen::MatrixXf all = used.means(truth.theta, default_threads());
    const Eigen::Index local = all.cols() - truth.wide;
    const auto ratios = over_the_floor(all.rightCols(local), truth.values.rightCols(local), floor, model.shape());
    const double below = double(std::lower_bound(ratios.begin(), ratios.end(), 0.5) - ratios.begin()) / double(ratios.size());
    const int runs = read_json(out / "campaign.json").at("completed");
    std::string distance;
    if (fitted) distance = fmt::format("{:.2f}", (fit.theta - reference.theta).cwiseQuotient(reference.covariance.diagonal().cwiseSqrt()).cwiseAbs().maxCoeff());
    fmt::print("| {} | {} | {} | {} | {} | {} | {:.3g} | {:.4f} | {:.2f} % | {:.2f} % | {:.2f}, {:.2f} | {:.0f} % | {} |\n", out.filename().string(), surrogate->kind(), runs, fit.added, fit.pairs,
               fit.model_runs, one * (runs + fit.added + fit.model_runs) + fine * fit.pairs, fit_metrics(all.leftCols(truth.wide), truth.values.leftCols(truth.wide)).r2,
               100 * median_relative(all.leftCols(truth.wide), truth.values.leftCols(truth.wide)), 100 * median_relative(all.rightCols(local), truth.values.rightCols(local)),
               ratios[ratios.size() / 2], ratios.back(), 100 * below, distance);
  }
}

}  // namespace

int main(int argc, char** argv) try {
  const Words w = words_of(argc, argv);
  if (w.plain.size() == 4 && w.plain[0] == "prefix") return prefix(w), 0;
  if (w.plain.size() >= 5 && w.plain[0] == "errors") return errors(w), 0;
  fmt::print(stderr, "usage: bench_adaptive_design prefix CASE.toml FROM_DIR TO_DIR | errors CASE.toml REFERENCE_DIR TEST_DIR OUT_DIR... [--set KEY=VALUE]...\n");
  return 2;
} catch (const std::exception& e) {
  fmt::print(stderr, "{}\n", e.what());
  return 2;
}
