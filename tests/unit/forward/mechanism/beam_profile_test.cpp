#include "forward/mechanism/beam_profile.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "base/json.hpp"
#include "forward/target/built_in_model.hpp"
#include "forward/mesh/hexahedron.hpp"
#include "forward/mesh/make_mesh.hpp"
#include "forward/target/offered_groups.hpp"
#include "tests/unit/forward/target/small_case.hpp"

using namespace calomel;
using calomel::testing::greatest_difference;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

namespace {

ForwardCase box(bool half, const std::string& mechanism, const std::string& strength = "peak_pressure = 25e6") {
  CaseFile file = CaseFile::from_text(R"([geometry]
kind = "box"
length = 0.06
width = 0.05
height = 0.04
wall = 0.004
element_size = 0.004
half = )" + std::string(half ? "true" : "false") +
                                      "\n[load]\n" + strength + R"(
profile = { center = [0.0, 0.02], widths = [0.03, 0.015] }
[time]
end = 2e-6
[[sensor]]
name = "T"
position = [0.03, 0.0, 0.04]
direction = [1, 0, 0]
)" + (mechanism.empty() ? "" : "[mechanism.beam_profile]\nenabled = true\n" + mechanism));
  return ForwardCase::read(file);
}

std::vector<double> heating(const BuiltInModel& m) { return m.setup(m.forward_case(), m.mesh(), 0, {1.0}).p0; }

}  // namespace

// The initial pressure of an element is peak S g / max g of the moved and scaled source, averaged over eight Gauss points.
TEST(BeamProfile, TheHeatingPressureIsThatOfTheMovedSource) {
  const BuiltInModel model(box(false, "offset_y = 4e-3\noffset_z = -3e-3\nwidth_ratio_y = 1.1\nwidth_ratio_z = 0.9\nenergy_ratio = 1.03\n"), {.pulses = 1});
  const Mesh& mesh = model.mesh();
  const auto p0 = heating(model);
  const double length = 0.13, b = 1.5, x1 = 0.02;
  const auto g = [&](double x) { return (1 + b * (1 - std::exp(-x / x1))) * std::exp(-x / length); };
  double greatest = 0;
  for (double x = 0; x < 0.2; x += 1e-5) greatest = std::max(greatest, g(x));
  int checked = 0;
  for (std::size_t e = 0; e < p0.size(); ++e) {
    if (mesh.region[e] == Region::steel) {
      EXPECT_EQ(p0[e], 0);
      continue;
    }
    const auto corners = hexahedron::corners(mesh, e);
    double mean = 0;
    for (int q = 0; q < 8; ++q) {
      const double at[3] = {(q & 1 ? 1 : -1) / std::sqrt(3), (q & 2 ? 1 : -1) / std::sqrt(3), (q & 4 ? 1 : -1) / std::sqrt(3)};
      hexahedron::Point x = hexahedron::Point::Zero();
      for (int k = 0; k < 8; ++k) {
        double weight = 1;
        for (int c = 0; c < 3; ++c) weight *= (1 + (k >> c & 1 ? at[c] : -at[c])) / 2;
        x += weight * corners[std::size_t(k)];
      }
      const double y = (x[1] - 4e-3) / 0.033, z = (x[2] - 0.017) / 0.0135;
      mean += 25e6 * 1.03 * std::exp(-0.5 * (y * y + z * z)) * g(x[0]) / greatest / 8;
    }
    EXPECT_NEAR(p0[e], mean, 1e-6 * 25e6);
    ++checked;
  }
  EXPECT_GT(checked, 100);
}

TEST(BeamProfile, ABeamOffToOneSideNeedsTheFullModel) {
  try {
    const BuiltInModel model(box(true, "offset_y = 1e-3\n"), {.pulses = 1});
    FAIL() << "it should have been refused";
  } catch (const InputError& e) {
    EXPECT_EQ(e.parts().key, "mechanism.beam_profile.offset_y");
    EXPECT_EQ(e.parts().value, "0.001");
    EXPECT_THAT(e.what(), HasSubstr("what is off centre along y cannot show"));
    EXPECT_THAT(e.what(), HasSubstr("geometry.half = false"));
  }
  EXPECT_NO_THROW(BuiltInModel(box(true, "offset_z = 1e-3\n"), {.pulses = 1}));
}

// The same holds for the beam of the case: away from the symmetry plane it would be two beams.
TEST(BeamProfile, AHalfModelRefusesABeamBesideItsPlane) {
  ForwardCase c = box(true, "");
  c.load.profile.center[0] = 0.01;
  try {
    const BuiltInModel model(c, {.pulses = 1});
    FAIL() << "it should have been refused";
  } catch (const InputError& e) {
    EXPECT_EQ(e.parts().key, "load.profile.center");
    EXPECT_THAT(e.what(), HasSubstr("two beams"));
  }
  c.geometry.half = false;
  EXPECT_NO_THROW(BuiltInModel(c, {.pulses = 1}));
}

// A diagnosis of a model with a symmetry plane screens no change that the model would refuse: a half model, and any mesh with a mirror plane.
TEST(BeamProfile, IsNotScreenedForAnOffsetAcrossAMirrorPlane) {
  const auto numbers = [](const Mesh& mesh) {
    std::vector<std::string> names;
    for (const auto& g : offered_groups(box(false, ""), mesh))
      if (g.name == "beam_profile")
        for (const auto& a : g.added) names.push_back(a.parameter.name);
    return names;
  };
  const auto full = make_mesh(box(false, "").geometry), half = make_mesh(box(true, "").geometry);
  Mesh quarter = half;
  quarter.mirrors.push_back({.axis = 2});
  EXPECT_THAT(numbers(full), AllOf(Contains("beam_profile.offset_y"), Contains("beam_profile.offset_z")));
  EXPECT_THAT(numbers(half), AllOf(Not(Contains("beam_profile.offset_y")), Contains("beam_profile.offset_z"), Contains("beam_profile.width_ratio_y")));
  EXPECT_THAT(numbers(quarter), AllOf(Not(Contains("beam_profile.offset_y")), Not(Contains("beam_profile.offset_z")), Contains("beam_profile.width_ratio_y")));
}

TEST(BeamProfile, ALoadGivenByItsEnergyKeepsIt) {
  const std::string energy = "energy = 500.0";
  const BuiltInModel base(box(false, "", energy), {.pulses = 1}), wide(box(false, "width_ratio_y = 1.15\nwidth_ratio_z = 1.1\n", energy), {.pulses = 1}),
      strong(box(false, "energy_ratio = 1.02\n", energy), {.pulses = 1}), by_peak(box(false, "width_ratio_y = 1.15\nwidth_ratio_z = 1.1\n"), {.pulses = 1});
  EXPECT_NEAR(base.describe().deposited_energy, 500, 1e-9);
  EXPECT_NEAR(wide.describe().deposited_energy, 500, 1e-9);
  EXPECT_NEAR(strong.describe().deposited_energy, 510, 1e-9);
  const auto a = heating(base), b = heating(wide);
  EXPECT_LT(*std::max_element(b.begin(), b.end()), 0.97 * *std::max_element(a.begin(), a.end()));
  // Control: at a given peak a wider beam carries more energy.
  EXPECT_GT(by_peak.describe().deposited_energy, 1.03 * BuiltInModel(box(false, ""), {.pulses = 1}).describe().deposited_energy);
}

TEST(BeamProfile, ThePulseTakesItsLength) {
  const BuiltInModel longer(box(false, "pulse_length = 1.2e-6\n"), {.pulses = 1});
  EXPECT_EQ(longer.setup(longer.forward_case(), longer.mesh(), 0, {1.0}).pulse_length, 1.2e-6);
  // When the mechanism is off, the length is that of [load].
  const BuiltInModel off(box(false, "energy_ratio = 1.01\n", "peak_pressure = 25e6\npulse_length = 0.3e-6"), {.pulses = 1});
  EXPECT_EQ(off.setup(off.forward_case(), off.mesh(), 0, {1.0}).pulse_length, 0.3e-6);
}

// The off value is the pulse of the case. There the run has the bytes of the base model, and values close to it change little.
TEST(BeamProfile, ThePulseIsOffAtTheLengthOfTheLoadAndContinuousThere) {
  const std::string load = "peak_pressure = 25e6\npulse_length = 0.3e-6";
  const auto histories = [&](const std::string& mechanism) { return BuiltInModel(box(false, mechanism, load), {.pulses = 1}).evaluate({}).mean; };
  const auto base = histories("");
  EXPECT_EQ(base, histories("offset_z = 0.0\n"));                                    // the case sets none
  EXPECT_EQ(base, histories("pulse_length = 0.3e-6\n"));                             // the case sets the same value
  EXPECT_GT(greatest_difference(histories("pulse_length = 0.7e-6\n"), base), 1e-3);  // the default length is a different one here
  for (const double beside : {0.3e-6 * (1 - 1e-9), 0.3e-6 * (1 + 1e-9)}) {
    const double change = greatest_difference(histories("pulse_length = " + number_text(beside) + "\n"), base);
    EXPECT_GT(change, 0);
    EXPECT_LT(change, 1e-7);
  }
}

// A fit starts from the length of the load, and follows it where that length is a parameter itself.
TEST(BeamProfile, APulseThatIsNotSetFollowsTheLoad) {
  const std::string load = "peak_pressure = 25e6\npulse_length = 0.3e-6";
  ForwardCase c = box(false, "energy_ratio = 1.01\n[parameter.p]\nkey = \"mechanism.beam_profile.pulse_length\"\nmin = 0\nmax = 2e-6\n", load);
  EXPECT_EQ(*c.parameters[0].nominal, 0.3e-6);
  EXPECT_EQ(c.echo()["mechanism"]["beam_profile"]["pulse_length"], 0.3e-6);
  c.set_number("load.pulse_length", 0.5e-6);
  EXPECT_EQ(c.number("mechanism.beam_profile.pulse_length"), 0.5e-6);
  EXPECT_EQ(c.active_mechanisms().at(0).values["pulse_length"], 0.5e-6);
  // Control: a length of the mechanism itself remains.
  c.set_number("mechanism.beam_profile.pulse_length", 0.9e-6);
  c.set_number("load.pulse_length", 0.6e-6);
  EXPECT_EQ(c.number("mechanism.beam_profile.pulse_length"), 0.9e-6);
}
