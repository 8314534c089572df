#include "forward/sensor/gauge.hpp"

#include <gmock/gmock.h>

#include "forward/mesh/make_mesh.hpp"

using namespace calomel;
using hexahedron::Point;
using ::testing::HasSubstr;

namespace {

GeometryOptions box(double element_size) {
  GeometryOptions g;
  g.kind = "box";
  g.length = 0.08;
  g.width = 0.06;
  g.height = 0.05;
  g.wall = 0.003;
  g.element_size = element_size;
  return g;
}

SensorOptions sensor(std::array<double, 3> position, std::array<double, 3> direction, double gauge_length = 0) {
  SensorOptions s;
  s.name = "B";
  s.position = position;
  s.direction = direction;
  s.gauge_length = gauge_length;
  return s;
}

/// u = G x at every node.
std::vector<Vec3> linear(const Mesh& mesh, const Eigen::Matrix3d& G) {
  std::vector<Vec3> u;
  for (const auto& x : mesh.nodes) u.push_back(hexahedron::vec3(G * hexahedron::point(x)));
  return u;
}

Eigen::Matrix3d some_gradient() {
  Eigen::Matrix3d G;
  G << 1.1, 0.3, -0.7, 0.2, -0.4, 0.5, 0.9, -0.6, 0.8;
  return G;
}

void expect_exact(const Mesh& mesh, const LocatedGauge& g) {
  const Eigen::Matrix3d G = some_gradient();
  const auto u = linear(mesh, G);
  const Point d = hexahedron::point(g.direction), t = hexahedron::point(g.normal).cross(d);
  EXPECT_NEAR(d.norm(), 1, 1e-12);
  EXPECT_NEAR(g.axial(u), d.dot(G * d), 1e-9);
  EXPECT_NEAR(g.transverse(u), t.dot(G * t), 1e-9);
  EXPECT_NEAR(g.shear(u), d.dot(G * t) + t.dot(G * d), 1e-9);
  // A rigid motion: translation and rotation.
  Eigen::Matrix3d W;
  W << 0, -3, 2, 3, 0, -1, -2, 1, 0;
  auto rigid = linear(mesh, W);
  for (auto& v : rigid) v[0] += 5, v[1] -= 2, v[2] += 1;
  for (const auto* row : {&g.axial, &g.transverse, &g.shear}) EXPECT_NEAR((*row)(rigid), 0, 1e-8);
}

/// On a curved surface transverse and shear strains are means over faces of several planes; the axial strain is exact
/// along the chord.
void expect_exact_axial(const Mesh& mesh, const LocatedGauge& g) {
  const Eigen::Matrix3d G = Eigen::Matrix3d::Identity() * 3;
  EXPECT_NEAR(g.axial(linear(mesh, G)), 3, 1e-8);
  EXPECT_NEAR(g.transverse(linear(mesh, G)), 3, 1e-8);
  Eigen::Matrix3d W;
  W << 0, -3, 2, 3, 0, -1, -2, 1, 0;
  for (const auto* row : {&g.axial, &g.transverse}) EXPECT_NEAR((*row)(linear(mesh, W)), 0, 1e-8);
}

}  // namespace

TEST(Gauge, IsExactInALinearDisplacementAndZeroInARigidMotion) {
  const Mesh m = make_mesh(box(0.004));
  const GaugeLocator locator(m);
  for (const double l : {0.0, 0.002, 0.007}) {
    expect_exact(m, locator.locate(sensor({0.0312, 0.0107, 0.05}, {1, 0.2, 0}, l)));
    expect_exact(m, locator.locate(sensor({0.04, 0.0, 0.0}, {1, 0, 0}, l)));
    expect_exact(m, locator.locate(sensor({0.0, -0.013, 0.02}, {0, 0.3, 1}, l)));
    expect_exact(m, locator.locate(sensor({0.05, 0.03, 0.02}, {1, 0, 1}, l)));
  }
}

TEST(Gauge, ElementCentreStrainIsExactInALinearDisplacement) {
  const Mesh m = make_mesh(box(0.004));
  auto s = sensor({0.0312, 0.0107, 0.05}, {1, 0.2, 0}, 0.002);
  s.placement = "element_centre";
  const auto g = locate_gauge(m, s);
  EXPECT_EQ(g.axial.nodes.size(), 8u);
  expect_exact(m, g);
}

// For u_x = sin(kx) the strain over a length l is the finite difference over l, to second order in the element size.
TEST(Gauge, ConvergesToTheMeanStrainOverItsLength) {
  const double k = 60, x = 0.0407, l = 0.006;
  std::vector<double> error, point_error;
  for (const double h : {0.004, 0.002, 0.001}) {
    auto options = box(h);
    options.plane_strain = true;
    const Mesh m = make_mesh(options);
    std::vector<Vec3> u;
    for (const auto& p : m.nodes) u.push_back({std::sin(k * p[0]), 0, 0});
    error.push_back(std::abs(locate_gauge(m, sensor({x, 0, 0.05}, {1, 0, 0}, l)).axial(u) - (std::sin(k * (x + l / 2)) - std::sin(k * (x - l / 2))) / l));
    point_error.push_back(std::abs(locate_gauge(m, sensor({x, 0, 0.05}, {1, 0, 0})).axial(u) - k * std::cos(k * x)));
  }
  EXPECT_LT(error[2], 0.001 * k);
  EXPECT_LT(point_error[2], 0.005 * k);
  EXPECT_LT(point_error[2], point_error[0] / 8);
}

TEST(Gauge, OfAHalfModelIsMirrored) {
  auto options = box(0.004);
  const Mesh full = make_mesh(options);
  options.half = true;
  const Mesh half = make_mesh(options);
  // The field is symmetric about y = 0.
  const auto field = [](const Mesh& m) {
    std::vector<Vec3> u;
    for (const auto& [x, y, z] : m.nodes) u.push_back({std::sin(20 * x) * std::cos(30 * y), std::sin(30 * y) * x, z + 10 * y * y * x});
    return u;
  };
  for (const double l : {0.0, 0.003})
    for (const double y : {-0.011, 0.011, 0.0, 0.0005, -0.0005}) {
      const auto s = sensor({0.03, y, 0.05}, {1, 0.4, 0}, l);
      const auto a = locate_gauge(full, s), b = locate_gauge(half, s);
      EXPECT_EQ(b.mirrored, y < 0);
      EXPECT_GE(b.placed[1], 0);
      EXPECT_NEAR(b.direction[1], y < 0 ? -a.direction[1] : a.direction[1], 1e-12);
      const auto ua = field(full), ub = field(half);
      // The two meshes differ away from the plane: values are compared within the discretisation error, signs exactly.
      EXPECT_NEAR(a.axial(ua), b.axial(ub), 0.02 * std::abs(a.axial(ua)) + 0.02) << y << ' ' << l;
      EXPECT_NEAR(a.transverse(ua), b.transverse(ub), 0.05) << y << ' ' << l;
      EXPECT_NEAR(a.shear(ua), b.shear(ub), 0.1) << y << ' ' << l;
    }
}

TEST(Gauge, OnAPlaneStrainSliceIgnoresY) {
  auto options = box(0.002);
  options.plane_strain = true;
  const Mesh m = make_mesh(options);
  std::vector<Vec3> u;
  for (const auto& x : m.nodes) u.push_back({2 * x[0] + x[2], 0, 3 * x[0] - x[2]});
  for (const double l : {0.0, 0.005}) {
    const auto g = locate_gauge(m, sensor({0.03, 0.02, 0.05}, {1, 0, 0}, l));
    EXPECT_NEAR(g.distance, 0, 1e-15);
    EXPECT_NEAR(g.axial(u), 2, 1e-10);
    EXPECT_NEAR(g.transverse(u), 0, 1e-10);
    EXPECT_NEAR(g.shear(u), 0, 1e-10);
    EXPECT_NEAR(locate_gauge(m, sensor({0.03, 0, 0.05}, {1, 1, 0}, l)).axial(u), 1, 1e-10);
    EXPECT_NEAR(locate_gauge(m, sensor({0.03, 0, 0.05}, {0, 1, 0}, l)).axial(u), 0, 1e-10);
  }
}

TEST(Gauge, IsMovedToTheSurfaceAndReportsTheDistance) {
  const Mesh m = make_mesh(box(0.004));
  const auto g = locate_gauge(m, sensor({0.03, 0.01, 0.052}, {1, 0, 0.1}));
  EXPECT_NEAR(g.distance, 0.002, 1e-12);
  EXPECT_NEAR(g.placed[2], 0.05, 1e-12);
  EXPECT_NEAR(g.normal[2], 1, 1e-12);
  EXPECT_NEAR(g.direction[0], 1, 1e-12);
  // On an edge the gauge takes the face that contains its direction.
  EXPECT_NEAR(locate_gauge(m, sensor({0.0, 0.01, 0.05}, {1, 0, 0})).normal[2], 1, 1e-12);
  EXPECT_NEAR(locate_gauge(m, sensor({0.0, 0.01, 0.05}, {0, 0, 1})).normal[0], -1, 1e-12);
}

TEST(Gauge, IsExactOnACurvedNoseToo) {
  GeometryOptions options;
  options.kind = "jet_flow";
  options.element_size = 0.006;
  const Mesh m = make_mesh(options);
  const GaugeLocator locator(m);
  for (const double l : {0.0, 0.003, 0.01}) {
    expect_exact_axial(m, locator.locate(sensor({0.0, 0.031, 0.06}, {0, 0.3, 1}, l)));
    expect_exact_axial(m, locator.locate(sensor({0.018, -0.031, 0.018}, {1, 0, -1}, l)));
    expect_exact_axial(m, locator.locate(sensor({0.3, 0.2, 0.05}, {1, 0, 0}, l)));
  }
  EXPECT_LT(locator.locate(sensor({0.0, 0.031, 0.06}, {0, 0, 1})).distance, 1e-4);
}

TEST(Gauge, OfAQuarterBarIsMirroredInBothPlanes) {
  GeometryOptions options;
  options.kind = "bar";
  options.length = 0.05;
  options.radius = 0.01;
  const Mesh m = make_mesh(options);
  // The field is symmetric about both planes: u_x even, u_y odd in y, u_z odd in z.
  std::vector<Vec3> u;
  for (const auto& [x, y, z] : m.nodes) u.push_back({2 * x, -3 * y, 5 * z});
  for (const double y : {0.0, 0.006, -0.006})
    for (const double z : {0.008, -0.008}) {
      const auto g = locate_gauge(m, sensor({0.02, y, z}, {1, 0, 0}, 0.002));
      EXPECT_NEAR(g.axial(u), 2, 1e-9);
      EXPECT_EQ(g.mirrored, y < 0 || z < 0);
      EXPECT_GE(g.placed[2], 0);
    }
  // The gauge lies across the plane z = 0, transverse to the axis.
  EXPECT_NEAR(locate_gauge(m, sensor({0.02, 0.01, 0.0}, {0, 0, 1}, 0.002)).axial(u), 5, 0.1);
}

// gamma changes its sign with the handedness of (d, t): a mirrored gauge reads the value of the original.
TEST(Gauge, ShearOfAMirroredGaugeKeepsItsSign) {
  auto options = box(0.004);
  const Mesh full = make_mesh(options);
  options.half = true;
  const Mesh half = make_mesh(options);
  const auto field = [](const Mesh& m) {
    std::vector<Vec3> u;
    for (const auto& [x, y, z] : m.nodes) u.push_back({y * y, 0, 0});  // gamma_xy = 2 y
    return u;
  };
  const auto s = sensor({0.03, -0.015, 0.05}, {1, 0, 0});
  const double a = locate_gauge(full, s).shear(field(full)), b = locate_gauge(half, s).shear(field(half));
  EXPECT_NEAR(a, -0.03, 2e-3);
  EXPECT_NEAR(b, a, 2e-3);
}

TEST(Gauge, MistakesNameTheSensorAndTheKey) {
  const Mesh m = make_mesh(box(0.004));
  const auto mistake = [&](const SensorOptions& s) {
    try {
      (void)locate_gauge(m, s);
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr("\"B\""));
      return e.parts().key;
    }
    return std::string("none");
  };
  EXPECT_EQ(mistake(sensor({0.03, 0.01, 0.06}, {1, 0, 0})), "position");
  EXPECT_EQ(mistake(sensor({0.08, 0.01, 0.025}, {0, 0, 1})), "position");  // the cut at the rear is not a surface
  EXPECT_EQ(mistake(sensor({0.03, 0.01, 0.05}, {0, 0.1, 1})), "direction");
  EXPECT_EQ(mistake(sensor({0.03, 0.01, 0.05}, {0, 0, 0})), "direction");
  EXPECT_EQ(mistake(sensor({0.001, 0.01, 0.05}, {1, 0, 0}, 0.01)), "gauge_length");
  EXPECT_EQ(mistake(sensor({0.03, 0.01, 0.05}, {1, 0, 0}, 0.01)), "none");
}
