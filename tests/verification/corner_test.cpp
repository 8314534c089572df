// Inner corners of the steel: a free L-shaped frame (two legs of 60 x 5 mm, plane strain), first opening mode.
// There is no closed solution: 1531.8 Hz is extrapolated from uncorrected runs with 5, 10 and 20 elements through the legs (1540.18,
// 1535.77, 1533.69 Hz), whose differences fall by 2.12, the 2^1.09 that the exponent 0.544 of a 270 degree corner predicts
// (Williams 1952).
#include <fmt/format.h>

#include "tests/verification/rows.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

constexpr double leg = 0.06, thickness = 0.005, limit = 1531.8;

Mesh frame(int through) {
  const int n = int(std::lround(leg / thickness)) * through;
  const Mesh square = block({n, 1, n}, {0, 0, 0}, {leg, thickness / through, leg}, Region::steel);
  Mesh m;
  std::vector<NodeId> number(square.nodes.size(), -1);
  for (auto e : square.elements) {
    const auto& x = square.nodes[std::size_t(e[0])];
    if (x[0] > thickness - 1e-9 && x[2] > thickness - 1e-9) continue;
    for (auto& k : e) {
      auto& to = number[std::size_t(k)];
      if (to < 0) to = NodeId(m.nodes.size()), m.nodes.push_back(Vec3(square.nodes[std::size_t(k)]));
      k = to;
    }
    m.elements.push_back(e);
    m.region.push_back(Region::steel);
  }
  m.fixed.assign(m.nodes.size(), 2);
  return m;
}

/// First opening frequency, from the curvature in time of the opening (which leaves out the rigid drift).
double frequency(int through, double softening) {
  const Mesh m = frame(through);
  RunSetup s = linear_setup(6e-3, 1e-5);
  s.initial_velocity = field(m, [](const Vec3& x) {
    const double a = x[0] - thickness / 2, b = x[2] - thickness / 2;
    if (b > 0 && x[0] < thickness + 1e-9) return Vec3{b * b, 0, -2 * a * b};
    if (a > 0 && x[2] < thickness + 1e-9) return Vec3{-2 * a * b, 0, a * a};
    return Vec3{};
  });
  const std::vector<ObservationRow> rows{{{nearest(m, {leg, 0, thickness / 2}), nearest(m, {thickness / 2, 0, leg})}, {{0, 0, 1}, {1, 0, 0}}}};
  const auto out = ExplicitSolver(m, steel(), 1, softening).solve(s, rows, {});
  const auto y = row_of(out, 0);
  std::vector<double> t, bend;
  for (std::size_t i = 1; i + 1 < y.size(); ++i) t.push_back(out.times[i]), bend.push_back(y[i + 1] - 2 * y[i] + y[i - 1]);
  return fitted_frequency(t, bend, 1000, 2500);
}

}  // namespace

TEST(Corner, TheSofteningRestoresTheConvergenceThatAReentrantEdgeTakes) {
  for (const int through : {2, 3, 5}) {
    const double corrected = frequency(through, reentrant_softening) / limit - 1, plain = frequency(through, 0) / limit - 1;
    verify({.item = "Inner corner",
            .quantity = fmt::format("L-shaped frame, {} elements through its legs", through),
            .unit = "Hz",
            .reference = limit,
            .source = "extrapolated, 5 to 20 elements",
            .measured = limit * (1 + corrected),
            .tolerance = (through == 5 ? 1e-3 : 4e-3) * limit,
            .control = "without the correction",
            .control_value = limit * (1 + plain)});
    EXPECT_GT(plain, 2.5 * std::abs(corrected));  // control: without the correction the frame is too stiff
  }
}

// A wall of 5 mm that bends with a wavelength of 60 mm under 50 mm of mercury has no corner: its frequency converges at
// second order without a correction. Thin-plate theory, (D k^4 - m w^2) sqrt(k^2 - w^2/c^2) = rho w^2, gives 6214 Hz (physics.md section 4,
// c = 1456 m/s, all space filled); shear and rotary inertia of the thick wall reduce it by 3 %.
TEST(Corner, WetBendingWithoutACornerConvergesAtSecondOrder) {
  const double half = 0.03, depth = 0.05, k = M_PI / half;
  const auto wet = [&](double h, bool slip) {
    const int nx = int(std::lround(half / h)), ns = int(std::lround(thickness / h)), nz = ns + int(std::lround(depth / h));
    Mesh m = block({nx, 1, nz}, {0, 0, 0}, {half, h, thickness + depth}, [&](const Vec3& x) { return x[2] < thickness ? Region::steel : Region::mercury; });
    fix(m, 2, everywhere());
    fix(m, 1, plane(0, 0));
    fix(m, 1, plane(0, half));
    fix(m, 4, plane(2, thickness + depth));
    if (slip) split(m, {{0, 0, 1}});
    RunSetup s = linear_setup(1.5e-3, 4e-6);
    s.initial_velocity = field(m, [&](const Vec3& x) {
      const double c = std::cos(k * x[0]), n = std::sin(k * x[0]);
      if (x[2] <= thickness + 1e-9) return Vec3{k * n * (x[2] - thickness / 2), 0, c};
      const double e = std::exp(-k * (x[2] - thickness));
      return Vec3{n * e, 0, c * e};
    });
    const std::vector<ObservationRow> rows{component(nearest(m, {0, 0, 0}), 2)};
    const auto out = ExplicitSolver(m, steel()).solve(s, rows, {});
    return fitted_frequency(out.times, row_of(out, 0), 3000, 9000);
  };
  const double coarse = wet(0.005 / 3, true), middle = wet(0.005 / 6, true), fine = wet(0.005 / 12, true);
  EXPECT_LT(std::abs(middle / fine - 1), 2e-4);
  EXPECT_GT((coarse - middle) / (middle - fine), 2.5);
  EXPECT_NEAR(fine, 6214, 0.04 * 6214);
  const double tied = wet(0.00125, false);  // control: half a layer of mercury moves with the wall
  EXPECT_GT(std::abs(tied / fine - 1), 0.01);
  const double order = std::log2((coarse - middle) / (middle - fine));
  verify({.item = "Inner corner",
          .quantity = "wet wall without a corner, 0.83 mm",
          .unit = "Hz",
          .reference = fine,
          .source = "the same at 0.42 mm",
          .measured = middle,
          .tolerance = 2e-4 * fine,
          .order = order,
          .control = "tied",
          .control_value = tied});
}
