#include "forward/mechanism/nonlinear_eos.hpp"

#include "forward/target/built_in_model.hpp"
#include "tests/unit/forward/target/small_case.hpp"
#include "tests/unit/forward/mechanism/column.hpp"
#include "tests/verification/one_point.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

namespace {

constexpr double never = std::numeric_limits<double>::infinity(), k = mercury_density * mercury_speed * mercury_speed;

}  // namespace

// The pressure is (K/m) ((1 - e)^m - 1) of e = e_v - p0/K plus the viscous part, with the cutoff below. At m = 1 it is Riemer's law.
TEST(NonlinearEos, IsItsFormula) {
  for (const double m : {1.0, 2.5, 10.8}) {
    const StiffeningLiquid law({k, never, 0}, m, 1e9);
    DrivenPoint point(law, 1e-7);
    for (const double e : {-5e-3, -1e-3, -1e-9, 1e-9, 1e-3})
      for (const double p0 : {0.0, 30e6}) {
        const double exact = k / m * (std::pow(1 - (e - p0 / k), m) - 1);
        EXPECT_NEAR(point.step(e, p0), exact, 1e-9 * std::abs(exact) + 1e-3) << m;
        if (m == 1) {
          EXPECT_NEAR(exact, p0 - k * e, 1e-9 * std::abs(exact) + 1e-3);
        }
        if (m > 2 && e < -1e-6) {
          EXPECT_GT(exact, (1 - 0.5 * (m - 1.2) * (e - p0 / k)) * (p0 - k * e));  // control: the law is not the linear one
        }
      }
  }
  const StiffeningLiquid law({k, 1.5e5, 2000}, 10.8, 1e9);
  DrivenPoint point(law, 1e-6);
  EXPECT_EQ(point.step(1e-3), -1.5e5);
  EXPECT_NEAR(point.step(1e-3 - 1e-6), -1.5e5, 1e-6);  // 2000 Pa is not enough
  DrivenPoint rest(law, 1e-6);
  EXPECT_NEAR(rest.step(-1e-6), k * 1e-6 * (1 + 0.5 * 9.8e-6) + 2000, 1e-3);
}

// The law reports to the solver the stiffness at its greatest pressure, which no point may exceed.
TEST(NonlinearEos, ItsStiffnessIsBoundedByItsGreatestPressure) {
  const double m = 10.8, greatest = 120e6;
  const StiffeningLiquid law({k, never, 0}, m, greatest);
  const double e = 1 - std::pow(1 + m * greatest / k, 1 / m), step = 1e-7;
  DrivenPoint point(law, 1e-7);
  const double slope = (point.step(e + step) - point.step(e + 3 * step)) / (2 * step);
  EXPECT_NEAR(slope, law.greatest_stiffness(), 1e-5 * slope);
  EXPECT_GT(slope, 1.03 * k);
  EXPECT_NEAR(point.step(e + step), greatest, 1e-4 * greatest);
  try {
    (void)point.step(e - step);
    FAIL() << "it should have been refused";
  } catch (const LiquidPointError& error) {
    EXPECT_EQ(error.point(), 0u);
    EXPECT_THAT(error.what(), HasSubstr("1.2e+08 Pa"));
  }
}

// In a simple wave every strain travels with its own speed c (1 - e)^((m - 1)/2); behind it v = -integral of that speed over the strain.
TEST(NonlinearEos, ASimpleWaveSteepensAsItsCharacteristicsSay) {
  const double m = 10.8, q = 0.5 * (m - 1), c = mercury_speed, peak = 5e-3, sd = 0.01, from = 0.05, time = 0.1 / c;
  const Mesh mesh = column(1000, 0.25, Region::mercury);
  const auto strain = [&](double x) { return -peak * std::exp(-0.5 * std::pow((x - from) / sd, 2)); };
  const auto ahead = [&](double x) {
    return peak * sd * std::sqrt(M_PI / 2) * std::erfc((x - from) / (sd * std::sqrt(2)));
  };  // u = -integral of the strain ahead
  // Place of a strain at the end and the displacement there, by the trapezoidal rule from ahead of the wave.
  std::vector<double> place, moved;
  for (double x = from + 8 * sd; x > from - 8 * sd; x -= 1e-5) {
    const double e = strain(x), now = x + c * std::pow(1 - e, q) * time;
    moved.push_back(place.empty() ? 0 : moved.back() - 0.5 * (e + strain(x + 1e-5)) * (place.back() - now));
    place.push_back(now);
  }
  const auto exact = [&](double x) {
    const auto i = std::size_t(std::lower_bound(place.begin(), place.end(), x, std::greater<>()) - place.begin());
    if (i == 0) return 0.0;
    if (i == place.size()) return moved.back();
    const double w = (place[i - 1] - x) / (place[i - 1] - place[i]);
    return (1 - w) * moved[i - 1] + w * moved[i];
  };
  const auto error = [&](double exponent) {
    RunSetup s = linear_setup(time, time);
    s.liquid_law = std::make_shared<StiffeningLiquid>(s.liquid, exponent, 3e8);
    s.initial_displacement = field(mesh, [&](const Vec3& x) { return Vec3{ahead(x[0]), 0, 0}; });
    s.initial_velocity = field(mesh, [&](const Vec3& x) { return Vec3{-c * (1 - std::pow(1 - strain(x[0]), q + 1)) / (q + 1), 0, 0}; });
    const auto u = final_displacement(mesh, ExplicitSolver(mesh, steel()).solve(s, all_components(mesh), {}));
    double worst = 0;
    for (std::size_t n = 0; n < u.size(); ++n)
      if (mesh.nodes[n][0] > 0.02) worst = std::max(worst, std::abs(u[n][0] - exact(mesh.nodes[n][0])));
    return worst / moved.back();
  };
  const double own = error(m), linear = error(1), tait = error(m - 2);
  measured("error_of_the_wave", own);
  measured("of_a_linear_liquid", linear);
  measured("of_tait_s_exponent", tait);
  EXPECT_LT(own, 2e-4);
  EXPECT_GT(linear, 0.03);
  EXPECT_GT(tait, 0.005);
}

// In a case the step follows the stiffness, two laws of the liquid are refused, and at the default exponent no function of the mechanism is called.
TEST(NonlinearEos, ACaseReportsItsGreatestPressure) {
  const auto c = small_case("[mechanism.nonlinear_eos]\nenabled = true\nexponent = 10.8\n");
  const BuiltInModel model(c, {.pulses = 1});
  const RunSetup s = model.setup(model.forward_case(), model.mesh(), 0, {0.9, 1.1});
  const double peak = *std::max_element(s.p0.begin(), s.p0.end());
  EXPECT_NEAR(s.liquid_stiffness(), k * std::pow(1 + 10.8 * 4 * 1.1 * peak / k, 9.8 / 10.8), 1e-6 * k);
  const auto p =
      BuiltInModel(small_case("[mechanism.nonlinear_eos]\nenabled = true\nexponent = 10.8\n[mechanism.bubbly_liquid]\nenabled = true\nalpha0 = 1e-4\n"),
                   {.pulses = 1})
          .evaluate({});
  EXPECT_FALSE(p.ok);
  EXPECT_THAT(p.message, HasSubstr("only one can"));
}
