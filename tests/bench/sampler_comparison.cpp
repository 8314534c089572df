// Samplers on the five posteriors with published reference draws, beside Debian's python3-emcee on the same compiled densities: R-hat, effective sample sizes,
// |z| against the reference, and their cost. One thread, processor time, warm-up included on both sides. All start from the same mean and covariance, as the
// program starts from the mode and Laplace's covariance. A previous run estimates them here; it begins from the poor start of the tests and is not counted.
//
//   bench_samplers [POSTERIOR...]     CALOMEL_PYTHON=/usr/bin/python3 names the Python that has emcee; without it the rows of emcee are left out
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "base/json.hpp"
#include "base/linear_algebra.hpp"
#include "base/random.hpp"
#include "tests/verification/reference_scores.hpp"
#include "uq/convergence/diagnostics.hpp"
#include "uq/sampler/ensemble.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

double processor_time() { return double(std::clock()) / CLOCKS_PER_SEC; }

/// A run of a sampler or of emcee.
struct Run {
  std::string name;
  Draws draws;         ///< in natural units
  double seconds = 0;  ///< of processor
  std::size_t evaluations = 0;
  std::string beside;  ///< a remark for the last column
};

/// Lengths with which a row takes seconds; warm-up is a fifth to a third of them. A sampler that is not listed has its defaults.
SamplerOptions options_of(const std::string& kind) {
  SamplerOptions o = default_sampler_options(kind);
  if (kind == "dram") {
    o.warmup = 20000;
    o.draws = 5000;
    o.thin = 16;
  }
  if (kind == "nuts") {
    o.warmup = 1000;
    o.draws = 5000;
    o.thin = 1;
  }
  if (kind == "ensemble") {  // as emcee below
    o.warmup = 2000;
    o.draws = 600;
    o.thin = 10;
    o.table<WalkerOptions>().walkers = 32;
    o.dispersion = 1;
  }
  if (kind == "delayed_acceptance") {
    o.warmup = 500;
    o.draws = 5000;
  }
  return o;
}

Run run_of(const std::string& kind, const ReferencePosterior& p, const Json& data, const SamplerStart& start, std::uint64_t seed) {
  const auto density = p.make(data, Jacobian::kept), stand_in = p.stand_in(data);
  const auto options = options_of(kind);
  const double began = processor_time();
  auto r = sample(*density, *stand_in, start, options, {.seed = seed, .threads = 1});
  Run run{.name = kind, .draws = std::move(r.quantities), .seconds = processor_time() - began, .evaluations = r.summary.evaluations};
  if (r.summary.divergences > 0) run.beside = fmt::format("{} divergences", r.summary.divergences);
  if (r.summary.cheap_evaluations > 0) run.beside = fmt::format("{} evaluations of the stand-in", r.summary.cheap_evaluations);
  return run;
}

/// Settings of emcee: moves in the words of emcee_chains.py, and lengths.
struct EmceeOptions {
  std::string moves = "stretch";
  std::size_t walkers = 32, warmup = 2000, draws = 600;
};

/// Runs emcee_chains.py. The result has no draws if emcee is missing.
Run emcee_run(const EmceeOptions& options, const ReferencePosterior& p, const std::vector<std::string>& names, const SamplerStart& start, std::uint64_t seed) {
  constexpr std::size_t ensembles = 4, thin = 10;
  const char* named = std::getenv("CALOMEL_PYTHON");
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("emcee_{}_{}", p.name, std::clock()), starts = folder / "starts",
             out = folder / "draws";
  std::filesystem::create_directory(folder);
  std::vector<double> walkers;
  RandomStream random(seed, 0);
  const Eigen::MatrixXd factor = Cholesky(start.covariance).lower();
  for (std::size_t w = 0; w < ensembles * options.walkers; ++w) {
    Eigen::VectorXd z(start.mean.size());
    for (double& v : z) v = random.normal();
    const Eigen::VectorXd x = start.mean + factor * z;
    walkers.insert(walkers.end(), x.begin(), x.end());
  }
  std::ofstream(starts, std::ios::binary).write(reinterpret_cast<const char*>(walkers.data()), std::streamsize(walkers.size() * sizeof(double)));
  const std::string command = fmt::format("{} {}/tests/bench/emcee_chains.py {} {} {} {} {} {} {} {} {} {} {} {} 2>/dev/null",
                                          named ? named : "/usr/bin/python3", CALOMEL_SOURCE_DIR, CALOMEL_DENSITIES, p.name, reference_path(p).string(),
                                          options.moves, ensembles, options.walkers, options.warmup, options.draws, thin, seed, starts.string(), out.string());
  Run run;
  FILE* pipe = ::popen(command.c_str(), "r");
  double evaluations = 0;
  char version[32] = "";
  const bool reported = pipe && std::fscanf(pipe, "%lf %lf %31s", &run.seconds, &evaluations, version) == 3;
  const bool well = pipe && ::pclose(pipe) == 0 && reported;
  if (!well) return run;
  run.name = fmt::format("emcee {}, {}, {} walkers", version, options.moves, options.walkers);
  run.evaluations = std::size_t(evaluations);
  run.draws = {.names = names, .chains = ensembles * options.walkers, .draws = options.draws, .values = {}, .walkers = options.walkers};
  run.draws.values.resize(run.draws.chains * options.draws * names.size());
  std::ifstream in(out, std::ios::binary);
  in.read(reinterpret_cast<char*>(run.draws.values.data()), std::streamsize(run.draws.values.size() * sizeof(double)));
  expect(bool(in), "emcee writes the requested number of draws");
  std::filesystem::remove_all(folder);
  return run;
}

struct Judged {
  double r_hat = 0, bulk = 1e300, tail = 1e300;  ///< of the worst quantity
};
Judged judge(const Draws& draws) {
  Judged j;
  for (std::size_t k = 0; k < draws.names.size(); ++k) {
    const auto values = draws.of(k);
    const ChainDraws x{.values = values, .chains = draws.chains, .walkers = draws.walkers};
    j.r_hat = std::max(j.r_hat, split_r_hat(x));
    j.bulk = std::min(j.bulk, ess_bulk(x));
    j.tail = std::min(j.tail, ess_tail(x));
  }
  return j;
}

void print(const Run& run, const Json& reference) {
  const Judged j = judge(run.draws);
  const Scores s = scores(run.draws, reference);
  fmt::print("| {} | {:.3f} | {:.0f} | {:.0f} | {:.1f} ({}) | {} | {:.2f} | {:.0f} | {:.1f} | {} |\n", run.name, j.r_hat, j.bulk, j.tail, std::abs(s.worst),
             s.where, run.evaluations, run.seconds, j.bulk / run.seconds, 1000 * j.bulk / double(run.evaluations), run.beside);
  std::fflush(stdout);
}

/// Mean and covariance from a run of nuts.
SamplerStart estimated(const LogDensity& density, const ReferencePosterior& p) {
  const auto r = run_sampler(density, start_of(p), {.kind = "nuts", .warmup = 1000, .draws = 1000, .thin = 1}, {.seed = 3});
  const Eigen::Map<const Eigen::MatrixXd> x(r.coordinates.values.data(), Eigen::Index(density.dimension()),
                                            Eigen::Index(r.coordinates.chains * r.coordinates.draws));
  SamplerStart start{.mean = x.rowwise().mean(), .covariance = {}, .points = {}};
  const Eigen::MatrixXd from_mean = x.colwise() - start.mean;
  start.covariance = from_mean * from_mean.transpose() / double(x.cols() - 1);
  return start;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> only(argv + 1, argv + argc);
  for (const auto& p : reference_posteriors()) {
    if (!only.empty() && std::ranges::find(only, p.name) == only.end()) continue;
    const Json file = reference_file(p);
    if (file.is_null()) {
      fmt::print(stderr, "the file of the reference posteriors is missing: {}\n", p.file);
      return 2;
    }
    const auto density = p.make(file["data"], Jacobian::kept);
    fmt::print("\n### {} ({} coordinates)\n\n", p.title, density->dimension());
    fmt::print(
        "| sampler | R-hat | ESS, bulk | ESS, tail | greatest abs(z) | evaluations | processor time [s] | ESS a second | ESS a thousand evaluations | "
        "|\n|---|---|---|---|---|---|---|---|---|---|\n");
    const SamplerStart start = estimated(*density, p);
    const auto report = [&](const auto& run_with) {
      const Run first = run_with(1);
      if (first.draws.chains == 0) return;
      print(first, file["reference"]);
      if (std::abs(scores(first.draws, file["reference"]).worst) < 4) return;
      Run second = run_with(2);
      second.name += ", second seed";
      print(second, file["reference"]);
    };
    for (const auto& kind : samplers().names()) report([&](std::uint64_t seed) { return run_of(kind, p, file["data"], start, seed); });
    std::vector<std::string> names;
    for (const auto& q : density->quantities()) names.push_back(q);
    // The lengths of options_of for our own ensembles; and many walkers, which share what Python costs a step.
    for (const auto& options : {EmceeOptions{}, EmceeOptions{.moves = "de"}, EmceeOptions{.walkers = 128, .warmup = 1000, .draws = 200}})
      report([&](std::uint64_t seed) { return emcee_run(options, p, names, start, seed); });
  }
}
