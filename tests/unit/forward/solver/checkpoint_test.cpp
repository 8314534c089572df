// A run that is stopped and continued from its checkpoint ends with the same bytes as a run that was not stopped.
#include <fstream>

#include "tests/scratch.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

namespace {

/// A creeping liquid, p = -K (e_v - x), x' = (e_v - x) / tau: a law with a state.
class Creeping : public LiquidLaw {
 public:
  explicit Creeping(double k) : k_(k) {}
  [[nodiscard]] std::size_t state_size() const override { return 1; }
  void advance(const LiquidPoints& p) const override {
    for (std::size_t i = 0; i < p.count; ++i) {
      double& x = p.state[i];
      x = p.strain[i] + (x - p.strain[i]) * std::exp(-p.dt / 2e-5);
      p.pressure[i] = p.heating[i] - k_ * (p.strain[i] - x);
    }
  }

 private:
  double k_;
};

struct Stopped {
  Mesh mesh = block({10, 2, 4}, {0, 0, 0}, {0.02, 0.004, 0.008}, [](const Vec3& x) { return x[2] > 0.006 ? Region::steel : Region::mercury; });
  ExplicitSolver solver{mesh, steel()};
  RunSetup setup = linear_setup(4e-5, 2e-6);
  std::vector<ObservationRow> rows{component(nearest(mesh, {0.02, 0, 0.008}), 0), component(nearest(mesh, {0, 0, 0}), 2)};
  std::filesystem::path path;
  int subcycles = 1;

  explicit Stopped(const std::string& name) : path(scratch_file(name)) {
    std::filesystem::remove(path);
    setup.liquid.tensile_cutoff = 1.5e5;
    setup.liquid.viscosity = 2000;
    setup.collapse_viscosity = 0.1;
    for (std::size_t e = 0; e < mesh.elements.size(); ++e) setup.p0.push_back(mesh.region[e] == Region::mercury ? 1e6 * double(e % 11) : 0);
    setup.pulse_length = 0.7e-6;
    setup.steel_mass_damping = 100;
    setup.steel_branches = {{0.05, 1e-6}, {0.02, 1e-5}};
  }
  ~Stopped() { std::filesystem::remove(path); }

  [[nodiscard]] SolveOptions options(const std::string& precision, bool energy_balance) const {
    SolveOptions o;
    o.precision = precision;
    o.energy_balance = energy_balance;
    o.subcycles = subcycles;
    o.checkpoint = {.path = path, .every_seconds = 0, .identity = "this run", .before_saving = {}, .on_resume = {}};
    return o;
  }
  /// Runs until the share `until` of the time and stops there.
  void stop_at(double until, SolveOptions o) const {
    std::atomic<bool> stop{false};
    o.checkpoint.every_seconds = 1e9;
    o.stop = &stop;
    o.on_progress = [&](double share) { stop = share >= until; };
    EXPECT_THROW((void)solver.solve(setup, rows, o), Interrupted);
  }
};

}  // namespace

TEST(Checkpoint, AStoppedRunGoesOnByteForByte) {
  for (const auto& [own_law, subcycles] : {std::pair(false, 1), {true, 1}, {false, 3}, {true, 3}})
    for (const char* precision : {"double", "single"})
      for (const std::size_t runs : {1, 2}) {
        Stopped s("goes_on");
        s.subcycles = subcycles;
        s.setup.energies.assign(runs, 1.0);
        if (runs > 1) s.setup.energies[1] = 1.1;
        if (own_law) s.setup.liquid_law = std::make_shared<Creeping>(s.setup.liquid.bulk_modulus);
        SolveOptions plain = s.options(precision, runs == 1);
        plain.checkpoint = {};
        const auto whole = s.solver.solve(s.setup, s.rows, plain);
        EXPECT_EQ(whole.subcycles > 1, subcycles > 1);
        s.stop_at(0.4, s.options(precision, runs == 1));
        ASSERT_TRUE(std::filesystem::exists(s.path));
        const auto resumed = s.solver.solve(s.setup, s.rows, s.options(precision, runs == 1));
        EXPECT_EQ(resumed.resumed_from, std::llround(0.4 * double(whole.steps)));
        EXPECT_EQ(resumed.observations, whole.observations);
        EXPECT_EQ(resumed.times, whole.times);
        if (runs == 1) {
          EXPECT_EQ(resumed.energy_balance_error, whole.energy_balance_error);
          EXPECT_EQ(resumed.dissipated, whole.dissipated);
          EXPECT_EQ(resumed.greatest_stress, whole.greatest_stress);
        }
        EXPECT_FALSE(std::filesystem::exists(s.path));  // a finished run leaves no checkpoint
      }
}

TEST(Checkpoint, OfAFinishedRunGivesItsResultWithoutAStep) {
  Stopped s("kept");
  SolveOptions o = s.options("double", true);
  o.checkpoint.every_seconds = 1e9;
  o.checkpoint.keep = true;
  int pictures = 0;
  o.field_interval = 7e-6;  // the step does not divide the end
  o.on_field = [&](const FieldSnapshot&) { ++pictures; };
  const auto whole = s.solver.solve(s.setup, s.rows, o);
  const int all = pictures;
  ASSERT_TRUE(std::filesystem::exists(s.path));
  bool ended = false;
  o.checkpoint.on_resume = [&](std::int64_t step, std::int64_t fields, bool finished) {
    EXPECT_EQ(step, whole.steps);
    EXPECT_EQ(fields, all);
    ended = finished;
  };
  const auto again = s.solver.solve(s.setup, s.rows, o);
  EXPECT_TRUE(ended);
  EXPECT_EQ(pictures, all);  // no run is given out twice
  EXPECT_EQ(again.resumed_from, whole.steps);
  EXPECT_EQ(again.observations, whole.observations);
  EXPECT_EQ(again.energy_balance_error, whole.energy_balance_error);
  EXPECT_EQ(again.greatest_stress, whole.greatest_stress);
  EXPECT_TRUE(std::filesystem::exists(s.path));
}

TEST(Checkpoint, OfAnotherRunIsAnError) {
  Stopped s("another");
  s.stop_at(0.5, s.options("double", true));
  const auto refused = [&](const SolveOptions& o) {
    try {
      (void)s.solver.solve(s.setup, s.rows, o);
      ADD_FAILURE() << "it should have been refused";
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr("the checkpoint is of another run"));
      EXPECT_THAT(e.what(), HasSubstr("delete it"));
      EXPECT_EQ(e.parts().file, s.path.string());
    }
  };
  SolveOptions other = s.options("double", true);
  other.checkpoint.identity = "that run";
  refused(other);
  refused(s.options("single", true));
  EXPECT_NO_THROW((void)s.solver.solve(s.setup, s.rows, s.options("double", true)));  // the checkpoint is still there for its own run
}

TEST(Checkpoint, ThatIsCutOffOrNoneAtAllIsAnError) {
  Stopped s("cut_off");
  s.stop_at(0.5, s.options("double", true));
  const auto size = std::filesystem::file_size(s.path);
  for (const auto left : {size - 1, size / 2, std::uintmax_t(200), std::uintmax_t(10)}) {
    std::filesystem::resize_file(s.path, left);
    EXPECT_THROW((void)s.solver.solve(s.setup, s.rows, s.options("double", true)), InputError) << left;
  }
  std::ofstream(s.path) << "something else altogether, and longer than the header of a checkpoint would be, by far";
  EXPECT_THROW((void)s.solver.solve(s.setup, s.rows, s.options("double", true)), InputError);
}
