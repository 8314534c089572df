#include "forward/mechanism/sensor_response.hpp"

#include "base/linear_algebra.hpp"
#include "forward/target/built_in_model.hpp"
#include "forward/mesh/make_mesh.hpp"
#include "forward/sensor/channel.hpp"
#include "tests/unit/forward/target/small_case.hpp"
#include "tests/unit/forward/mechanism/column.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

namespace {

constexpr double interval = 1e-7;

std::vector<double> respond(const std::map<std::string, double>& set, std::vector<double> y, const std::string& sensor = "A") {
  const auto entry = sensor_response();
  entry.channel(values_of(entry, set), sensor, interval, y);
  return y;
}

std::vector<double> sine(double f, std::size_t n) {
  std::vector<double> y;
  for (std::size_t k = 0; k < n; ++k) y.push_back(std::sin(2 * M_PI * f * double(k) * interval));
  return y;
}

}  // namespace

// 1 / (1 + i sqrt(2) f/f0 - (f/f0)^2), a Butterworth filter of second order.
TEST(SensorResponse, TheLowPassFollowsItsFormulaForASine) {
  const double cutoff = 50e3;
  for (const double f : {10e3, 50e3, 150e3}) {
    const auto y = respond({{"low_pass", cutoff}}, sine(f, 6000));
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(2, 2);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(2);
    for (std::size_t k = 4000; k < y.size(); ++k) {
      const Eigen::Vector2d a(std::sin(2 * M_PI * f * double(k) * interval), std::cos(2 * M_PI * f * double(k) * interval));
      normal += a * a.transpose();
      right += y[k] * a;
    }
    const Eigen::Vector2d got = solve_symmetric(normal, right);
    const double x = f / cutoff, re = 1 - x * x, im = std::sqrt(2) * x, size = re * re + im * im;
    EXPECT_NEAR(got[0], re / size, 2e-3) << f;
    EXPECT_NEAR(got[1], -im / size, 2e-3) << f;
  }
}

TEST(SensorResponse, TheLowPassFollowsItsFormulaForAStep) {
  const double cutoff = 50e3, a = 2 * M_PI * cutoff / std::numbers::sqrt2;
  const auto y = respond({{"low_pass", cutoff}}, std::vector<double>(600, 1.0));
  for (std::size_t k = 0; k < y.size(); ++k) {
    const double t = (double(k) + 0.5) * interval;  // the step is a ramp over the sample before it
    EXPECT_NEAR(y[k], 1 - std::exp(-a * t) * (std::cos(a * t) + std::sin(a * t)), 1e-3);
  }
  EXPECT_GT(*std::max_element(y.begin(), y.end()), 1.04);  // the response overshoots by 4.3 %
}

TEST(SensorResponse, DelayGainAndOffset) {
  const double f = 40e3;
  const auto x = sine(f, 400), y = respond({{"delay", 1.3e-6}, {"gain", 0.9}, {"offset", 2e-5}}, x);
  for (std::size_t k = 20; k < y.size(); ++k) EXPECT_NEAR(y[k], 0.9 * std::sin(2 * M_PI * f * (double(k) * interval - 1.3e-6)) + 2e-5, 1e-5);
  EXPECT_EQ(y[0], 2e-5);
  const auto early = respond({{"delay", -1e-6}}, x);
  for (std::size_t k = 0; k + 12 < x.size(); ++k) EXPECT_NEAR(early[k], x[k + 10], 1e-12);
}

// A gauge that is turned towards normal x direction and has a transverse sensitivity reads exactly m.E.m + k n.E.n in a uniform strain.
TEST(SensorResponse, ATurnedGaugeReadsTheTurnedStrain) {
  GeometryOptions g;
  g.kind = "box";
  g.length = 0.08;
  g.width = 0.06;
  g.height = 0.05;
  g.wall = 0.004;
  g.element_size = 0.004;
  const Mesh mesh = make_mesh(g);
  Eigen::Matrix3d gradient;
  gradient << 1.1, 0.3, -0.7, 0.2, -0.4, 0.5, 0.9, -0.6, 0.8;
  const Eigen::Matrix3d strain = 0.5 * (gradient + gradient.transpose());
  const auto u = field(mesh, [&](const Vec3& x) { return hexahedron::vec3(gradient * hexahedron::point(x)); });
  const auto entry = sensor_response();
  for (const double gauge_length : {0.0, 0.008})
    for (const auto& [angle, k] : {std::pair{7.0, 0.0}, {-10.0, 0.03}, {0.0, -0.05}, {90.0, 0.0}}) {
      SensorOptions sensor;
      sensor.name = "A";
      sensor.position = {0.04, 0.005, 0.05};
      sensor.direction = {0.8, 0.6, 0};
      sensor.gauge_length = gauge_length;
      const LocatedGauge gauge = locate_gauge(mesh, sensor);
      ObservationRow row{gauge.axial.nodes, gauge.axial.weights};
      entry.gauge(values_of(entry, {{"angle", angle}, {"transverse", k}}), gauge, row);
      const Eigen::Vector3d d = hexahedron::point(gauge.direction), t = hexahedron::point(gauge.normal).cross(d);
      const double a = angle * M_PI / 180;
      const Eigen::Vector3d along = std::cos(a) * d + std::sin(a) * t, across = -std::sin(a) * d + std::cos(a) * t;
      EXPECT_NEAR((GaugeRow{row.nodes, row.weights}(u)), along.dot(strain * along) + k * across.dot(strain * across), 1e-9) << angle << ' ' << k;
    }
}

namespace {

std::vector<double> strain(const std::string& mechanism) { return BuiltInModel(small_case(mechanism), {.pulses = 1}).evaluate({}).mean; }
const std::string enabled = "[mechanism.sensor_response]\nenabled = true\n";

}  // namespace

// The table of one gauge overrides the keys that it names; the other keys remain common.
TEST(SensorResponse, AGaugesOwnTableOverridesWhatItNames) {
  const auto base = strain("");
  const auto own = strain(enabled + "gain = 1.1\n[mechanism.sensor_response.T]\noffset = 1e-5\n");
  const auto replaced = strain(enabled + "gain = 1.1\n[mechanism.sensor_response.T]\ngain = 0.9\n");
  for (std::size_t k = 0; k < 41; ++k) {
    EXPECT_DOUBLE_EQ(own[k], 1.1 * base[k] + 1e-5);
    EXPECT_DOUBLE_EQ(own[41 + k], 1.1 * base[41 + k]);
    EXPECT_DOUBLE_EQ(replaced[k], 0.9 * base[k]);
    EXPECT_DOUBLE_EQ(replaced[41 + k], 1.1 * base[41 + k]);
  }
}

TEST(SensorResponse, ATableOfNoSensorIsAnErrorWithASuggestion) {
  try {
    (void)small_case(enabled + "[mechanism.sensor_response.TT]\ngain = 0.9\n");
    FAIL() << "it should have been refused";
  } catch (const InputError& e) {
    EXPECT_EQ(e.parts().key, "mechanism.sensor_response.TT");
    EXPECT_THAT(e.what(), HasSubstr("did you mean \"T\""));
  }
}

// A parameter of one gauge leaves the others unchanged, and a common parameter skips a gauge that has its own.
TEST(SensorResponse, ParametersReachOneGaugeOrAll) {
  const std::string one = "[parameter.g]\nkey = \"mechanism.sensor_response.F.gain\"\nmin = 0.8\nmax = 1.2\n";
  const std::string all = "[parameter.g]\nkey = \"mechanism.sensor_response.gain\"\nmin = 0.8\nmax = 1.2\n";
  const auto base = strain("");
  const std::vector<double> theta{1.2};
  const auto of_one = BuiltInModel(small_case(enabled + one), {.pulses = 1}).evaluate(theta).mean;
  const auto of_all = BuiltInModel(small_case(enabled + all + "[mechanism.sensor_response.T]\ndelay = 0.0\n"), {.pulses = 1}).evaluate(theta).mean;
  for (std::size_t k = 0; k < 41; ++k) {
    EXPECT_EQ(of_one[k], base[k]);
    EXPECT_DOUBLE_EQ(of_one[41 + k], 1.2 * base[41 + k]);
    EXPECT_DOUBLE_EQ(of_all[k], 1.2 * base[k]);
  }
}
