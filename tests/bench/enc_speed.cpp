// Evaluations a second of ENC's searches on a corrected surrogate, part by part, beside the arithmetic's bound.
//
//   bench_enc                        112 training runs of an analytic family, 10 gauges of 501 samples
//   bench_enc CASE.toml OUT_DIR      the surrogate and the recordings of a case that was trained into OUT_DIR
//
// One evaluation is a parameter point to its objective; points come forty at a time, a generation. The correction is a kriging of `corrections` runs, errors
// made up: its cost does not depend on them.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <thread>

#include "apps/inputs/study_case.hpp"
#include "base/parallel.hpp"
#include "forward/emulator/mesh_correction.hpp"
#include "forward/surrogate/training.hpp"
#include "inverse/enc/enc_rounds.hpp"
#include "tests/bench/machine.hpp"
#include "tests/unit/forward/surrogate/wave_family.hpp"

using namespace calomel;

namespace {

constexpr Eigen::Index generation = 40, corrections = 40;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Seconds of one call: the least of groups of calls, for at least half a second.
template <class Body>
double seconds_of(Body&& body) {
  body();
  double best = 1e300;
  int calls = 1;
  for (const double end = now() + 0.5; now() < end;) {
    const double began = now();
    for (int i = 0; i < calls; ++i) body();
    const double spent = now() - began;
    best = std::min(best, spent / calls);
    if (spent < 0.01) calls *= 2;
  }
  return best;
}

struct Bench {
  std::unique_ptr<Surrogate> surrogate;
  Problem problem;
};

Bench made_up() {
  const Archive archive = mimic_records(140, 10, 501, 11000, 1200, 1800, 1);
  SurrogateOptions options;
  options.gaussian_process.iterations = 20;
  options.modes.energy = 1 - 1e-10;
  SurrogateSummary summary;
  Bench b{train_surrogate(options, archive, 1, default_threads(), summary), {}};
  Recordings r;
  r.conditions = archive.shape.conditions;
  r.sensors = archive.shape.sensors;
  r.time = archive.shape.times;
  r.pulses = {0, 1, 2, 3};
  r.sensor_lines.assign(r.sensors.size(), 0);
  RandomStream random(2, 0);
  for (std::size_t s = 0; s < r.sensors.size(); ++s)
    for (std::size_t p = 0; p < 4; ++p)
      for (std::size_t t = 0; t < r.time.size(); ++t) r.values.push_back(archive.mean(Eigen::Index(archive.shape.at(0, s, t)), 7) + 2e-5 * random.normal());
  b.problem = make_problem(archive.shape, r, {});
  return b;
}

Bench of_case(const std::filesystem::path& file, const std::filesystem::path& out) {
  const StudyCase study = StudyCase::read(file, {});
  Bench b{load_surrogate(out / "surrogate.nc"), {}};
  std::vector<std::string> said;
  b.problem = make_problem(b.surrogate->shape(), study.matched_recordings(said), *study.recordings);
  return b;
}

void row(const std::string& what, double seconds_each, double operations, const std::string& note = "") {
  fmt::print("{:58} {:12.0f}", what, 1 / seconds_each);
  fmt::print("{}", operations > 0 ? fmt::format(" {:10.1f}", operations / seconds_each / 1e9) : fmt::format(" {:>10}", ""));
  fmt::print("  {}\n", note);
}

}  // namespace

int main(int argc, char** argv) {
  const Bench b = argc > 2 ? of_case(argv[1], argv[2]) : made_up();
  const Bounds bounds = bounds_of(b.problem.shape);
  RandomStream random(3, 0);
  const auto points_of = [&](Eigen::Index n) {
    Eigen::MatrixXd x(bounds.low.size(), n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index k = 0; k < x.rows(); ++k) x(k, i) = random.uniform(bounds.low[k], bounds.high[k]);
    return x;
  };
  const Eigen::MatrixXd added = points_of(corrections), points = points_of(generation);
  const auto& parameters = b.surrogate->shape().parameters;
  const EmulatorBox box(parameters, {bounds.low.data(), std::size_t(bounds.low.size())}, {bounds.high.data(), std::size_t(bounds.high.size())});
  EmulatorRuns runs{.u = Eigen::MatrixXd(added.rows(), added.cols()), .level = std::vector<int>(std::size_t(corrections), 1), .levels = 2};
  std::fill(runs.level.begin() + corrections / 2, runs.level.end(), 0);
  for (Eigen::Index i = 0; i < added.cols(); ++i) runs.u.col(i) = box.u({added.col(i).data(), std::size_t(added.rows())});
  const Eigen::MatrixXd histories = b.surrogate->means(added, 1).cast<double>();
  const MeshCorrection correction(box, MultilevelRegression(runs, histories, Eigen::VectorXd::Ones(histories.rows())), histories, 1, {}, {});
  const CorrectedModel model(*b.surrogate, correction);
  const HistoryBasis basis = model.basis();
  const Objective& objective = objectives().get("paper_enc");
  const BatchCost cost(b.problem, model, objective);
  const BatchScorer scorer(b.problem, basis);
  const Eigen::MatrixXf coefficients = model.coefficients(points);
  const auto n = double(generation);
  const double product = 2 * double(basis.directions.size());

  fmt::print("surrogate {}: {} values, {} directions ({} of them corrections); {:.2f} MFLOP an evaluation in the product; instruction set {}\n\n",
             b.surrogate->kind(), basis.offset.size(), basis.directions.cols(), corrections, product / 1e6, name_of(instruction_set()));
  fmt::print("{:58} {:>12} {:>10}\n", "one thread", "a second", "GFLOP/s");
  Eigen::MatrixXf y(basis.offset.size(), generation);
  const double sgemm = seconds_of([&] { y.noalias() = basis.directions * coefficients; }) / n;
  row("the product alone, Eigen as the libraries are built", sgemm, product);
  const int bytes = instruction_set() == InstructionSet::avx512 ? 64 : instruction_set() == InstructionSet::avx2 ? 32 : 16;
  const double peak = peak_arithmetic<float>(bytes, 1) * 1e9;
  row("the product at the peak of this instruction set: the bound", product / peak, product);
  row("histories written, then scored", seconds_of([&] { (void)objective.costs(b.problem, model.means(points, 1)); }) / n, 0);
  for (const auto isa : instruction_sets()) {
    const BatchScorer by(b.problem, basis, isa);
    const double each = seconds_of([&] { (void)by.score(coefficients); }) / n;
    row(fmt::format("product and scores in one, {}", name_of(isa)), each, by.product_operations(),
        fmt::format("scores included, product's operations counted"));
  }
  row("coefficients", seconds_of([&] { (void)model.coefficients(points); }) / n, 0);
  const double whole = seconds_of([&] { (void)cost(points); }) / n;
  row("whole evaluation", whole, 0, fmt::format("{:.0f} % of the bound", 100 * product / peak / whole));
  row("directions projected once a search", seconds_of([&] { (void)BatchScorer(b.problem, basis); }), 0);

  fmt::print("\n{:58} {:>12}\n", "rounds (100 generations of 40), es gwo de mfo in turn", "a second");
  for (const int threads : {1, 2}) {
    const RoundPlan plan{.optimizers = {"es", "gwo", "de", "mfo"}, .rounds = 24, .pool = 160};
    const double began = now();
    const std::clock_t processor = std::clock();
    const auto found = search_rounds(b.problem, model, objective, plan, 1, threads);
    const double seconds = now() - began, spent = double(std::clock() - processor) / CLOCKS_PER_SEC;
    double evaluations = 0;
    for (const auto& r : found.rounds) evaluations += double(r.evaluations);
    row(fmt::format("{} thread{}, {} evaluations", threads, threads > 1 ? "s" : "", evaluations), seconds / evaluations, 0,
        fmt::format("100 rounds in {:.1f} s, {:.1f} s of processor time; {:.0f} evaluations a second of it", seconds / 24 * 100, spent / 24 * 100,
                    evaluations / spent));
  }
}
