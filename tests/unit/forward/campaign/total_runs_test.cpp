// Dissipated energy and time at cutoff of single runs: against the energy balance of a simulation, the fields, and what must be nought.
#include "forward/campaign/total_runs.hpp"

#include <gmock/gmock.h>

#include "base/provenance.hpp"
#include "forward/mesh/hexahedron.hpp"
#include "forward/target/target_simulator.hpp"
#include "tests/scratch.hpp"
#include "tests/unit/forward/target/small_case.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

const std::string cutoff = "[parameter.tensile_cutoff]\nmin = 5e4\nmax = 1e10\nnominal = 1.5e5\n";
const Provenance of_test{.stage = "runs", .seed = 3};

SolveSummary simulated(const ForwardCase& c) {
  SolveOptions options = solve_options(c.solver);
  options.energy_balance = true;
  return BuiltInModel(c).simulate(options).summary;
}

}  // namespace

TEST(RunTotals, AreThoseOfASimulationAtTheSamePoint) {
  const BuiltInModel model(small_case(cutoff));
  for (const double value : {1.5e5, 3e5}) {
    ForwardCase c = small_case();
    c.mercury.tensile_cutoff = value;
    const SolveSummary s = simulated(c);
    const auto totals = model.totals(std::vector{value});
    ASSERT_EQ(totals.size(), 1u);
    EXPECT_EQ(totals[0].dissipated, s.dissipated);
    EXPECT_EQ(totals[0].time_at_cutoff, s.time_at_cutoff);
    EXPECT_GT(s.dissipated, 0);
    EXPECT_LT(s.dissipated, s.energy_in);
    EXPECT_GT(s.time_at_cutoff, 0);
    EXPECT_LT(s.time_at_cutoff, c.time.end);
  }
}

/// The mean over the mercury's volume of what the picture of the last instant has by element.
TEST(RunTotals, TimeAtCutoffIsTheMeanOfTheFieldOverTheMercury) {
  for (const char* precision : {"double", "single"}) {
    ForwardCase c = small_case();
    c.solver.precision = precision;
    // elements of different sizes and steps
    c.geometry.wall_elements = 6;
    c.solver.subcycles = 4;
    const BuiltInModel model(c);
    SolveOptions options = solve_options(c.solver);
    options.energy_balance = true;
    options.field_interval = c.time.end;
    std::vector<double> last;
    options.on_field = [&](const FieldSnapshot& f) { last = f.time_at_cutoff; };
    const SolveSummary s = model.simulate(options).summary;
    const Mesh& mesh = model.mesh();
    double sum = 0, of_all = 0;
    for (std::size_t e = 0; e < mesh.elements.size(); ++e)
      if (mesh.region[e] == Region::mercury) {
        hexahedron::Corners x;
        for (std::size_t k = 0; k < 8; ++k) x[k] = Eigen::Map<const Eigen::Vector3d>(mesh.nodes[std::size_t(mesh.elements[e][k])].data());
        const double v = hexahedron::volume(x);
        of_all += v;
        sum += v * last[e];
      }
    EXPECT_GT(s.subcycles, 1);
    EXPECT_NEAR(of_all, mesh.quality.mercury_volume, 1e-9 * of_all);
    EXPECT_NEAR(s.time_at_cutoff, sum / of_all, 1e-9 * s.time_at_cutoff);
    EXPECT_GT(s.time_at_cutoff, 1e-7);
  }
}

/// A cutoff that nothing reaches: no time at all, and what is dissipated is the viscosity's.
TEST(RunTotals, WithoutACutoffTheTimeAtItIsNought) {
  ForwardCase c = small_case();
  EXPECT_GT(BuiltInModel(c).totals({})[0].time_at_cutoff, 0);
  c.mercury.law = "linear";
  const auto without = BuiltInModel(c).totals({})[0];
  EXPECT_EQ(without.time_at_cutoff, 0);
  EXPECT_GT(without.dissipated, 0);
}

TEST(RunTotals, AreKeptByTheStoreBesideOtherOutputsAndReportedWhereTheyFail) {
  const auto path = scratch("total_runs") / "runs.journal";
  const TargetSimulator simulator(small_case("[parameter.sound_speed]\nmin = 0\nmax = 2000\n"), {.pulses = 1});
  const Eigen::MatrixXd thetas = Eigen::RowVector3d(1450, 0, 1400);  // nothing resists compression at 0
  const ThreadExecutor two(2);
  Eigen::MatrixXd first;
  {
    RunStore store(of_test, path);
    Runs runs(simulator, store, two);
    const RunRequest plain = request_at(simulator.shape().parameters, std::vector{1450.0});
    (void)runs.get({&plain, 1});
    first = totals_at(runs, thetas);
    EXPECT_EQ(runs.made(), 4u);
    EXPECT_EQ(store.size(), 3u) << "the totals are further outputs of the first run";
    EXPECT_TRUE(store.read(plain).totals.empty());
    EXPECT_FALSE(store.read(plain).mean.empty());
    RunRequest both = plain;
    both.wanted.totals = true;
    EXPECT_TRUE(store.holds(both));
    EXPECT_EQ(store.read(both).mean, store.read(plain).mean);
    EXPECT_EQ(store.read(both).totals.size(), 2u);
  }
  ASSERT_EQ(first.rows(), 2);
  EXPECT_TRUE(first.col(0).allFinite() && first.col(2).allFinite());
  EXPECT_TRUE(first.col(1).array().isNaN().all());
  const auto alone = simulator.model()->totals(std::vector{1400.0})[0];
  EXPECT_EQ(first(0, 2), alone.dissipated);
  EXPECT_EQ(first(1, 2), alone.time_at_cutoff);
  RunStore store(of_test, path);
  Runs runs(simulator, store, two);
  const Eigen::MatrixXd again = totals_at(runs, thetas);
  EXPECT_EQ(runs.made(), 0u);
  EXPECT_EQ(again.col(0), first.col(0));
}

/// Conditions one after another, each with its own pulse.
TEST(RunTotals, HaveEveryConditionOfItsOwn) {
  const BuiltInModel model(small_case("[[condition]]\nname = \"low\"\npeak_pressure = 10e6\n[[condition]]\nname = \"high\"\npeak_pressure = 25e6\n"),
                           {.pulses = 1});
  const auto totals = model.totals({});
  ASSERT_EQ(totals.size(), 2u);
  const BuiltInModel high(small_case(), {.pulses = 1});
  EXPECT_EQ(totals[1].dissipated, high.totals({})[0].dissipated);
  EXPECT_LT(totals[0].dissipated, totals[1].dissipated);
}
