// Optimisers side by side.
//
//   bench_optimizers                       decay of DGS, CMA-ES with restarts, Nesterov's random search and DE on two analytic stand-ins
//   bench_optimizers CASE.toml OUT_DIR     the same on polynomial surrogates of order 15 and 16 of the case's campaign in OUT_DIR
//   bench_optimizers --table               every optimiser of the catalogue on shifted test functions, as Markdown
//
// The first two write optimizer_comparison.json, .csv and .svg to OUT_DIR (or here): 50 trials each from random starts, best value against evaluations,
// mean and 3 standard deviations, as in the seed paper's figure.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <pagmo/algorithms/de.hpp>
#include <pagmo/algorithms/gwo.hpp>

#include "apps/inputs/study_case.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/parallel.hpp"
#include "base/random.hpp"
#include "inverse/optimizer/dgs.hpp"
#include "inverse/spe/spe.hpp"

using namespace calomel;

namespace {

constexpr int trials = 50, iterations = 100;

/// A function on the unit box to be minimised.
struct Target {
  std::string name;
  std::size_t dimensions;
  BatchFunction function;
};

BatchFunction pointwise(std::function<double(const Eigen::VectorXd&)> f) {
  return [f = std::move(f)](const Eigen::MatrixXd& points, std::span<double> values) {
    for (Eigen::Index i = 0; i < points.cols(); ++i) values[std::size_t(i)] = f(points.col(i));
  };
}

/// A curved valley of constant impedance with two basins and ripples, and a rippled bowl.
std::vector<Target> stand_ins() {
  const auto valley = [](const Eigen::VectorXd& x) {
    const double along = x[0] - x[1], across = (x[0] + 0.3) * (x[1] + 0.3) - 0.6;
    return 1 + 40 * across * across + 2 * std::pow(along * along - 0.1, 2) + 0.3 * along + 1.5 * std::pow(x[2] - 0.35, 2) +
           0.1 * std::cos(25 * x[0]) * std::cos(21 * x[1] + 3 * x[2]);
  };
  const auto bowl = [](const Eigen::VectorXd& x) {
    double f = 1;
    for (Eigen::Index k = 0; k < x.size(); ++k) {
      const double z = x[k] - 0.31 - 0.13 * double(k);
      f += 4 * z * z + 0.1 * (1 - std::cos(2 * M_PI * z / 0.11));
    }
    return f;
  };
  return {{"valley", 3, pointwise(valley)}, {"rippled bowl", 3, pointwise(bowl)}};
}

std::vector<Target> surrogates_of(const std::string& case_file, const std::filesystem::path& out) {
  const auto study = StudyCase::read(case_file, {});
  const auto archive = read_archive(out / "campaign.nc");
  std::vector<std::string> warnings;
  const auto problem = make_problem(archive.shape, study.matched_recordings(warnings), *study.recordings);
  SpeOptions options = study.spe;
  options.total_degree = {15, 16};
  options.tensor_product = {};
  options.hyperbolic_cross = {};
  options.lambda_scale = "cross_validation";
  options.lambdas = {1};
  const auto data = discrepancies(problem, archive, objectives().get(options.objective), options, 1);
  const auto fitted = fit_sparse_polynomials(data, options, 1, default_threads());
  std::vector<Target> all;
  for (const auto& s : fitted.surrogates) {
    fmt::print("{}: lambda {:.4g}, {} of {} terms, held-out error {:.1f} %\n", s.space.name(), s.lambda, s.nonzero, s.terms, 100 * s.validation.rrmse);
    all.push_back({s.space.name(), std::size_t(archive.theta.rows()), [s, t = options.transform](const Eigen::MatrixXd& points, std::span<double> values) {
                     s.expansion.evaluate(points, values);
                     for (auto& v : values) v = restored(t, v);
                   }});
  }
  return all;
}

/// The best value after every `step` evaluations.
class Watch {
 public:
  Watch(const BatchFunction& function, std::size_t step, std::size_t points) : function_(function), step_(step), points_(points) {}
  void operator()(const Eigen::MatrixXd& points, std::span<double> values) {
    function_(points, values);
    for (const double v : values) {
      best_ = std::min(best_, v);
      if (++count_ % step_ == 0 && trace.size() < points_) trace.push_back(best_);
    }
  }
  void finish() { trace.resize(points_, best_); }
  std::vector<double> trace;

 private:
  const BatchFunction& function_;
  std::size_t step_, points_, count_ = 0;
  double best_ = std::numeric_limits<double>::infinity();
};

struct Curve {
  std::string name;
  std::vector<double> mean, sd;
  double best, worst;
};

Curve decay(const Target& target, const std::string& method) {
  const std::size_t step = dgs_evaluations({}, target.dimensions);
  const Bounds unit{Eigen::VectorXd::Zero(Eigen::Index(target.dimensions)), Eigen::VectorXd::Ones(Eigen::Index(target.dimensions))};
  std::vector<std::vector<double>> traces(trials);
  parallel_for(trials, default_threads(), [&](std::size_t i) {
    Watch watch(target.function, step, iterations);
    const BatchFunction watched = [&](const Eigen::MatrixXd& points, std::span<double> values) { watch(points, values); };
    if (method == "dgs") {
      RandomStream random(1, i);
      const Eigen::MatrixXd start = Eigen::MatrixXd::NullaryExpr(unit.low.size(), 1, [&] { return random.uniform(); });
      (void)minimise_dgs(watched, start, {}, iterations, i);
    } else {
      (void)minimise(optimizers().get(method), watched, unit, {int(step * iterations / 40) - 1, 40}, 1, i);
    }
    watch.finish();
    traces[i] = std::move(watch.trace);
  });
  Curve c{.name = method, .best = std::numeric_limits<double>::infinity(), .worst = -std::numeric_limits<double>::infinity()};
  for (std::size_t k = 0; k < std::size_t(iterations); ++k) {
    double sum = 0, squares = 0;
    for (const auto& t : traces) sum += t[k];
    for (const auto& t : traces) squares += std::pow(t[k] - sum / trials, 2);
    c.mean.push_back(sum / trials);
    c.sd.push_back(std::sqrt(squares / (trials - 1)));
  }
  for (const auto& t : traces) c.best = std::min(c.best, t.back()), c.worst = std::max(c.worst, t.back());
  return c;
}

/// One panel a target, one line with its band a method.
std::string picture(const std::vector<Target>& targets, const std::vector<std::vector<Curve>>& curves, std::size_t step) {
  constexpr double width = 430, height = 300, left = 60, top = 34, gap = 70;
  const std::vector<std::string> colours{"#2563a8", "#c2571a", "#3a8a4d", "#8a3a86"};
  std::string s = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"12\"><rect width=\"100%\" height=\"100%\" "
      "fill=\"#fff\"/>\n",
      left + double(targets.size()) * (width + gap), height + 110);
  for (std::size_t p = 0; p < targets.size(); ++p) {
    const double x0 = left + double(p) * (width + gap);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& c : curves[p]) low = std::min(low, c.best), high = std::max(high, c.mean[1]);
    const double margin = 0.04 * (high - low);
    low -= margin;
    high += margin;
    const auto x = [&](std::size_t k) { return x0 + width * double(k + 1) / iterations; };
    const auto y = [&](double f) { return top + height * (1 - (std::clamp(f, low, high) - low) / (high - low)); };
    s += fmt::format(
        "<text x=\"{}\" y=\"20\" font-weight=\"bold\">{}</text><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#999\"/>\n", x0,
        targets[p].name, x0, top, width, height);
    for (int i = 0; i <= 4; ++i) {
      const double f = low + (high - low) * i / 4;
      s += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{:.3g}</text>", x0 - 6, y(f) + 4, f);
      s += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", x0 + width * i / 4, top + height + 17,
                       step * iterations * std::size_t(i) / 4);
    }
    s += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">evaluations</text>\n", x0 + width / 2, top + height + 35);
    for (std::size_t m = 0; m < curves[p].size(); ++m) {
      const auto& c = curves[p][m];
      std::string line, band, back;
      for (std::size_t k = 0; k < c.mean.size(); ++k) {
        line += fmt::format("{:.1f},{:.1f} ", x(k), y(c.mean[k]));
        band += fmt::format("{:.1f},{:.1f} ", x(k), y(c.mean[k] + 3 * c.sd[k]));
        back = fmt::format("{:.1f},{:.1f} ", x(k), y(c.mean[k] - 3 * c.sd[k])) + back;
      }
      s += fmt::format("<polygon points=\"{}{}\" fill=\"{}\" opacity=\"0.12\"/><polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\"/>\n",
                       band, back, colours[m], line, colours[m]);
      s += fmt::format("<text x=\"{}\" y=\"{}\" fill=\"{}\">{}</text>\n", x0 + 100.0 * double(m), top + height + 58, colours[m], c.name);
    }
  }
  return s + "</svg>\n";
}

int compare(const std::vector<Target>& targets, const std::filesystem::path& out) {
  const std::size_t step = dgs_evaluations({}, targets[0].dimensions);
  Json json{{"trials", trials}, {"evaluations", step * iterations}, {"targets", Json::array()}};
  std::string csv = "target,method,evaluations,mean,sd\n";
  std::vector<std::vector<Curve>> curves;
  for (const auto& target : targets) {
    Json methods = Json::array();
    curves.emplace_back();
    for (const char* name : {"dgs", "cmaes_restarts", "nesterov", "de"}) {
      const Curve c = decay(target, name);
      Json evaluations = Json::array();
      for (std::size_t k = 0; k < c.mean.size(); ++k) {
        evaluations.push_back(step * (k + 1));
        csv += fmt::format("{},{},{},{:.9g},{:.9g}\n", target.name, name, step * (k + 1), c.mean[k], c.sd[k]);
      }
      methods.push_back({{"name", name}, {"evaluations", evaluations}, {"mean", c.mean}, {"sd", c.sd}, {"best", c.best}, {"worst", c.worst}});
      fmt::print("{:20} {:16} after 520: {:10.5g}   after {}: mean {:10.5g}  sd {:9.3g}  best {:10.5g}  worst {:10.5g}\n", target.name, name, c.mean[19],
                 step * iterations, c.mean.back(), c.sd.back(), c.best, c.worst);
      curves.back().push_back(c);
    }
    json["targets"].push_back({{"name", target.name}, {"methods", methods}});
  }
  write_json(out / "optimizer_comparison.json", json);
  write_atomically(out / "optimizer_comparison.csv", csv);
  write_atomically(out / "optimizer_comparison.svg", picture(targets, curves, step));
  return 0;
}

/// Median of the best values of 11 seeds.
double median_best(const OptimizerEntry& entry, const BatchFunction& f, const Bounds& box, const OptimizerOptions& options) {
  std::vector<double> best(11);
  parallel_for(best.size(), default_threads(), [&](std::size_t s) { best[s] = minimise(entry, f, box, options, 1, s).f; });
  std::nth_element(best.begin(), best.begin() + 5, best.end());
  return best[5];
}

int table() {
  using Function = std::function<double(const Eigen::VectorXd&)>;  // of the distance from the optimum
  const std::vector<std::pair<std::string, Function>> functions{{"sphere", [](const Eigen::VectorXd& z) { return z.squaredNorm(); }},
                                                                {"Rosenbrock",
                                                                 [](const Eigen::VectorXd& z) {
                                                                   double f = 0;
                                                                   for (Eigen::Index k = 0; k + 1 < z.size(); ++k)
                                                                     f += 100 * std::pow(z[k + 1] + 1 - (z[k] + 1) * (z[k] + 1), 2) + z[k] * z[k];
                                                                   return f;
                                                                 }},
                                                                {"Rastrigin",
                                                                 [](const Eigen::VectorXd& z) {
                                                                   double f = 0;
                                                                   for (const double v : z) f += v * v + 10 * (1 - std::cos(2 * M_PI * v));
                                                                   return f;
                                                                 }},
                                                                {"Ackley", [](const Eigen::VectorXd& z) {
                                                                   double c = 0;
                                                                   for (const double v : z) c += std::cos(2 * M_PI * v) / double(z.size());
                                                                   return 20 * (1 - std::exp(-0.2 * std::sqrt(z.squaredNorm() / double(z.size())))) +
                                                                          std::exp(1.0) - std::exp(c);
                                                                 }}};
  const std::vector<std::pair<std::string, OptimizerEntry>> peers{
      {"pagmo de", [](int g, unsigned seed) { return pagmo::algorithm{pagmo::de(unsigned(g), 0.5, 0.9, 7u, 0, 0, seed)}; }},
      {"pagmo gwo", [](int g, unsigned seed) { return pagmo::algorithm{pagmo::gwo(unsigned(g), seed)}; }}};
  for (const std::size_t d : {3u, 10u}) {
    const OptimizerOptions options{d == 3 ? 100 : 250, 40};
    fmt::print("\n{} parameters, {} evaluations (box 7.5 wide, optimum off its middle)\n\n| optimiser |", d, (options.generations + 1) * options.population);
    for (const auto& f : functions) fmt::print(" {} |", f.first);
    fmt::print("\n|---|---|---|---|---|\n");
    Bounds box{Eigen::VectorXd(Eigen::Index(d)), Eigen::VectorXd(Eigen::Index(d))};
    for (Eigen::Index k = 0; k < Eigen::Index(d); ++k) box.low[k] = -3 - std::fmod(1.37 * double(k), 1.6), box.high[k] = box.low[k] + 7.5;
    const auto row = [&](const std::string& name, const OptimizerEntry& entry) {
      fmt::print("| {} |", name);
      for (const auto& [title, f] : functions)
        fmt::print(" {:.1e} |", median_best(entry, pointwise([&](const Eigen::VectorXd& x) { return f(x); }), box, options));
      fmt::print("\n");
    };
    for (const auto& r : optimizers().rows()) row('`' + r.name + '`', r.entry);
    for (const auto& [name, entry] : peers) row(name, entry);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words == std::vector<std::string>{"--table"}) return table();
  if (words.size() == 2) return compare(surrogates_of(words[0], words[1]), words[1]);
  if (words.empty()) return compare(stand_ins(), ".");
  std::cerr << "bench_optimizers [--table | CASE.toml OUT_DIR]\n";
  return 2;
} catch (const std::exception& e) {
  std::cerr << e.what() << '\n';
  return 2;
}
