#include "forward/target/built_in_model.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "forward/mesh/make_mesh.hpp"
#include "tests/unit/forward/target/small_case.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

namespace {

const std::string sound_speed = "[parameter.sound_speed]\nmin = 0\nmax = 10000\n";
const std::string law = "[parameter.tensile_cutoff]\nmin = 0\nmax = 1e15\n";

double norm(const std::vector<double>& v) {
  double s = 0;
  for (const double x : v) s += x * x;
  return std::sqrt(s);
}
double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double s = 0;
  for (std::size_t i = 0; i < a.size(); ++i) s += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(s) / norm(b);
}
std::vector<double> run(const std::string& more, std::vector<double> theta = {}, const std::string& load = "peak_pressure = 25e6") {
  return BuiltInModel(small_case(more, load), {.pulses = 1}).evaluate(theta).mean;
}

}  // namespace

// One default: a run made by hand has what a case that says nothing has.
TEST(BuiltInModel, TheMercurysNumericsHaveOneDefault) {
  const BuiltInModel model(small_case(), {.pulses = 1});
  const BuiltInModel other = [] {
    ForwardCase c = small_case();
    c.mercury.hourglass = 0.02;
    c.mercury.collapse_viscosity = 0.7;
    return BuiltInModel(c, {.pulses = 1});
  }();
  EXPECT_EQ(model.setup(model.forward_case(), model.mesh(), 0, {1.0}).hourglass, RunSetup{}.hourglass);
  EXPECT_EQ(RunSetup{}.hourglass, MercuryOptions{}.hourglass);
  EXPECT_EQ(other.setup(other.forward_case(), other.mesh(), 0, {1.0}).hourglass, 0.02);
  EXPECT_EQ(model.setup(model.forward_case(), model.mesh(), 0, {1.0}).collapse_viscosity, RunSetup{}.collapse_viscosity);
  EXPECT_EQ(RunSetup{}.collapse_viscosity, MercuryOptions{}.collapse_viscosity);
  EXPECT_EQ(other.setup(other.forward_case(), other.mesh(), 0, {1.0}).collapse_viscosity, 0.7);
}

TEST(BuiltInModel, ReportsTheElementStepsOfARun) {
  const auto d = BuiltInModel(small_case(), {.pulses = 1}).describe();
  EXPECT_EQ(d.element_steps, double(d.elements) * double(d.steps));
  ForwardCase c = small_case();
  c.geometry.wall_elements = 6;
  c.solver.subcycles = 4;
  const auto cycled = BuiltInModel(c, {.pulses = 1}).describe();
  EXPECT_GT(cycled.subcycles, 1);
  EXPECT_LT(cycled.element_steps, double(cycled.elements) * double(cycled.steps));
  EXPECT_GT(cycled.element_steps, double(cycled.elements) * double(cycled.steps) / cycled.subcycles);
}

// The eight energies of the reference solutions (README of ../shared/data/reference_solutions).
TEST(PulseEnergies, AreTheQuantilesOfThePulseToPulseScatter) {
  const std::array<double, 8> published{0.97699, 0.98669, 0.99267, 0.99764, 1.00236, 1.00733, 1.01331, 1.02301};
  const auto a = pulse_energies({.pulses = 8, .energy_sd = 0.015});
  ASSERT_EQ(a.size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(a[i], published[i], 6e-6);
  EXPECT_THAT(pulse_energies({.pulses = 1}), ::testing::ElementsAre(1.0));
  EXPECT_NEAR(pulse_energies({.pulses = 2, .energy_sd = 0.03})[0], 1 - 0.03 * 0.67449, 1e-6);
}

TEST(BuiltInModel, MeanSlopeAndScatterAreThoseOfItsPulses) {
  const BuiltInModel model(small_case());
  const Prediction p = model.evaluate({});
  ASSERT_TRUE(p.ok) << p.message;
  const std::size_t n = model.shape().values(), m = 8;
  ASSERT_EQ(n, 2u * 41u);
  ASSERT_EQ(p.pulses.size(), m * n);
  double scale = 0, slopes = 0, scatters = 0;
  for (const double v : p.mean) scale = std::max(scale, std::abs(v));
  for (std::size_t i = 0; i < n; ++i) {
    // Least squares y = a + b e over the pulses, by the normal equations; a is reported at the mean energy.
    double se = 0, see = 0, sy = 0, sey = 0;
    for (std::size_t r = 0; r < m; ++r) {
      const double e = p.energies[r], y = p.pulses[r * n + i];
      se += e;
      see += e * e;
      sy += y;
      sey += e * y;
    }
    const double b = (m * sey - se * sy) / (m * see - se * se), a = (sy - b * se) / m;
    double rest = 0;
    for (std::size_t r = 0; r < m; ++r) rest += std::pow(p.pulses[r * n + i] - a - b * p.energies[r], 2);
    EXPECT_NEAR(p.mean[i], sy / m, 1e-6 * scale);
    EXPECT_NEAR(p.energy_slope[i], b, 2e-5 * scale);
    EXPECT_NEAR(p.scatter[i], std::sqrt(rest / (m - 2)), 1e-6 * scale);
    slopes = std::max(slopes, std::abs(b));
    scatters = std::max(scatters, p.scatter[i]);
  }
  EXPECT_GT(scale, 1e-6);
  EXPECT_GT(slopes, 0.5 * scale);  // about proportional to the energy
  EXPECT_GT(scatters, 0);          // but not quite: the cutoff
}

// Zeros there would say that energy changes nothing, and errors of the energy would count for nothing.
TEST(BuiltInModel, PulsesOfOneEnergyGiveNoSlopeAndTwoNoScatter) {
  const auto sizes = [](const EnsembleOptions& o) {
    const Prediction p = BuiltInModel(small_case(), o).evaluate({});
    return std::pair(p.energy_slope.size(), p.scatter.size());
  };
  const std::size_t n = 2 * 41;
  EXPECT_EQ(sizes({.pulses = 1}), std::pair(std::size_t{0}, std::size_t{0}));
  EXPECT_EQ(sizes({.pulses = 2}), std::pair(n, std::size_t{0}));
  EXPECT_EQ(sizes({.pulses = 3}), std::pair(n, n));
  EXPECT_EQ(sizes({.pulses = 10, .energy_sd = 0}), std::pair(std::size_t{0}, n));
}

TEST(BuiltInModel, ALinearLiquidIsProportionalToTheEnergy) {
  const BuiltInModel model(small_case(law));
  const Prediction p = model.evaluate(std::vector<double>{1e15});
  double scale = 0;
  for (const double v : p.mean) scale = std::max(scale, std::abs(v));
  for (std::size_t i = 0; i < p.mean.size(); ++i) {
    EXPECT_NEAR(p.energy_slope[i], p.mean[i], 1e-6 * scale);
    EXPECT_LT(p.scatter[i], 1e-7 * scale);
  }
  // Control: with the cutoff that is not so.
  const Prediction cut = model.evaluate(std::vector<double>{1.5e5});
  double worst = 0;
  for (std::size_t i = 0; i < cut.mean.size(); ++i) worst = std::max(worst, std::abs(cut.energy_slope[i] - cut.mean[i]));
  EXPECT_GT(worst, 1e-3 * scale);
}

TEST(BuiltInModel, ARunWithoutStiffnessFailsWithAMessage) {
  const BuiltInModel model(small_case(sound_speed), {.pulses = 1});
  const Prediction p = model.evaluate(std::vector<double>{0.0});
  EXPECT_FALSE(p.ok);
  EXPECT_THAT(p.message, HasSubstr("bulk modulus vanishes"));
  EXPECT_TRUE(p.mean.empty());
  EXPECT_TRUE(model.evaluate(std::vector<double>{1450.0}).ok);
  // In a batch the failed run is a column of NaN.
  Eigen::MatrixXd thetas(1, 2);
  thetas << 0.0, 1450.0;
  const auto means = model.means(thetas, 1);
  EXPECT_TRUE(std::isnan(means(3, 0)));
  EXPECT_TRUE(means.col(1).allFinite());
}

TEST(BuiltInModel, TheGruneisenPolicyFollowsTheSoundSpeedAndKnowsItsRange) {
  const std::string load = "peak_pressure = 25e6\npolicy = \"gruneisen\"";
  const BuiltInModel model(small_case(sound_speed, load), {.pulses = 1}), fixed(small_case(sound_speed), {.pulses = 1});
  const auto peak = [](const BuiltInModel& m, double c) {
    const auto s = m.setup(m.forward_case().at(std::vector<double>{c}), m.mesh(), 0, {1.0});
    return *std::max_element(s.p0.begin(), s.p0.end());
  };
  EXPECT_NEAR(peak(model, 1600) / peak(model, 1450), std::pow(1600. / 1450, 2), 1e-12);
  EXPECT_EQ(peak(fixed, 1600), peak(fixed, 1450));
  EXPECT_EQ(peak(model, 1450), peak(fixed, 1450));
  EXPECT_TRUE(model.evaluate(std::vector<double>{1660.0}).ok);
  const Prediction far = model.evaluate(std::vector<double>{1680.0});
  EXPECT_FALSE(far.ok);
  EXPECT_THAT(far.message, HasSubstr("within 15 %"));
  EXPECT_TRUE(fixed.evaluate(std::vector<double>{1680.0}).ok);
}

TEST(BuiltInModel, GainScalesAndDelayShiftsOneChannel) {
  const std::string channel =
      "[parameter.gain]\nkey = \"sensor.T.gain\"\nmin = 0\nmax = 2\n[parameter.delay]\nkey = \"sensor.T.delay\"\nmin = -1e-5\nmax = 1e-5\n";
  const BuiltInModel model(small_case(channel), {.pulses = 1});
  const auto base = model.evaluate(std::vector<double>{1, 0}).mean, louder = model.evaluate(std::vector<double>{1.25, 0}).mean,
             later = model.evaluate(std::vector<double>{1, 3e-6}).mean, sooner = model.evaluate(std::vector<double>{1, -2e-6}).mean;
  const double scale = norm(base);
  for (std::size_t k = 0; k < 41; ++k) {
    EXPECT_NEAR(louder[k], 1.25 * base[k], 1e-12 * scale);
    EXPECT_NEAR(later[k], k < 3 ? 0 : base[k - 3], 1e-9 * scale);
    if (k + 2 < 41) {
      EXPECT_NEAR(sooner[k], base[k + 2], 1e-9 * scale);
    }
    EXPECT_EQ(louder[41 + k], base[41 + k]);
    EXPECT_EQ(later[41 + k], base[41 + k]);
  }
}

TEST(BuiltInModel, ConditionsAreADimensionOfTheValues) {
  const BuiltInModel model(small_case("[[condition]]\nname = \"low\"\npeak_pressure = 10e6\n[[condition]]\nname = \"high\"\npeak_pressure = 25e6\n" + law),
                           {.pulses = 1});
  EXPECT_THAT(model.shape().conditions, ::testing::ElementsAre("low", "high"));
  ASSERT_EQ(model.shape().values(), 2u * 2u * 41u);
  const auto y = model.evaluate(std::vector<double>{1e15}).mean;
  EXPECT_LT(difference({y.begin(), y.begin() + 82},
                       [&] {
                         std::vector<double> scaled(y.begin() + 82, y.end());
                         for (auto& v : scaled) v *= 0.4;
                         return scaled;
                       }()),
            1e-9);  // a linear liquid: in proportion to the pressure
  const auto alone = run(law, {1e15});
  EXPECT_LT(difference({y.begin() + 82, y.end()}, alone), 1e-12);
}

TEST(BuiltInModel, EnergyAndPeakPressureAreTwoWaysToSayTheSame) {
  const BuiltInModel by_pressure(small_case());
  const double joule = by_pressure.describe().deposited_energy;
  EXPECT_GT(joule, 0);
  const auto y = run("", {}, "energy = " + number_text(joule));
  EXPECT_LT(difference(y, run("")), 1e-9);
}

// A stiffer steel must be seen by a model whose elements were made with the nominal one.
TEST(BuiltInModel, ParametersOfTheSteelAndTheGeometryMakeTheirOwnModel) {
  const std::string e = "[parameter.young]\nkey = \"material.steel.young\"\nmin = 1e11\nmax = 3e11\n";
  const auto stiffer = run(e, {215e9}), made_so = run("[material.steel]\nyoung = 215e9\n");
  EXPECT_LT(difference(stiffer, made_so), 1e-12);
  EXPECT_GT(difference(stiffer, run("")), 0.02);
  const std::string wall = "[parameter.wall]\nkey = \"geometry.wall\"\nmin = 0.002\nmax = 0.004\n";
  CaseFile thick = CaseFile::from_text(small_case_text());
  ForwardCase c = ForwardCase::read(thick);
  c.set_number("geometry.wall", 0.0035);
  EXPECT_LT(difference(run(wall, {0.0035}), BuiltInModel(c, {.pulses = 1}).evaluate({}).mean), 1e-12);
  const std::string decay = "[parameter.decay]\nkey = \"load.profile.decay\"\nmin = 0.05\nmax = 0.3\n";
  ForwardCase d = small_case();
  d.load.profile.decay = 0.2;
  EXPECT_LT(difference(run(decay, {0.2}), BuiltInModel(d, {.pulses = 1}).evaluate({}).mean), 1e-12);
  EXPECT_GT(difference(run(decay, {0.2}), run("")), 1e-3);
}

TEST(BuiltInModel, SimulateIsTheRunAtEnergyOne) {
  const BuiltInModel model(small_case(), {.pulses = 1});
  SolveOptions o;
  o.energy_balance = true;
  const auto s = model.simulate(o);
  EXPECT_LT(difference(s.strain, model.evaluate({}).mean), 1e-9);
  EXPECT_LT(s.summary.energy_balance_error, 1e-3);
  EXPECT_EQ(s.summary.times.size(), 41u);
}

TEST(BuiltInModel, WarnsWhenTheMeshDeterminesTheViscosity) {
  ForwardCase c = small_case();
  EXPECT_FALSE(BuiltInModel(c).describe().mesh_decides_viscosity);
  c.mercury.least_mesh_viscosity = 0.1;
  const auto d = BuiltInModel(c).describe();
  EXPECT_TRUE(d.mesh_decides_viscosity);
  EXPECT_NEAR(d.viscosity, 0.1 * 13500 * 1450 * 0.003, 0.05 * d.viscosity);
  EXPECT_THAT(d.warnings, ::testing::Contains(HasSubstr("the mesh decides the regularising viscosity")));
}

TEST(BuiltInModel, WarnsWhenItsElementsCannotHoldAFilmOfThatThickness) {
  ForwardCase c = small_case();  // elements of 3 mm hold 0.9 mm
  c.mercury.wall_film = 0.8e-3;
  EXPECT_THAT(BuiltInModel(c).describe().warnings, ::testing::Not(::testing::Contains(HasSubstr("a film of"))));
  c.mercury.wall_film = 1e-3;
  EXPECT_THAT(BuiltInModel(c).describe().warnings, ::testing::Contains(HasSubstr("hold a film of 0.9 mm on the walls at most, not the 1 mm")));
}

// What a mechanism adds is no numerics: corrections for the mesh take the mesh's viscosity off.
TEST(BuiltInModel, ReportsTheMeshesViscosityWithoutThatOfAMechanism) {
  const auto base = BuiltInModel(small_case()).describe(),
             with = BuiltInModel(small_case("[mechanism.liquid_viscosity]\nenabled = true\nzeta = 3000.0\n")).describe();
  EXPECT_GT(base.viscosity, 0);
  EXPECT_EQ(with.viscosity, base.viscosity);
}

// An offset of the reading does not set in with the gauge's own delay.
TEST(BuiltInModel, AnOffsetIsThereFromTheStart) {
  ForwardCase c = small_case("[mechanism.sensor_response]\nenabled = true\noffset = 1e-4\n");
  c.sensors[0].delay = 5e-6;
  const auto y = BuiltInModel(c, {.pulses = 1}).evaluate({}).mean;
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(y[k], 1e-4, 1e-9) << k;
}

namespace {

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

}  // namespace

// Near its neutral value a law of its own is the base model, whatever numerics the mercury has.
TEST(BuiltInModel, TheQuadraticViscosityActsUnderAnyLaw) {
  const std::string quadratic = "[material.mercury]\nquadratic_viscosity = 1.5\nleast_mesh_viscosity = 0.02\n";
  const auto with = [&](const std::string& mercury, const std::string& mechanism) {
    std::string text = small_case_text(mechanism);
    const std::string own = "[material.mercury]\nleast_mesh_viscosity = 0.02\n";
    if (!mercury.empty()) text.replace(text.find(own), own.size(), mercury);
    CaseFile file = CaseFile::from_text(text);
    return BuiltInModel(ForwardCase::read(file), {.pulses = 1}).evaluate({}).mean;
  };
  const std::string stiffening = "[mechanism.nonlinear_eos]\nenabled = true\nexponent = 1.0000001\n";
  const auto base = with(quadratic, "");
  const double seen = difference(with("", ""), base);
  EXPECT_GT(seen, 1e-5);
  EXPECT_LT(difference(with(quadratic, stiffening), base), 0.03 * seen);
}

// Bubbles would begin at rest in a motion that they share.
TEST(BuiltInModel, WhatEarlierPulsesLeftHoldsNoBubbles) {
  const Prediction p =
      BuiltInModel(small_case("[mechanism.previous_pulses]\nenabled = true\nleft_1 = 0.1\n[mechanism.bubbly_liquid]\nenabled = true\nalpha0 = 1e-4\n"),
                   {.pulses = 1})
          .evaluate({});
  EXPECT_FALSE(p.ok);
  EXPECT_THAT(p.message, HasSubstr("enable previous_pulses or bubbly_liquid, not both"));
}

TEST(BuiltInModel, AMissingRearFaceReflectsNothingAndGivesAWarning) {
  const std::string mechanism = "[mechanism.rear_reflection]\nenabled = true\ncoefficient = 0.5\n";
  EXPECT_TRUE(BuiltInModel(small_case(mechanism), {.pulses = 1}).evaluate({}).ok);
  EXPECT_THAT(refusal([&] { (void)BuiltInModel(ringing_box(0.004, mechanism), {.pulses = 1}).describe(); }), HasSubstr("no rear face that swallows waves"));
}

// A mesh from a file may begin anywhere: its front face is where the beam enters, and a wall without ends is all of the wall.
TEST(BuiltInModel, AMeshFromAFileMayLieAnywhere) {
  const ForwardCase box = small_case();
  const auto mesh = [&](double dx, double dz) {
    Mesh m = make_mesh(box.geometry);
    for (auto& x : m.nodes) x[0] += dx, x[2] += dz;
    return m;
  };
  const auto moved = [&](double dx, double dz, const std::string& mechanism) {
    ForwardCase c = small_case(mechanism);
    c.geometry.kind = "mesh";
    c.load.profile.center[1] += dz;
    for (auto& s : c.sensors) s.position[0] += dx, s.position[2] += dz;
    const Prediction p = BuiltInModel(c, {.pulses = 1}, 1, mesh(dx, dz)).evaluate({});
    EXPECT_TRUE(p.ok) << p.message;
    return p.mean;
  };
  for (const char* mechanism :
       {"", "[mechanism.wall_thinning]\nenabled = true\nwall = \"front\"\nfraction = 0.3\n", "[mechanism.thermal_stress]\nenabled = true\ndelta_t = 1.0\n"}) {
    const auto here = moved(0, 0, mechanism);
    EXPECT_LT(difference(moved(-0.02, 0, mechanism), here), 1e-5) << mechanism;
    EXPECT_LT(difference(moved(0, -0.015, mechanism), here), 1e-5) << mechanism;
  }
  EXPECT_LT(difference(moved(0, 0, ""), run("")), 1e-9);
}
