// The places where a mechanism may change a run beyond its load, numbers and gauges: the mesh, the fields of the run, and a law that knows the heat. The
// mechanisms are of this test alone.
#include <gmock/gmock.h>

#include <cmath>
#include <memory>

#include "forward/target/built_in_model.hpp"
#include "forward/mesh/deform_mesh.hpp"
#include "tests/unit/forward/target/small_case.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

namespace {

/// The top wall thinner from inside by a fraction.
const MechanismEntry& thinner() {
  static const MechanismEntry entry{.law = "h (1 - fraction)",
                                    .keys = {{.name = "fraction", .off = 0, .low = 0, .high = 0.5}},
                                    .mesh = [](const MechanismValues& v, Mesh& m) { thin_wall(m, {.wall = "top", .fraction = v["fraction"]}); }};
  return entry;
}

/// Everything that fields may hold: heat in the steel that falls with x, all that moves on with one velocity, a stress before the run, weak wetted faces.
const MechanismEntry& full() {
  static const MechanismEntry entry{
      .law = "every field",
      .keys = {{.name = "thermal", .off = 0, .low = 0, .high = 1e-4},
               {.name = "velocity", .off = 0, .low = -1, .high = 1},
               {.name = "pressure", .off = 0, .low = 0, .high = 4e5},
               {.name = "strength", .off = std::numeric_limits<double>::infinity(), .low = 0, .high = 1.5e6}},
      .fields = [](const MechanismValues& v, const Mesh& m, const LoadOptions& load, RunSetup& s) {
        if (v["thermal"] != 0)
          for (std::size_t e = 0; e < m.elements.size(); ++e) {
            const double x = m.nodes[std::size_t(m.elements[e][0])][0];
            s.thermal_strain.push_back(m.region[e] == Region::steel ? v["thermal"] * load.profile.shape({x, 0, load.profile.center[1]}, true) : 0);
          }
        if (v["velocity"] != 0) s.initial_velocity.assign(m.nodes.size(), {v["velocity"], 0, -v["velocity"]});
        if (v["pressure"] != 0)
          for (std::size_t e = 0; e < m.elements.size(); ++e) {
            const double p = m.region[e] == Region::mercury ? -v["pressure"] : 0;
            s.initial_stress.push_back({p, p, p, 0, 0, 0});
          }
        if (std::isfinite(v["strength"])) s.slip_strength.assign(m.slip.size(), v["strength"]);
      }};
  return entry;
}

class OfStiffness : public LiquidLaw {
 public:
  OfStiffness(Riemer law, double stiffness) : law_(law), stiffness_(stiffness) {}
  [[nodiscard]] double greatest_stiffness() const override { return stiffness_; }
  void advance(const LiquidPoints& p) const override {
    for (std::size_t i = 0; i < p.count; ++i) p.pressure[i] = law_.pressure(p.heating[i], p.strain[i], (p.strain[i] - p.strain_before[i]) / p.dt);
  }

 private:
  Riemer law_;
  double stiffness_;
};

/// A liquid whose stiffness is computed from the greatest heating pressure of the run.
const MechanismEntry& stiff_by_heat() {
  static const MechanismEntry entry{.law = "K (1 + factor max p0 / K)",
                                    .keys = {{.name = "factor", .off = 0, .low = 0, .high = 1e4}},
                                    .liquid = [](const MechanismValues& v, const RunSetup& s) -> std::shared_ptr<const LiquidLaw> {
                                      const double greatest = *std::max_element(s.p0.begin(), s.p0.end());
                                      return std::make_shared<OfStiffness>(s.liquid, s.liquid.bulk_modulus + v["factor"] * greatest);
                                    }};
  return entry;
}

ForwardCase with(ForwardCase c, const char* name, const MechanismEntry& entry, const std::map<std::string, double>& set) {
  MechanismValues values(entry.keys);
  for (const auto& [key, value] : set) *values.find(key) = value;
  c.mechanisms.push_back({name, &entry, values});
  return c;
}

Prediction evaluate(const ForwardCase& c, std::vector<double> theta = {}, int pulses = 1) {
  auto p = BuiltInModel(c, {.pulses = pulses}).evaluate(theta);
  EXPECT_TRUE(p.ok) << p.message;
  return p;
}

RunSetup setup_of(const ForwardCase& c) {
  const BuiltInModel model(c, {.pulses = 1});
  return model.setup(model.forward_case(), model.mesh(), 0, {1.0});
}

double frequency(const ForwardCase& c) {
  const BuiltInModel model(c, {.pulses = 1});
  const auto p = model.evaluate({});
  EXPECT_TRUE(p.ok) << p.message;
  return fitted_frequency(model.shape().times, p.mean, 1500, 9000);
}

}  // namespace

// A wall that a mechanism thins rings as one that is made so thin, and its gauge remains on the outer face.
TEST(MechanismPlaces, AThinnedWallHasTheFrequencyOfTheThinnerOne) {
  const ForwardCase thick = ringing_box(0.004), thin = ringing_box(0.002), thinned = with(thick, "thinner", thinner(), {{"fraction", 0.5}});
  const double f_thick = frequency(thick), f_thin = frequency(thin), f_thinned = frequency(thinned);
  measured("thick", f_thick);
  measured("thin", f_thin);
  measured("thinned", f_thinned);
  EXPECT_NEAR(f_thinned, f_thin, 0.01 * f_thin);
  EXPECT_GT(f_thick, 1.2 * f_thin);  // control
  const BuiltInModel model(thinned, {.pulses = 1});
  EXPECT_NEAR(model.gauges()[0].placed[2], 0.03, 1e-12);
  EXPECT_LT(model.gauges()[0].distance, 1e-12);
}

// Fitted, it gets a mesh of its own for every value, and off is the base model's bytes; on a mesh that was given, too.
TEST(MechanismPlaces, AMeshMechanismIsOffTheBaseModelAndFollowsItsParameter) {
  const ForwardCase base = small_case();
  ForwardCase fitted = with(base, "thinner", thinner(), {});
  fitted.parameters.push_back({.name = "f", .key = "mechanism.thinner.fraction", .min = 0, .max = 0.9, .nominal = 0.0});
  const auto fixed = evaluate(with(base, "thinner", thinner(), {{"fraction", 0.3}})).mean;
  EXPECT_EQ(evaluate(fitted, {0.0}).mean, evaluate(base).mean);
  EXPECT_EQ(evaluate(fitted, {0.3}).mean, fixed);
  EXPECT_NE(fixed, evaluate(base).mean);
  const BuiltInModel bare(base, {.pulses = 1});
  const BuiltInModel given(fitted, {.pulses = 1}, 1, Mesh(bare.mesh()));
  EXPECT_EQ(given.evaluate(std::vector<double>{0.3}).mean, fixed);
  EXPECT_EQ(given.evaluate(std::vector<double>{0.0}).mean, evaluate(base).mean);
  try {  // its errors name its own key
    const BuiltInModel model(with(base, "thinner", thinner(), {{"fraction", 0.95}}), {.pulses = 1});
    FAIL() << "it should have been refused";
  } catch (const InputError& e) {
    EXPECT_EQ(e.parts().key, "mechanism.thinner.fraction");
  }
}

// Off they are the base model's bytes, single and in lanes; each of them changes something.
TEST(MechanismPlaces, FieldsReachTheRun) {
  for (const int pulses : {1, 2}) {
    const auto base = evaluate(small_case(), {}, pulses).mean;
    EXPECT_EQ(evaluate(with(small_case(), "full", full(), {}), {}, pulses).mean, base);
    for (const auto& [key, value] : std::map<std::string, double>{{"thermal", 1e-4}, {"pressure", 4e5}, {"strength", 0.0}})
      EXPECT_GT(greatest_difference(evaluate(with(small_case(), "full", full(), {{key, value}}), {}, pulses).mean, base), 1e-4) << key;
    // Moving on as a whole strains nothing in a closed box, and much in one whose rear face moves against the mercury behind it.
    ForwardCase closed = small_case();
    closed.geometry.rear = "wall";
    EXPECT_LT(greatest_difference(evaluate(with(closed, "full", full(), {{"velocity", 1.0}}), {}, pulses).mean, evaluate(closed, {}, pulses).mean), 1e-9);
    EXPECT_GT(greatest_difference(evaluate(with(small_case(), "full", full(), {{"velocity", 1.0}}), {}, pulses).mean, base), 1e-2);
  }
  const RunSetup s = setup_of(with(small_case(), "full", full(), {{"thermal", 1e-4}, {"velocity", 1.0}, {"pressure", 4e5}, {"strength", 1e5}}));
  EXPECT_EQ(s.thermal_strain.size(), s.p0.size());
  EXPECT_EQ(s.initial_stress.size(), s.p0.size());
  EXPECT_GT(s.initial_velocity.size(), s.p0.size());
  EXPECT_GT(s.slip_strength.size(), 0u);
  EXPECT_EQ(setup_of(small_case()).thermal_strain.size(), 0u);
}

// Heat in the steel rises with the pulse and its energy: twice the beam is twice the strain, where the mercury is not heated at all.
TEST(MechanismPlaces, HeatInTheSteelFollowsThePulse) {
  const auto cold = small_case("", "peak_pressure = 0.0\npulse_length = 10e-6");
  const BuiltInModel model(with(cold, "full", full(), {{"thermal", 1e-4}}), {.pulses = 1});
  RunSetup one = model.setup(model.forward_case(), model.mesh(), 0, {1.0});
  one.liquid.tensile_cutoff = one.wetted_cutoff = std::numeric_limits<double>::infinity();
  std::vector<ObservationRow> rows{{model.gauges()[0].axial.nodes, model.gauges()[0].axial.weights}};
  const ExplicitSolver solver(model.mesh(), one.steel);
  const auto once = solver.solve(one, rows, {}).observations;
  one.energies = {2.0};
  const auto twice = solver.solve(one, rows, {}).observations;
  double greatest = 0;
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_NEAR(twice[i], 2 * once[i], 1e-15 + 1e-9 * std::abs(once[i]));
    greatest = std::max(greatest, std::abs(once[i]));
  }
  EXPECT_GT(greatest, 1e-5);
  EXPECT_LT(std::abs(once[2]), 0.25 * std::abs(once[10]));  // a fifth of the pulse, a fifth of the heat
}

// A law may take what it needs from the heat of the run, its greatest stiffness for one, and the step follows.
TEST(MechanismPlaces, ALawOfTheLiquidKnowsTheHeat) {
  const auto law = [](double factor) {
    return BuiltInModel(with(small_case(), "stiff", stiff_by_heat(), {{"factor", factor}}), {.pulses = 1}).describe().time_step;
  };
  const double k = setup_of(small_case()).liquid.bulk_modulus;
  EXPECT_LT(law(399 * k / 25e6), 0.6 * law(1e-9));
  EXPECT_LT(greatest_difference(evaluate(with(small_case(), "stiff", stiff_by_heat(), {{"factor", 1e-9}})).mean, evaluate(small_case()).mean), 1e-9);
}
