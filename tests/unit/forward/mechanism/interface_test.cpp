#include "forward/mechanism/interface.hpp"

#include <fmt/format.h>

#include "forward/target/built_in_model.hpp"
#include "tests/unit/forward/target/small_case.hpp"
#include "tests/unit/forward/mechanism/column.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

// Taylor's plate (1941): a wave p0 exp(-t/theta) pushes a free plate of mass m an area until the mercury would pull. At that moment the plate moves with
// (2 p0 theta / m) B^(B/(1-B)), B = rho c theta / m. Over a face without strength it keeps that velocity; a face that holds pulls it back.
TEST(Interface, AFreePlateKeepsItsVelocity) {
  const double thickness = 0.008, theta = 20e-6, p0 = 1e6, m = steel_density * thickness, c = mercury_speed, b = mercury_density * c * theta / m;
  Mesh mesh = block({1200 + 32, 1, 1}, {-0.3, 0, 0}, {thickness, 0.001, 0.001}, [](const Vec3& x) { return x[0] < 0 ? Region::mercury : Region::steel; });
  fix(mesh, 2 | 4, everywhere());
  split(mesh, {Vec3{1, 0, 0}});
  mesh.wetted = faces_at(mesh, 0, 0);
  std::vector<bool> in_steel(mesh.nodes.size(), false);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    if (mesh.region[e] == Region::steel)
      for (const NodeId n : mesh.elements[e]) in_steel[std::size_t(n)] = true;
  RunSetup s = linear_setup(60e-6, 1e-6);
  const double stiffness = mercury_density * c * c;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const double x = mesh.nodes[n][0], p = in_steel[n] ? 0 : p0 * std::exp(std::min(x, 0.0) / (c * theta));
    s.initial_velocity.push_back({p / (mercury_density * c), 0, 0});
    s.initial_displacement.push_back({in_steel[n] ? 0 : (p0 - p) / stiffness * c * theta, 0, 0});  // 0 at x = 0, where the wave has not arrived
  }
  const auto mass = masses(mesh, s);
  ObservationRow plate;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (in_steel[n]) plate.nodes.push_back(NodeId(n)), plate.weights.push_back({mass[Eigen::Index(n)] / (m * 1e-6), 0, 0});
  const auto entry = interface();
  const double all = 0, rear = 2;
  const auto velocity = [&](double strength, double wall) {
    RunSetup own = s;
    if (std::isfinite(strength)) entry.fields(values_of(entry, {{"strength", strength}, {"wall", wall}, {"begin", -1}}), mesh, LoadOptions{}, own);
    const auto out = ExplicitSolver(mesh, steel()).solve(own, std::vector<ObservationRow>{plate}, {});
    return (out.observations[50] - out.observations[30]) / 20e-6;
  };
  const double kept = 2 * p0 * theta / m * std::pow(b, b / (1 - b));
  measured("velocity_over_taylor_s", velocity(0, all) / kept);
  EXPECT_NEAR(velocity(0, all), kept, 0.02 * kept);
  EXPECT_EQ(velocity(0, rear), velocity(0, all));  // the plate is the rear wall of its part
  EXPECT_LT(velocity(std::numeric_limits<double>::infinity(), all), 0.5 * kept);
  const double some = velocity(1e5, all);  // the face holds up to a tenth of the wave
  EXPECT_LT(some, velocity(0, all));
  EXPECT_GT(some, 0.9 * kept);
  RunSetup other = s;
  EXPECT_THROW(entry.fields(values_of(entry, {{"strength", 0}, {"wall", 1}, {"begin", -1}}), mesh, LoadOptions{}, other), InputError);  // the front has none
}

namespace {

std::string weak(const std::string& lines) { return "[mechanism.interface]\nenabled = true\nstrength = 5e4\n" + lines; }

/// The part of [begin, end] that a node at x represents, whose neighbours are h away.
double share_of_stretch(double x, double h, double begin, double end) {
  return std::clamp((std::min(x + h / 2, end) - std::max(x - h / 2, begin)) / h, 0.0, 1.0);
}

RunSetup setup_of(const BuiltInModel& m) { return m.setup(m.forward_case(), m.mesh(), 0, {1.0}); }

}  // namespace

TEST(Interface, OnlyTheNamedStretchIsWeak) {
  const BuiltInModel one(small_case(weak("wall = \"top\"\nbegin = 0.02\nend = 0.04\n")), {.pulses = 1}), all(small_case(weak("")), {.pulses = 1});
  const RunSetup s = setup_of(one), a = setup_of(all);
  int whole = 0, parts = 0;
  for (std::size_t i = 0; i < one.mesh().slip.size(); ++i) {
    const Vec3& x = one.mesh().nodes[std::size_t(one.mesh().slip[i].steel)];
    const double share = x[2] > 0.0269 ? share_of_stretch(x[0], 0.003, 0.02, 0.04) : 0;
    if (share > 1e-9) {
      EXPECT_NEAR(s.slip_strength[i], share * 5e4 + (1 - share) * s.wetted_cutoff, 1e-6);
      EXPECT_NEAR(s.slip_hold[i], (1 - share) * s.wetted_cutoff, 1e-6);
    } else {
      EXPECT_EQ(s.slip_strength[i], std::numeric_limits<double>::infinity());
    }
    EXPECT_EQ(a.slip_strength[i], 5e4);
    EXPECT_EQ(a.slip_hold[i], 0);
    whole += share > 1 - 1e-9;
    parts += share > 1e-9 && share < 1 - 1e-9;
  }
  EXPECT_GT(whole, 4);
  EXPECT_GT(parts, 1);
}

// The gauges respond gradually to the end of a stretch, so that a diagnosis can search for it.
TEST(Interface, TheEndOfAStretchMovesWithoutSteps) {
  const auto changed = [](double end) {
    const auto history = BuiltInModel(small_case(weak(fmt::format("wall = \"top\"\nbegin = 0.02\nend = {}\n", end))), {.pulses = 1}).evaluate({}).mean;
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(history.data(), Eigen::Index(history.size())));
  };
  const Eigen::VectorXd at = changed(0.0390), near = changed(0.0391), far = changed(0.0420);  // within the length of one pair of nodes, and beyond it
  EXPECT_GT((near - at).norm(), 0);
  EXPECT_LT((near - at).norm(), 0.3 * (far - at).norm());
}

// A strength above that of the mercury has no effect.
TEST(Interface, AFaceStrongerThanTheMercuryIsTheBaseModel) {
  const auto histories = [](const std::string& lines) { return BuiltInModel(small_case(lines), {.pulses = 1}).evaluate({}).mean; };
  const std::string table = "[mechanism.interface]\nenabled = true\n";
  EXPECT_EQ(histories(table + "strength = 1.6e5\n"), histories(""));
  EXPECT_NE(histories(table + "strength = 1.0e5\n"), histories(""));
}

TEST(Interface, AFaceThatCannotOpenIsAnError) {
  const auto message = [](const std::string& lines, const char* wetted = "slip") {
    ForwardCase c = small_case(weak(lines));
    c.geometry.wetted = wetted;
    const auto p = BuiltInModel(c, {.pulses = 1}).evaluate({});
    EXPECT_FALSE(p.ok);
    return p.message;
  };
  EXPECT_THAT(message("", "tied"), HasSubstr("share nodes"));
  EXPECT_THAT(message("wall = \"rear\"\n"), HasSubstr("mechanism.interface.wall"));
  EXPECT_THAT(message("begin = 0.5\n"), HasSubstr("beyond x = 0.5 m"));
  EXPECT_THROW((void)small_case(weak("wall = \"lid\"\n")), InputError);
}
