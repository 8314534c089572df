// Fields of a run beyond the base model: heat in the steel, a stress before the run, faces that separate.
#include "base/random.hpp"
#include "forward/solver/explicit_solver.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

const double youngs = young, lambda = steel().lambda, mu = steel().mu;

/// A bar of steel on three symmetry planes, free otherwise or held on its whole surface; `distorted`: general hexahedra.
Mesh bar(bool distorted, bool held = false) {
  Mesh m = block({6, 3, 3}, {0, 0, 0}, {0.012, 0.006, 0.006}, Region::steel);
  if (distorted) {
    RandomStream random(3, 0);
    for (auto& x : m.nodes)
      for (std::size_t c = 0; c < 3; ++c)
        if (x[0] > 1e-9 && x[0] < 0.0119 && x[1] > 1e-9 && x[1] < 0.0059 && x[2] > 1e-9 && x[2] < 0.0059) x[c] += 2e-4 * random.uniform(-1, 1);
  }
  for (const int axis : {0, 1, 2}) {
    fix(m, held ? 7 : 1 << axis, plane(axis, 0));
    if (held) fix(m, 7, plane(axis, axis == 0 ? 0.012 : 0.006));
  }
  return m;
}

/// The run is long enough, and critically damped in the slowest mode, so that the bar comes to rest.
RunSetup settling() {
  RunSetup s = linear_setup(1e-4, 1e-4);
  s.steel_mass_damping = 2 * M_PI / 2 * std::sqrt(young / steel_density) / 0.012;
  return s;
}

double volume(const Mesh& mesh) {
  double v = 0;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) v += hexahedron::volume(hexahedron::corners(mesh, e));
  return v;
}

struct Settled {
  SolveSummary summary;
  double worst = 0;                 ///< greatest distance of a node from its expected place [m]
  double stress = 0, pressure = 0;  ///< greatest stress at the end [Pa]
};

/// Runs to the end and compares every node with u_c = stretch_c x_c, each run with its own stretches.
Settled settle(const Mesh& mesh, const RunSetup& s, SolveOptions o, const std::vector<Vec3>& stretch) {
  Settled out;
  o.field_interval = s.end;
  o.on_field = [&](const FieldSnapshot& f) {
    out.stress = *std::max_element(f.effective_stress.begin(), f.effective_stress.end());
    out.pressure = 0;
    for (const double p : f.pressure) out.pressure = std::max(out.pressure, std::abs(p));
  };
  out.summary = ExplicitSolver(mesh, steel()).solve(s, all_components(mesh), o);
  const std::size_t times = out.summary.times.size(), rows = 3 * mesh.nodes.size();
  for (std::size_t l = 0; l < stretch.size(); ++l)
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
      for (std::size_t c = 0; c < 3; ++c)
        out.worst = std::max(out.worst, std::abs(out.summary.observations[(l * rows + 3 * n + c + 1) * times - 1] - stretch[l][c] * mesh.nodes[n][c]));
  return out;
}

}  // namespace

// A free bar that is heated evenly grows by alpha dT in every direction and has no stress.
TEST(ThermalStrain, AFreeBarGrowsByItAndCarriesNoStress) {
  const double a = 1.6e-4;  // 10 K
  for (const bool distorted : {false, true})
    for (const char* kinematics : {"small", "finite"})
      for (const char* precision : {"double", "single"})
        for (const std::size_t runs : {1, 2}) {
          const Mesh mesh = bar(distorted);
          RunSetup s = settling();
          s.thermal_strain.assign(mesh.elements.size(), a);
          s.pulse_length = 2e-6;
          if (runs == 2) s.energies = {0.8, 1.1};
          SolveOptions o;
          o.kinematics = kinematics;
          o.precision = precision;
          o.energy_balance = runs == 1;
          const bool finite = *kinematics == 'f', twice = *precision == 'd';
          std::vector<Vec3> stretch;
          for (const double energy : s.energies) stretch.push_back(Vec3{1, 1, 1}), stretch.back().fill(finite ? std::sqrt(1 + 2 * a * energy) - 1 : a * energy);
          const Settled hot = settle(mesh, s, o, stretch);
          const std::string name = std::string(distorted ? "general_" : "parallelepiped_") + kinematics + '_' + precision + '_' + std::to_string(runs);
          measured(name, hot.worst / (a * 0.012));
          EXPECT_LT(hot.worst, (twice ? 1e-7 : 2e-4) * a * 0.012) << name;
          EXPECT_LT(hot.stress, (twice ? 1e-6 : 1e-2) * youngs * a) << name;
          EXPECT_LT(hot.pressure, (twice ? 1e-6 : 1e-2) * youngs * a) << name;
          s.thermal_strain.clear();  // control: without heat it remains at rest
          EXPECT_EQ(settle(mesh, s, o, {Vec3{}}).worst, 0) << name;
        }
}

// A bar that is held on its surface gets the pressure (3 lambda + 2 mu) alpha dT. The heat adds the energy that this stores, however fast it comes.
TEST(ThermalStrain, AHeldBarComesUnderPressure) {
  const double a = 1.6e-4, pressure = (3 * lambda + 2 * mu) * a;
  const Mesh mesh = bar(true, true);
  for (const double pulse : {0.0, 2e-6}) {
    RunSetup s = linear_setup(4e-6, 4e-6);
    s.thermal_strain.assign(mesh.elements.size(), a);
    s.pulse_length = pulse;
    SolveOptions o;
    o.energy_balance = true;
    const Settled held = settle(mesh, s, o, {Vec3{}});
    EXPECT_LT(held.worst, 1e-12 * a * 0.012);
    EXPECT_NEAR(held.pressure, pressure, 1e-9 * pressure);
    EXPECT_LT(held.stress, 1e-6 * pressure);
    EXPECT_NEAR(held.summary.energy_in, 1.5 * a * pressure * volume(mesh), 1e-9 * held.summary.energy_in);
  }
}

// Unevenly heated steel under stress moves: the energy that the heat adds is stored or kinetic.
TEST(ThermalStrain, EnergyIsKept) {
  for (const bool distorted : {false, true})
    for (const char* kinematics : {"small", "finite"})
      for (const bool stressed : {false, true}) {
        const Mesh mesh = bar(distorted);
        RunSetup s = linear_setup(2e-5, 2e-5);
        s.pulse_length = 0.7e-6;
        for (std::size_t e = 0; e < mesh.elements.size(); ++e) s.thermal_strain.push_back(1e-4 * std::exp(-double(e % 6)));
        if (stressed) s.initial_stress.assign(mesh.elements.size(), {30e6, -10e6, 20e6, 5e6, -3e6, 8e6});
        SolveOptions o;
        o.energy_balance = true;
        o.kinematics = kinematics;
        const auto out = ExplicitSolver(mesh, steel()).solve(s, {}, o);
        measured("balance", out.energy_balance_error);
        EXPECT_LT(out.energy_balance_error, *kinematics == 'f' ? 1e-3 : 1e-9) << distorted << stressed;
        EXPECT_GT(out.energy_in, 0);
      }
}

// A bar that is heated at once moves like one without heat that is released from -alpha dT x. The damping of the steel dissipates the same, which is counted
// separately.
TEST(ThermalStrain, DampingTakesWhatItTakesFromTheSameMotion) {
  const double a = 1e-4;
  for (const bool distorted : {false, true}) {
    const Mesh mesh = bar(distorted);
    RunSetup heated = linear_setup(2e-5, 1e-6), cold = heated;
    heated.steel_stiffness_damping = cold.steel_stiffness_damping = 2e-8;
    heated.thermal_strain.assign(mesh.elements.size(), a);
    cold.initial_displacement = field(mesh, [&](const Vec3& x) { return Vec3{-a * x[0], -a * x[1], -a * x[2]}; });
    SolveOptions o;
    o.energy_balance = true;
    const std::vector<ObservationRow> rows{component(nearest(mesh, {0.012, 0.006, 0.006}), 0)};
    const ExplicitSolver solver(mesh, steel());
    const auto hot = solver.solve(heated, rows, o), let_go = solver.solve(cold, rows, o);
    for (std::size_t i = 0; i < hot.times.size(); ++i) EXPECT_NEAR(hot.observations[i] - a * 0.012, let_go.observations[i], 1e-9 * a * 0.012);
    EXPECT_NEAR(hot.dissipated, let_go.dissipated, 1e-9 * let_go.dissipated);
    EXPECT_GT(let_go.dissipated, 0.05 * let_go.energy_in);
    EXPECT_NEAR(hot.energy_in, 1.5 * a * (3 * lambda + 2 * mu) * a * volume(mesh), 1e-9 * hot.energy_in);
  }
}

// A stress before the run acts at once, and a free bar deforms until it is gone: epsilon = -C^-1 sigma.
TEST(InitialStress, AFreeBarRelievesItAndAHeldOneKeepsIt) {
  const std::array<double, 6> sigma{30e6, -10e6, 20e6, 0, 0, 0};
  const double trace = sigma[0] + sigma[1] + sigma[2];
  Vec3 stretch{};
  double stored = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double strain = ((1 + poisson) * sigma[c] - poisson * trace) / young;  // Hooke's law
    stretch[c] = -strain;
    stored += 0.5 * sigma[c] * strain;
  }
  const double mises = std::sqrt(0.5 * (40e6 * 40e6 + 30e6 * 30e6 + 10e6 * 10e6));
  for (const bool distorted : {false, true})
    for (const std::size_t runs : {1, 2}) {
      const Mesh mesh = bar(distorted), fixed = bar(distorted, true);
      RunSetup s = settling();
      s.initial_stress.assign(mesh.elements.size(), sigma);
      s.energies.assign(runs, 1.0);
      SolveOptions o;
      o.energy_balance = runs == 1;
      const Settled free = settle(mesh, s, o, std::vector<Vec3>(runs, stretch)), held = settle(fixed, s, o, std::vector<Vec3>(runs, Vec3{}));
      EXPECT_LT(free.worst, 1e-7 * std::abs(stretch[0]) * 0.012);
      EXPECT_LT(free.stress, 1e-6 * mises);
      EXPECT_LT(held.worst, 1e-12 * std::abs(stretch[0]) * 0.012);
      EXPECT_NEAR(held.stress, mises, 1e-9 * mises);
      EXPECT_NEAR(held.pressure, trace / 3, 1e-9 * trace);
      if (runs > 1) continue;
      EXPECT_NEAR(held.summary.energy_in, stored * volume(mesh), 1e-9 * stored * volume(mesh));
      EXPECT_GE(free.summary.greatest_stress, mises * (1 - 1e-9));
    }
}

namespace {

/// Mercury on 0 < x < 0.05 m that moves along x only, with x = 0 fixed.
Mesh mercury_column(bool rear) {
  Mesh m = block({50, 1, 1}, {0, 0, 0}, {0.05, 0.001, 0.001}, Region::mercury);
  fix(m, 2 | 4, everywhere());
  fix(m, 1, plane(0, 0));
  if (rear) m.rear = faces_at(m, 0, 0.05);
  return m;
}

/// p = p0 - K e_v as a LiquidLaw.
class Linear : public LiquidLaw {
 public:
  explicit Linear(double k) : k_(k) {}
  void advance(const LiquidPoints& p) const override {
    for (std::size_t i = 0; i < p.count; ++i) p.pressure[i] = p.heating[i] - k_ * p.strain[i];
  }

 private:
  double k_;
};

}  // namespace

// Mercury under pressure leaves a free face at p / (rho c), by Riemer's law and by one of its own. Mercury of the same pressure behind the rear face holds it.
TEST(InitialStress, MercuryUnderPressurePushesAFreeFaceAndRestsAgainstItsLike) {
  const double p = 1e6, end = 2e-5;
  for (const bool own : {false, true})
    for (const std::size_t runs : {1, 2})
      for (const bool rear : {false, true}) {
        const Mesh mesh = mercury_column(rear);
        RunSetup s = linear_setup(end, end);
        s.energies.assign(runs, 1.0);
        s.initial_stress.assign(mesh.elements.size(), {-p, -p, -p, 0, 0, 0});
        if (own) s.liquid_law = std::make_shared<Linear>(s.liquid.bulk_modulus);
        const auto out = ExplicitSolver(mesh, steel()).solve(s, std::vector<ObservationRow>{component(nearest(mesh, {0.05, 0, 0}), 0)}, {});
        const double free = p / (mercury_density * mercury_speed) * end;
        EXPECT_NEAR(out.observations[1], rear ? 0 : free, (rear ? 1e-12 : 0.02) * free) << own << runs << rear;
      }
}

// Mercury under tension separates from the start, where a linear liquid would hold.
TEST(InitialStress, TensionBeforeTheRunStopsAtTheCutoff) {
  Mesh mesh = mercury_column(false);
  fix(mesh, 7, everywhere());
  for (const double cutoff : {1.5e5, std::numeric_limits<double>::infinity()}) {
    RunSetup s = linear_setup(1e-6, 1e-6);
    s.liquid.tensile_cutoff = cutoff;
    s.initial_stress.assign(mesh.elements.size(), {4e5, 4e5, 4e5, 0, 0, 0});
    SolveOptions o;
    o.field_interval = 1e-6;
    o.energy_balance = true;
    o.on_field = [&](const FieldSnapshot& f) {
      EXPECT_NEAR(f.pressure[7], -std::min(cutoff, 4e5), 1e-6);
      EXPECT_NEAR(f.time_at_cutoff[7], std::isfinite(cutoff) ? f.time : 0, 1e-12);
    };
    (void)ExplicitSolver(mesh, steel()).solve(s, {}, o);
  }
}

TEST(RunFields, TheElementThatChecksTheFastOneRefusesThem) {
  const Mesh mesh = bar(false);
  RunSetup s = settling();
  s.thermal_strain.assign(mesh.elements.size(), 1e-4);
  SolveOptions o;
  o.steel_element = "b_bar";
  EXPECT_THROW((void)ExplicitSolver(mesh, steel()).solve(s, {}, o), InputError);
}

namespace {

/// For each node, whether an element of the region has it.
std::vector<bool> nodes_in(const Mesh& mesh, Region region) {
  std::vector<bool> in(mesh.nodes.size(), false);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    if (mesh.region[e] == region)
      for (const NodeId n : mesh.elements[e]) in[std::size_t(n)] = true;
  return in;
}

/// Mercury on -0.04 < x < 0 m against steel on 0 < x < 0.04 m. All motion is along x, and both ends are free.
struct WettedFace {
  WettedFace() : mesh(block({80, 1, 1}, {-0.04, 0, 0}, {0.04, 0.001, 0.001}, [](const Vec3& x) { return x[0] < 0 ? Region::mercury : Region::steel; })) {
    fix(mesh, 2 | 4, everywhere());
    split(mesh, {Vec3{1, 0, 0}});
    mesh.wetted = faces_at(mesh, 0, 0);
    in_mercury = nodes_in(mesh, Region::mercury);
  }
  /// The mercury moves with this velocity and begins at a distance from the steel.
  [[nodiscard]] RunSetup moving(double velocity, double gap, double strength, double end) const {
    RunSetup s = linear_setup(end, end / 200);
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      s.initial_velocity.push_back({in_mercury[n] ? velocity : 0, 0, 0});
      s.initial_displacement.push_back({in_mercury[n] ? -gap : 0, 0, 0});
    }
    s.slip_strength.assign(mesh.slip.size(), strength);
    return s;
  }
  /// Sum of mass times displacement of the steel (or of everything); its rate is the momentum.
  [[nodiscard]] ObservationRow moment(const RunSetup& s, bool all) const {
    const auto m = masses(mesh, s);
    ObservationRow row;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
      if (all || !in_mercury[n]) row.nodes.push_back(NodeId(n)), row.weights.push_back({m[Eigen::Index(n)], 0, 0});
    return row;
  }
  [[nodiscard]] NodeId wall() const { return mesh.slip[0].steel; }
  Mesh mesh;
  std::vector<bool> in_mercury;
};

const double never = std::numeric_limits<double>::infinity();
const double z_mercury = mercury_density * mercury_speed, z_steel = steel_density * steel_speed();

}  // namespace

// Mercury that moves away from a face without strength leaves the steel at rest and remains unstrained. From a face that holds, it pulls.
TEST(OpeningFace, CarriesNoTension) {
  const WettedFace face;
  for (const char* precision : {"double", "single"})
    for (const std::size_t runs : {1, 3}) {
      RunSetup s = face.moving(-1, 0, 0, 3e-5);
      s.energies.assign(runs, 1.0);
      SolveOptions o;
      o.precision = precision;
      const ExplicitSolver solver(face.mesh, steel());
      const std::vector<ObservationRow> rows{component(face.wall(), 0), component(face.mesh.slip[0].mercury, 0)};
      const auto open = solver.solve(s, rows, o);
      for (std::size_t l = 0; l < runs; ++l) {
        EXPECT_EQ(open.observations[(2 * l + 1) * open.times.size() - 1], 0);
        EXPECT_NEAR(open.observations[(2 * l + 2) * open.times.size() - 1], -3e-5, *precision == 'd' ? 1e-15 : 1e-9);
      }
      s.slip_strength.assign(face.mesh.slip.size(), never);
      const auto held = solver.solve(s, rows, o);
      const double speed = z_mercury / (z_mercury + z_steel);  // of the face, until waves return from the ends
      EXPECT_NEAR(row_of(held, 0)[80] / held.times[80], -speed, 0.05 * speed);
      s.slip_strength.clear();  // control: the bytes of the base model
      EXPECT_EQ(solver.solve(s, rows, o).observations, held.observations);
    }
}

// A face holds up to its strength. Under a pull that grows smoothly to Z_m Z_s / (Z_m + Z_s) v it opens at half of that strength and not at twice.
TEST(OpeningFace, HoldsUpToItsStrength) {
  const WettedFace face;
  const double v = 0.5, pull = z_mercury * z_steel / (z_mercury + z_steel) * v;
  const ExplicitSolver solver(face.mesh, steel());
  const std::vector<ObservationRow> rows{component(face.wall(), 0)};
  const auto history = [&](double strength) {
    RunSetup s = face.moving(0, 0, strength, 2e-5);
    for (std::size_t n = 0; n < face.mesh.nodes.size(); ++n)
      if (face.in_mercury[n]) s.initial_velocity[n][0] = -v * 0.5 * (1 - std::cos(M_PI * std::min(1.0, -face.mesh.nodes[n][0] / 0.01)));
    return solver.solve(s, rows, {}).observations;
  };
  const auto held = history(never);
  EXPECT_EQ(history(2 * pull), held);
  const auto weak = history(0.5 * pull);
  EXPECT_NE(weak, held);
  // The steel leaves with at most the velocity that the strength gives it.
  double fastest = 0, fastest_held = 0;
  for (std::size_t i = 1; i < 130; ++i)
    fastest = std::max(fastest, (weak[i - 1] - weak[i]) / 1e-7), fastest_held = std::max(fastest_held, (held[i - 1] - held[i]) / 1e-7);
  EXPECT_NEAR(fastest, 0.5 * pull / z_steel, 0.1 * pull / z_steel);
  EXPECT_NEAR(fastest_held, pull / z_steel, 0.1 * pull / z_steel);
}

// Mercury meets the steel over a gap: momentum is conserved, the face moves with Z_m v / (Z_m + Z_s), and the impact does not bounce. Its loss is counted. The
// steel is pushed and never pulled.
TEST(OpeningFace, ClosesWhenTheGapIsGoneAndNeverPulls) {
  const WettedFace face;
  const double v = 2, gap = 2e-6, end = 8e-5;  // they meet after 1 us; a wave returns from the mercury's free end after 55 us
  const ExplicitSolver solver(face.mesh, steel());
  RunSetup s = face.moving(v, gap, 0, end);
  const std::vector<ObservationRow> rows{component(face.wall(), 0), face.moment(s, false), face.moment(s, true), component(face.mesh.slip[0].mercury, 0)};
  SolveOptions o;
  o.energy_balance = true;
  o.every_step = true;
  const auto out = solver.solve(s, rows, o);
  const auto wall = row_of(out, 0), pushed = row_of(out, 1), all = row_of(out, 2), mercury = row_of(out, 3);
  const double dt = out.time_step;
  const auto at = [&](double t) { return std::size_t(std::lround(t / dt)); };
  EXPECT_EQ(wall[at(0.9e-6)], 0);
  const double speed = z_mercury * v / (z_mercury + z_steel);
  EXPECT_NEAR((wall[at(12e-6)] - wall[at(4e-6)]) / (double(at(12e-6) - at(4e-6)) * dt), speed, 0.03 * speed);
  const double momentum = (all[1] - all[0]) / dt;
  double least_gap = 1, greatest_gap = 0, least_push = 1;
  for (std::size_t i = 1; i + 1 < wall.size(); ++i) {
    EXPECT_NEAR((all[i + 1] - all[i]) / dt, momentum, 1e-9 * momentum);
    least_push = std::min(least_push, (pushed[i + 1] - 2 * pushed[i] + pushed[i - 1]) / (dt * momentum));
    least_gap = std::min(least_gap, wall[i] - mercury[i]);
    if (i > at(2e-6) && i < at(12e-6)) greatest_gap = std::max(greatest_gap, wall[i] - mercury[i]);
  }
  EXPECT_GE(least_push, -1e-9);                                         // the steel is never pulled
  EXPECT_GE(least_gap, -1e-9 * gap);                                    // nothing overlaps
  EXPECT_LE(greatest_gap, 1e-9 * gap);                                  // they remain together
  EXPECT_GT(wall[wall.size() - 1] - mercury[mercury.size() - 1], gap);  // and separate when the pull comes
  const auto m = masses(face.mesh, s);
  double lost = 0;
  for (const auto& pair : face.mesh.slip) lost += 0.5 * m[pair.steel] * m[pair.mercury] / (m[pair.steel] + m[pair.mercury]) * v * v;
  const auto once = solver.solve(face.moving(v, gap, 0, 1.2e-5), rows, o);  // the loss of the one impact
  EXPECT_NEAR(once.dissipated, lost, 0.1 * lost);                           // and the work of the contact over the remaining gap
  EXPECT_LT(once.energy_balance_error, 1e-9);
  EXPECT_GE(out.dissipated, lost);
  EXPECT_LT(out.energy_balance_error, 1e-9);
  // Control: if they are held together from the start, the steel is pulled too.
  s = face.moving(v, 0, never, end);
  const auto held = solver.solve(s, rows, o);
  const auto swung = row_of(held, 1);
  double greatest_pull = 0;
  for (std::size_t i = 1; i + 1 < swung.size(); ++i) greatest_pull = std::min(greatest_pull, (swung[i + 1] - 2 * swung[i] + swung[i - 1]) / (dt * momentum));
  EXPECT_LT(greatest_pull, -1e-4);
}

// Mercury that cavitates at the face separates and pulls with exactly the cutoff. The waves in the two half spaces give
// v_s = -sigma / Z_s and v_m = -v + sigma / Z_m, and the gap is their difference times the time.
TEST(PartingFace, PullsWithTheCutoffWhileApart) {
  const WettedFace face;
  const double v = 1, cutoff = 0.3 * z_mercury * z_steel / (z_mercury + z_steel) * v;
  const std::vector<ObservationRow> rows{component(face.wall(), 0), component(face.mesh.slip[0].mercury, 0)};
  const ExplicitSolver solver(face.mesh, steel());
  for (const char* precision : {"double", "single"}) {
    RunSetup s = face.moving(-v, 0, never, 1.2e-5);
    s.slip_strength.clear();
    s.wetted_cutoff = cutoff;
    SolveOptions o;
    o.precision = precision;
    o.energy_balance = true;
    const auto out = solver.solve(s, rows, o);
    const auto wall = row_of(out, 0), mercury = row_of(out, 1);
    const auto rate = [&](const auto& u) { return (u[190] - u[60]) / (out.times[190] - out.times[60]); };
    EXPECT_NEAR(rate(wall), -cutoff / z_steel, 0.01 * cutoff / z_steel) << precision;
    EXPECT_NEAR(rate(mercury), -v + cutoff / z_mercury, 0.01 * v) << precision;
    EXPECT_LT(out.energy_balance_error, *precision == 'd' ? 1e-9 : 1e-3);
    s.energies.assign(8, 1.0);  // lanes
    o.energy_balance = false;
    const auto lanes = solver.solve(s, rows, o);
    EXPECT_NEAR(lanes.observations[190], wall[190], *precision == 'd' ? 1e-15 : 1e-9);
    // A face weaker than the mercury carries nothing once it is open.
    s.energies.assign(1, 1.0);
    s.slip_strength.assign(face.mesh.slip.size(), 0.5 * cutoff);
    const auto weak = solver.solve(s, rows, o);
    EXPECT_NEAR(rate(row_of(weak, 1)), -v, 0.01 * v) << precision;
  }
}

// A plate that leaves mercury without strength keeps its own velocity, because no layer of mercury adheres to it. Control: if the faces remain together, half
// an element of mercury adheres and takes its share of the momentum.
TEST(PartingFace, HangsNoMercuryOnTheWall) {
  Mesh mesh = block({44, 1, 1}, {-0.04, 0, 0}, {0.004, 0.001, 0.001}, [](const Vec3& x) { return x[0] < 0 ? Region::mercury : Region::steel; });
  fix(mesh, 2 | 4, everywhere());
  split(mesh, {Vec3{1, 0, 0}});
  mesh.wetted = faces_at(mesh, 0, 0);
  RunSetup s = linear_setup(2e-5, 1e-7);
  s.liquid.tensile_cutoff = 0;
  const auto in_steel = nodes_in(mesh, Region::steel);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) s.initial_velocity.push_back({in_steel[n] ? 1.0 : 0.0, 0, 0});
  const auto m = masses(mesh, s);
  ObservationRow centre;
  double total = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (in_steel[n]) centre.nodes.push_back(NodeId(n)), centre.weights.push_back({m[Eigen::Index(n)], 0, 0}), total += m[Eigen::Index(n)];
  for (auto& w : centre.weights) w[0] /= total;
  const ExplicitSolver solver(mesh, steel());
  const auto flown = [&](double cutoff) {
    s.wetted_cutoff = cutoff;
    const auto out = solver.solve(s, std::vector<ObservationRow>{centre}, {});
    return out.observations.back() / out.times.back();
  };
  EXPECT_NEAR(flown(0), 1, 1e-9);
  const double hangs = 0.5 * mercury_density / (0.5 * mercury_density + 4 * steel_density);  // half an element of mercury beside four of steel
  EXPECT_NEAR(flown(never), 1 - hangs, 0.2 * hangs);
  // A film that adheres to the plate moves with it; the cutoff pulls both back.
  const double pull = 1e5;
  const auto slowed = [&](double film) {
    s.wall_film = film;
    s.wetted_cutoff = pull;
    return 1 - flown(pull);
  };
  const double bare = slowed(0), plate = 4e-3 * steel_density;
  EXPECT_NEAR(bare, 0.5 * pull / plate * s.end, 0.01 * bare);
  for (const double film : {1e-4, 2.5e-4, -1e-4}) EXPECT_NEAR(slowed(film) / bare, plate / (plate + film * mercury_density), 0.005) << film;
  EXPECT_NEAR(slowed(1e-3) / slowed(3e-4), 1, 1e-12);  // the film is at most 0.6 of the half element
}

// With and without a film, momentum and energy are conserved through impacts, in lanes and in single runs. The step is short enough for the lighter mercury.
TEST(PartingFace, AFilmKeepsTheBalance) {
  Mesh mesh = block({6, 4, 8}, {0, 0, 0}, {0.006, 0.004, 0.008}, [](const Vec3& x) { return x[2] > 0.005 ? Region::steel : Region::mercury; });
  split(mesh, {Vec3{0, 0, 1}});
  mesh.wetted = faces_at(mesh, 2, 0.005);
  RunSetup s = linear_setup(1e-4, 1e-6);
  s.wetted_cutoff = s.liquid.tensile_cutoff = 1e4;
  RandomStream random(9, 0);
  s.initial_velocity.resize(mesh.nodes.size());
  for (auto& v : s.initial_velocity)
    for (auto& c : v) c = random.uniform(-1, 1);
  const std::vector<ObservationRow> rows{component(mesh.slip[0].steel, 2), component(mesh.slip[0].mercury, 2)};
  const ExplicitSolver solver(mesh, steel());
  SolveOptions o;
  o.energy_balance = true;
  const auto without = solver.solve(s, rows, o);
  for (const double film : {2e-4, -5e-5}) {
    s.wall_film = film;
    o.energy_balance = true;
    const auto out = solver.solve(s, rows, o);
    EXPECT_LT(out.energy_balance_error, 2 * without.energy_balance_error) << film;
    EXPECT_GT(std::abs(out.observations.back() - without.observations.back()), 1e-3 * std::abs(without.observations.back())) << film;
    s.energies.assign(8, 1.0);
    o.energy_balance = false;
    EXPECT_NEAR(solver.solve(s, rows, o).observations[20], out.observations[20], 1e-6 * std::abs(out.observations[20])) << film;
    s.energies.assign(1, 1.0);
  }
}
