// The interface for liquid laws: Riemer's law by way of it gives the histories of the base model.
#include "forward/solver/liquid_law.hpp"

#include <mutex>

#include "base/random.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

/// Riemer's law as a LiquidLaw.
class RiemerAgain : public LiquidLaw {
 public:
  explicit RiemerAgain(const Riemer& law) : law_(law) {}
  void advance(const LiquidPoints& p) const override {
    for (std::size_t i = 0; i < p.count; ++i) p.pressure[i] = law_.pressure(p.heating[i], p.strain[i], (p.strain[i] - p.strain_before[i]) / p.dt);
  }

 private:
  Riemer law_;
};

/// Steel over mercury; `distorted`: general hexahedra.
Mesh target(bool distorted) {
  Mesh m = block({8, 3, 6}, {0, 0, 0}, {0.016, 0.006, 0.012}, [](const Vec3& x) { return x[2] > 0.008 ? Region::steel : Region::mercury; });
  if (distorted) {
    RandomStream random(3, 0);
    for (auto& x : m.nodes)
      for (std::size_t c = 0; c < 3; ++c)
        if (x[c] > 1e-9 && x[2] < 0.0079) x[c] += 2e-4 * random.uniform(-1, 1);
  }
  fix(m, 4, plane(2, 0));
  fix(m, 1, plane(0, 0));
  return m;
}

RunSetup heated(const Mesh& mesh, double end) {
  RunSetup s = linear_setup(end, 1e-6);
  s.liquid.tensile_cutoff = 1.5e5;
  s.liquid.viscosity = 2000;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const double x = mesh.nodes[std::size_t(mesh.elements[e][0])][0];
    s.p0.push_back(mesh.region[e] == Region::mercury ? 20e6 * std::exp(-x / 0.005) : 0);
  }
  s.pulse_length = 0.7e-6;
  return s;
}

double greatest_difference(const SolveSummary& a, const SolveSummary& b) {
  double difference = 0, scale = 0;
  for (std::size_t i = 0; i < a.observations.size(); ++i)
    difference = std::max(difference, std::abs(a.observations[i] - b.observations[i])), scale = std::max(scale, std::abs(a.observations[i]));
  return difference / scale;
}

}  // namespace

TEST(LiquidLaw, RiemersThroughTheSeamGivesTheBaseHistories) {
  for (const bool distorted : {false, true}) {
    const Mesh mesh = target(distorted);
    const ExplicitSolver solver(mesh, steel());
    for (const char* kinematics : {"small", "finite"})
      for (const char* precision : {"double", "single"})
        for (const std::size_t runs : {1, 3})
          for (const bool energy_balance : {false, true}) {
            if (energy_balance && runs > 1) continue;
            RunSetup s = heated(mesh, 1.2e-5);
            if (runs > 1) s.energies = {0.9, 1.0, 1.1};
            SolveOptions o;
            o.kinematics = kinematics;
            o.precision = precision;
            o.energy_balance = energy_balance;
            const std::vector<ObservationRow> rows{component(nearest(mesh, {0.016, 0.006, 0.012}), 0), component(nearest(mesh, {0.008, 0, 0.008}), 2)};
            const auto base = solver.solve(s, rows, o);
            s.liquid_law = std::make_shared<RiemerAgain>(s.liquid);
            const auto seam = solver.solve(s, rows, o);
            const std::string name = std::string(distorted ? "general_" : "parallelepiped_") + kinematics + '_' + precision + '_' + std::to_string(runs) +
                                     (energy_balance ? "_balance" : "");
            measured(name, greatest_difference(base, seam));
            EXPECT_LT(greatest_difference(base, seam), *precision == 'd' ? 1e-10 : 1e-4) << name;
            if (energy_balance && *precision == 'd') {
              measured(name + "_balance", seam.energy_balance_error);
              EXPECT_LT(seam.energy_balance_error, 2 * base.energy_balance_error + 1e-6) << name;
            }
            // Control: the comparison detects a softer law.
            s.liquid_law = std::make_shared<RiemerAgain>(Riemer{0.98 * s.liquid.bulk_modulus, s.liquid.tensile_cutoff, s.liquid.viscosity});
            EXPECT_GT(greatest_difference(base, solver.solve(s, rows, o)), 1e-3) << name;
          }
  }
}

// With an initial state the strain rate of the first step is that of the initial velocity.
TEST(LiquidLaw, KnowsTheStrainBeforeTheFirstStep) {
  const Mesh mesh = target(true);
  const ExplicitSolver solver(mesh, steel());
  for (const std::size_t runs : {1, 2})
    for (const char* kinematics : {"small", "finite"}) {
      RunSetup s = heated(mesh, 6e-6);
      s.liquid.tensile_cutoff = 1e30;
      s.energies.assign(runs, 1.0);
      s.initial_displacement = field(mesh, [](const Vec3& x) { return Vec3{-2e-4 * x[0], 1e-4 * x[1], -1e-4 * x[2]}; });
      s.initial_velocity = field(mesh, [](const Vec3& x) { return Vec3{-3e2 * x[0] * x[0], 0, -2 * x[2]}; });
      SolveOptions o;
      o.kinematics = kinematics;
      const std::vector<ObservationRow> rows{component(nearest(mesh, {0.016, 0.006, 0.012}), 0), component(nearest(mesh, {0.008, 0, 0.008}), 2)};
      const auto base = solver.solve(s, rows, o);
      s.liquid_law = std::make_shared<RiemerAgain>(s.liquid);
      EXPECT_LT(greatest_difference(base, solver.solve(s, rows, o)), *kinematics == 's' ? 1e-10 : 1e-6) << runs << kinematics;
    }
}

namespace {

/// Returns a number of its own at each point, from the place that it was given.
class NumberOfThePlace : public LiquidLaw {
 public:
  static double at(const Vec3& x) { return 1 + 1e3 * x[0] + 1e4 * x[1] + 1e5 * x[2]; }
  [[nodiscard]] std::size_t state_size() const override { return 2; }
  void initialise(std::span<const Vec3> centres, double* state, std::size_t stride) const override {
    for (std::size_t i = 0; i < centres.size(); ++i) state[stride + i] = at(centres[i]);
  }
  void advance(const LiquidPoints& p) const override {
    for (std::size_t i = 0; i < p.count; ++i) p.pressure[i] = p.state[p.stride + i], p.state[i] += 1;
  }
};

}  // namespace

TEST(LiquidLaw, NumbersOfThePlaceReachTheRightPoints) {
  for (const bool distorted : {false, true}) {
    const Mesh mesh = target(distorted);
    for (const char* precision : {"double", "single"})
      for (const std::size_t runs : {1, 2}) {
        RunSetup s = linear_setup(2e-6, 2e-6);
        s.energies.assign(runs, 1.0);
        s.liquid_law = std::make_shared<NumberOfThePlace>();
        int checked = 0;
        SolveOptions o;
        o.precision = precision;
        o.field_interval = 2e-6;
        o.on_field = [&](const FieldSnapshot& f) {
          if (f.time == 0) return;
          for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
            if (mesh.region[e] != Region::mercury) continue;
            Vec3 centre{};
            for (const NodeId n : mesh.elements[e])
              for (std::size_t c = 0; c < 3; ++c) centre[c] += mesh.nodes[std::size_t(n)][c] / 8;
            ASSERT_NEAR(f.pressure[e], NumberOfThePlace::at(centre), 1e-9) << e;
            ++checked;
          }
        };
        (void)ExplicitSolver(mesh, steel()).solve(s, {}, o);
        EXPECT_EQ(checked, 8 * 3 * 4);
      }
  }
}

namespace {

/// p = p0 - f K e_v - eta de_v/dt, f times as stiff as the run's own K. The law reports its stiffness or, as a control, does not.
class Stiffer : public LiquidLaw {
 public:
  Stiffer(const Riemer& law, double factor, bool reported) : law_(law), factor_(factor), reported_(reported) {}
  [[nodiscard]] double greatest_stiffness() const override { return reported_ ? factor_ * law_.bulk_modulus : 0; }
  void advance(const LiquidPoints& p) const override {
    for (std::size_t i = 0; i < p.count; ++i)
      p.pressure[i] = p.heating[i] - factor_ * law_.bulk_modulus * p.strain[i] - law_.viscosity * (p.strain[i] - p.strain_before[i]) / p.dt;
  }

 private:
  Riemer law_;
  double factor_;
  bool reported_;
};

/// Tait's form without heat, p = (K/m) ((1 - e)^m - 1), which stiffens under compression. Its stiffness has no bound of its own; the law is defined down to
/// e = -`most`.
class Tait : public LiquidLaw {
 public:
  Tait(double bulk_modulus, double m, double most) : k_(bulk_modulus), m_(m), most_(most) {}
  [[nodiscard]] double greatest_stiffness() const override { return k_ * std::pow(1 + most_, m_ - 1); }
  [[nodiscard]] double pressure(double e) const { return k_ / m_ * (std::pow(1 - e, m_) - 1); }
  /// Stored energy per volume.
  [[nodiscard]] double stored(double e) const { return k_ / m_ * ((std::pow(1 - e, m_ + 1) - 1) / (m_ + 1) + e); }
  void advance(const LiquidPoints& p) const override {
    for (std::size_t i = 0; i < p.count; ++i) {
      if (p.strain[i] < -most_) throw LiquidPointError("compressed beyond what the step was made for", i);
      p.pressure[i] = pressure(p.strain[i]);
    }
  }

 private:
  double k_, m_, most_;
};

}  // namespace

// A law that is stiffer than the run's bulk modulus, and reports it, runs like the same liquid with that bulk modulus, at the same step.
TEST(LiquidLaw, TheStepFollowsFromTheStiffnessThatALawReports) {
  Mesh mesh = block({12, 2, 2}, {0, 0, 0}, {0.012, 0.002, 0.002}, Region::mercury);
  fix(mesh, 1, plane(0, 0));
  fix(mesh, 2, plane(1, 0));
  fix(mesh, 4, plane(2, 0));
  const ExplicitSolver solver(mesh, steel());
  const std::vector<ObservationRow> rows{component(nearest(mesh, {0.012, 0.002, 0.002}), 0)};
  for (const char* precision : {"double", "single"})
    for (const std::size_t runs : {1, 2}) {
      RunSetup s = linear_setup(4e-5, 1e-6);
      s.liquid.viscosity = 500;
      s.energies.assign(runs, 1.0);
      s.p0.assign(mesh.elements.size(), 1e6);
      s.pulse_length = 8e-6;
      SolveOptions o;
      o.precision = precision;
      RunSetup same = s;
      same.liquid.bulk_modulus *= 4;
      same.hourglass /= 4;
      const auto reference = solver.solve(same, rows, o), base = solver.solve(s, rows, o);
      s.liquid_law = std::make_shared<Stiffer>(s.liquid, 4, true);
      const auto stiff = solver.solve(s, rows, o);
      EXPECT_LE(stiff.time_step, reference.time_step * (1 + 1e-12));  // the bound of the damping is on the safe side
      EXPECT_GT(stiff.time_step, 0.7 * reference.time_step);
      SolveOptions alike = o;
      alike.time_step_safety = 0.3;
      EXPECT_LT(greatest_difference(solver.solve(same, rows, alike), solver.solve(s, rows, alike)), 0.02);
      // Controls: the base liquid takes a longer step, and the same law is unstable at that step when it does not report its stiffness.
      EXPECT_GT(base.time_step, 1.5 * stiff.time_step);
      s.liquid_law = std::make_shared<Stiffer>(s.liquid, 4, false);
      EXPECT_THROW((void)solver.solve(s, rows, o), NumericsError);
    }
}

// A mass hits a column of one element: (rho V / 2) x'' = A p(x / h). At the greatest compression the stored energy is the energy of the mass.
TEST(LiquidLaw, AStiffeningLiquidDeformsAccordingToItsEnergy) {
  const double h = 0.001, m = 10.8, speed = 100;
  Mesh mesh = block({1, 1, 1}, {0, 0, 0}, {h, h, h}, Region::mercury);
  fix(mesh, 2 | 4, everywhere());
  fix(mesh, 1, plane(0, 0));
  const ExplicitSolver solver(mesh, steel());
  RunSetup s = linear_setup(0, 0);
  s.hourglass = 0;
  s.initial_velocity = field(mesh, [&](const Vec3& x) { return Vec3{x[0] > h / 2 ? -speed : 0, 0, 0}; });
  const auto law = std::make_shared<Tait>(s.liquid.bulk_modulus, m, 0.06);
  const double energy = 0.25 * s.liquid_density * speed * speed;  // energy of the moving half, per volume
  double low = 0, high = 0.06;
  for (int i = 0; i < 60; ++i) (law->stored(-(low + high) / 2) < energy ? low : high) = (low + high) / 2;
  const double expected = low, linear = std::sqrt(2 * energy / s.liquid.bulk_modulus);
  const auto greatest_compression = [&](const RunSetup& setup) {
    SolveOptions o;
    o.time_step_safety = 0.03;
    o.every_step = true;
    o.energy_balance = true;
    const auto out = solver.solve(setup, std::vector<ObservationRow>{component(nearest(mesh, {h, 0, 0}), 0)}, o);
    EXPECT_LT(out.energy_balance_error, 1e-9);
    EXPECT_LE(out.time_step, 0.03 * 2 / std::sqrt(2 * setup.liquid_stiffness() / setup.liquid_density) * h * (1 + 1e-9));
    return -*std::min_element(out.observations.begin(), out.observations.end()) / h;
  };
  s.output_interval = s.end = 4 * h / mercury_speed;
  EXPECT_NEAR(greatest_compression(s), linear, 2e-3 * linear);
  s.liquid_law = law;
  measured("greatest_compression", greatest_compression(s));
  EXPECT_NEAR(greatest_compression(s), expected, 2e-3 * expected);
  EXPECT_GT(linear, 1.05 * expected);  // control: without stiffening the column is compressed further
  // A faster mass exceeds the strain for which the step was made, and the error names the place.
  for (auto& v : s.initial_velocity) v[0] *= 2;
  try {
    (void)greatest_compression(s);
    FAIL() << "it should have been refused";
  } catch (const NumericsError& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("compressed beyond what the step was made for, in mercury element 0"));
  }
}
