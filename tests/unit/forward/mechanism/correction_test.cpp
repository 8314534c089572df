// Correction terms without a named mechanism, each compared with the law or the numbers that it must reproduce.
#include "forward/mechanism/correction.hpp"

#include "forward/target/built_in_model.hpp"
#include "forward/target/correction_groups.hpp"
#include "forward/mechanism/cavitation_kinetics.hpp"
#include "tests/unit/forward/target/small_case.hpp"
#include "tests/unit/forward/mechanism/column.hpp"
#include "tests/verification/one_point.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

constexpr double of_mercury = mercury_density * mercury_speed * mercury_speed, gives_way = 1.5e5, step = 2e-7;
const Riemer plain{of_mercury, gives_way, 2000};
const MercuryZone everything{-anywhere, anywhere, -anywhere, anywhere};

double driven(double t) { return 4e-4 * std::sin(2.1e5 * t) * std::sin(3e4 * t) + 1e-4 * std::sin(0.9e5 * t); }
double heated(double t) { return 5e6 * std::min(1.0, t / 7e-7); }

/// Pressures of a law under this drive.
std::vector<double> pressures(const LiquidLaw& law) {
  DrivenPoint point(law, step);
  std::vector<double> all;
  for (int n = 1; n < 2000; ++n) all.push_back(point.step(driven(n * step), heated(n * step)));
  return all;
}
CorrectedLiquid corrected(const MercuryTerms& terms, const MercuryZone& zone = everything) { return {plain, {{terms, zone}}}; }

double apart(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most / (of_mercury * 5e-4);
}

/// The same of Riemer's law with other numbers.
std::vector<double> riemers(const Riemer& law) {
  std::vector<double> all;
  for (int n = 1; n < 2000; ++n) all.push_back(law.pressure(heated(n * step), driven(n * step), (driven(n * step) - driven((n - 1) * step)) / step));
  return all;
}

/// The small box with this correction.
ForwardCase with_term(const std::map<std::string, double>& set, ForwardCase c = small_case(), const char* name = "correction_1") {
  c.mechanisms.push_back({name, &correction(), values_of(correction(), set)});
  return c;
}
std::vector<double> records(const ForwardCase& c, int pulses = 1) {
  const auto p = BuiltInModel(c, {.pulses = pulses}).evaluate({});
  EXPECT_TRUE(p.ok) << p.message;
  return p.mean;
}

}  // namespace

// Where Riemer's law with other numbers has the same effect, a term reproduces it. Outside its part of the target a term does nothing.
TEST(Correction, TermsOfTheMercuryAreOtherNumbersOfRiemersLaw) {
  const auto base = riemers(plain);
  EXPECT_LT(apart(pressures(corrected({})), base), 1e-12);
  EXPECT_LT(apart(pressures(corrected({.stiffness = 0.1})), riemers({1.1 * of_mercury, gives_way, 2000})), 1e-12);
  EXPECT_LT(apart(pressures(corrected({.cutoff = 0.5})), riemers({of_mercury, 1.5 * gives_way, 2000})), 1e-12);
  EXPECT_LT(apart(pressures(corrected({.viscosity = 3000})), riemers({of_mercury, gives_way, 5000})), 1e-12);
  const MercuryTerms all{.stiffness = 0.1, .cutoff = 0.5, .viscosity = 3000, .quadratic_viscosity = 5, .lag = 0.2, .void_lag = 1e-5};
  EXPECT_LT(apart(pressures(corrected(all, {0.1, anywhere, -anywhere, anywhere})), base), 1e-12);
  for (const MercuryTerms& one :
       {MercuryTerms{.stiffness = 0.1}, {.cutoff = 0.5}, {.viscosity = 3000}, {.quadratic_viscosity = 5}, {.lag = 0.2}, {.void_lag = 1e-5}})
    EXPECT_GT(apart(pressures(corrected(one)), base), 1e-4);
  EXPECT_EQ(apart(pressures(CorrectedLiquid(plain, {{{.stiffness = 0.1}, everything}, {{.viscosity = 3000}, everything}})),
                  pressures(corrected({.stiffness = 0.1, .viscosity = 3000}))),
            0);
}

// Voids that close late follow the kinetic law. A quadratic viscosity acts as that of a rate. The late share of a constant pressure has its time constant.
TEST(Correction, LateAndQuadraticTermsFollowTheirFormulas) {
  const Riemer calm{of_mercury, gives_way, 0};
  const CorrectedLiquid late(calm, {{{.void_lag = 1e-5}, everything}});
  EXPECT_LT(apart(pressures(late), pressures(KineticLiquid(calm, 0, 1e-5))), 1e-9);

  const CorrectedLiquid quadratic(calm, {{{.quadratic_viscosity = 20}, everything}});
  DrivenPoint closing(quadratic, step);
  const double strain = -1e-5, rate = strain / step;
  EXPECT_NEAR(closing.step(strain), -of_mercury * strain + 20 * rate * rate, 1e-6 * of_mercury * 1e-5);

  const CorrectedLiquid lagging(calm, {{{.lag = 0.3}, everything}});
  DrivenPoint held(lagging, step);
  for (int n = 1; n < 200; ++n)
    EXPECT_NEAR(held.step(-1e-4), of_mercury * 1e-4 * (1 - 0.3 * std::exp(-n * step / CorrectedLiquid::lag_time)), 1e-9 * of_mercury * 1e-4);
}

// Mass and drag on the walls, and drag along them, are compared with runs that have the same effect by other numbers. Off, they leave the base bytes.
TEST(Correction, TermsOfAWallActOnItsNodes) {
  for (const int pulses : {1, 2}) {
    const auto base = records(small_case(), pulses);
    EXPECT_EQ(records(with_term({}), pulses), base);
    for (const char* key : {"mass", "damping", "slip"}) {
      const double size = key == std::string("mass") ? 10 : 1e6;
      const auto top = records(with_term({{key, size}, {"wall", 3}}), pulses),
                 far = records(with_term({{key, size}, {"wall", 3}, {"begin", 1}, {"end", 2}}), pulses);
      EXPECT_GT(greatest_difference(top, base), 1e-3) << key;
      EXPECT_EQ(far, base) << key;  // the wall has no such nodes
    }
  }
  // Mass on all nodes of the steel replaces a part of its density.
  const BuiltInModel model(small_case(), {.pulses = 1});
  RunSetup heavier = model.setup(model.forward_case(), model.mesh(), 0, {1.0}), carrying = heavier;
  heavier.steel_density *= 1.3;
  RunSetup without = carrying;
  without.liquid_density = 1e-9;
  const Eigen::VectorXd steel_mass = masses(model.mesh(), without);
  for (const double m : steel_mass) carrying.node_mass.push_back(0.3 * m);
  std::vector<ObservationRow> rows{{model.gauges()[0].axial.nodes, model.gauges()[0].axial.weights}};
  const ExplicitSolver solver(model.mesh(), heavier.steel);
  const auto with_mass = solver.solve(carrying, rows, {}).observations, with_density = solver.solve(heavier, rows, {}).observations;
  EXPECT_LT(greatest_difference(with_mass, with_density), 1e-9);
  // Drag on these nodes replaces mass-proportional damping.
  RunSetup damped = model.setup(model.forward_case(), model.mesh(), 0, {1.0}), dragged = damped;
  damped.steel_mass_damping = 2e4;
  for (const double m : steel_mass) dragged.node_damping.push_back(2e4 * m);
  EXPECT_LT(greatest_difference(solver.solve(dragged, rows, {}).observations, solver.solve(damped, rows, {}).observations), 1e-9);
}

// Mercury with unlimited drag along the walls moves as if it shared their nodes. The energy balance closes with all terms of a wall.
TEST(Correction, DragAlongWallsHoldsTheMercury) {
  ForwardCase closed = small_case();
  closed.mercury.law = "linear";
  closed.geometry.wetted = "no_separation";
  const auto slipping = records(closed);
  ForwardCase dragged = closed, tied = closed;
  int n = 0;
  for (const double wall : {0, 1, 3, 4}) dragged = with_term({{"slip", 1e12}, {"wall", wall}}, dragged, ("correction_" + std::to_string(++n)).c_str());
  tied.geometry.wetted = "tied";
  const auto held = records(tied);
  EXPECT_LT(greatest_difference(records(dragged), held), 0.3 * greatest_difference(slipping, held));
  EXPECT_GT(greatest_difference(slipping, held), 1e-3);

  const BuiltInModel model(with_term({{"slip", 1e6}, {"damping", 1e6}, {"mass", 10}, {"wall", 3}}), {.pulses = 1});
  SolveOptions balanced;
  balanced.energy_balance = true;
  std::vector<ObservationRow> rows{{model.gauges()[0].axial.nodes, model.gauges()[0].axial.weights}};
  const RunSetup setup = model.setup(model.forward_case(), model.mesh(), 0, {1.0});
  const auto out = ExplicitSolver(model.mesh(), setup.steel).solve(setup, rows, balanced);
  EXPECT_LT(out.energy_balance_error, 2e-3);
  EXPECT_GT(out.dissipated, 0);
}

// Two small corrections in two parts of the mercury add in one run. A liquid law of its own accepts none.
TEST(Correction, SeveralActInOneRun) {
  const std::map<std::string, double> front{{"stiffness", 1e-3}, {"x_end", 0.02}}, back{{"viscosity", 50}, {"x_begin", 0.03}};
  const auto base = records(with_term({{"stiffness", 1e-12}})), first = records(with_term(front)),
             second = records(with_term(back, small_case(), "correction_2")), both = records(with_term(back, with_term(front), "correction_2"));
  double off = 0, size = 0;
  for (std::size_t i = 0; i < base.size(); ++i)
    off = std::max(off, std::abs(both[i] - first[i] - second[i] + base[i])), size = std::max(size, std::abs(both[i] - base[i]));
  EXPECT_LT(off, 0.2 * size);
  ForwardCase kinetic = small_case("[mechanism.cavitation_kinetics]\nenabled = true\ngrowth_time = 1e-6\n");
  const auto refused = BuiltInModel(with_term(front, kinetic), {.pulses = 1}).evaluate({});
  EXPECT_FALSE(refused.ok);
  EXPECT_NE(refused.message.find("a law of its own"), std::string::npos) << refused.message;
  EXPECT_FALSE(records(with_term({{"mass", 1.0}, {"wall", 3}}, kinetic)).empty());
}

TEST(Correction, GroupsCoverMercuryAndWalls) {
  const auto groups = correction_groups(small_case());
  std::size_t whole = 0, walls = 0;
  for (const auto& g : groups) {
    ASSERT_EQ(g.added.size(), 1u);
    EXPECT_EQ(g.added[0].strengths.size(), 1u);
    whole += g.place == "in all of the mercury";
    walls += g.name == "mass";
    EXPECT_EQ(g.place.find("the side"), std::string::npos);  // a slice has no such part
  }
  EXPECT_EQ(whole, 6u);
  EXPECT_EQ(walls, 15u);                             // front, top and bottom, each with its quarters, and no rear wall
  const AddedParameter& third = groups[2].added[0];  // each place has a correction of its own
  EXPECT_EQ(third.parameter.key.find("mechanism.correction_3."), 0u);
  for (const auto& [key, value] : third.with) EXPECT_EQ(key.find("mechanism.correction_3."), 0u);
}
