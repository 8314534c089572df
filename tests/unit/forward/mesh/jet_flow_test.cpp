#include <gmock/gmock.h>

#include <numbers>

#include "forward/mesh/make_mesh.hpp"
#include "tests/unit/forward/mesh/mesh_checks.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {
GeometryOptions target(double element_size) {
  GeometryOptions g;
  g.kind = "jet_flow";
  g.element_size = element_size;
  g.half = true;
  return g;
}
}  // namespace

TEST(JetFlow, EveryElementIsSoundForSeveralSizesAndShapes) {
  std::vector<GeometryOptions> shapes{target(0.006), target(0.009)};
  shapes.push_back(target(0.008));
  shapes.back().half = false;
  shapes.push_back(target(0.008));  // a blunt nose, thick bottom, rear wall, uneven plates
  shapes.back().nose_radius = 0.05;
  shapes.back().walls.bottom = 0.005;
  shapes.back().rear = "wall";
  shapes.back().jet.upper_turn = 35;
  shapes.push_back(target(0.008));  // no plates
  shapes.back().jet.thickness = 0;
  shapes.push_back(target(0.008));  // plates that end early
  shapes.back().jet.lower_turn = 0;
  shapes.back().jet.upper_turn = 80;
  shapes.push_back(target(0.008));
  shapes.back().wetted = "tied";
  for (const auto& g : shapes) {
    const Mesh m = make_mesh(g);
    SCOPED_TRACE(m.elements.size());
    expect_sound(m, 0.4);
    EXPECT_EQ(double(m.elements.size()), g.estimated_elements());
    EXPECT_GE(m.quality.least_wall_elements, 2);
    EXPECT_EQ(m.rear.empty(), g.rear == "wall");
  }
}

TEST(JetFlow, VolumeConvergesToThatOfTheDrawing) {
  // The section is the front half of a stadium and a rectangle.
  const double L = 0.55, W = 0.4, H = 0.12, R = H / 2, t = 0.004, c = 0.02, b = 0.005;
  const double whole = (L - R) * H + std::numbers::pi * R * R / 2;
  // The wall has straight legs. Round the nose its area is the integral of (R - t/2) t over the angle, t = wall + (window - wall) sin^2.
  double nose = 0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double a = std::numbers::pi * (i + 0.5) / n, s = std::sin(a), wall = t + (0.002 - t) * s * s;
    nose += (R - wall / 2) * wall * std::numbers::pi / n;
  }
  // The plates are straight, and the lower one is bent by 50 degrees, where the thickness of the wall varies too.
  double plate = 2 * (L - R) * b;
  for (int i = 0; i < n; ++i) {
    const double a = 50 * std::numbers::pi / 180 * (i + 0.5) / n, s = std::sin(a), wall = t + (0.002 - t) * s * s;
    plate += ((R - wall - c) - b / 2) * b * 50 * std::numbers::pi / 180 / n;
  }
  const double mercury = (whole - 2 * (L - R) * t - nose - plate) * (W / 2 - t), steel = whole * W / 2 - mercury;
  double before = 1;
  for (const double h : {0.012, 0.006}) {
    const Mesh m = make_mesh(target(h));
    const double error = std::abs(m.quality.mercury_volume - mercury) / mercury;
    EXPECT_LT(error, 3e-3);
    EXPECT_LT(error, before / 2);
    EXPECT_NEAR(m.quality.steel_volume, steel, 0.01 * steel);
    before = error;
  }
}

TEST(JetFlow, HalfHasHalfTheVolume) {
  auto g = target(0.008);
  const Mesh half = make_mesh(g);
  g.half = false;
  const Mesh full = make_mesh(g);
  EXPECT_NEAR(2 * half.quality.mercury_volume, full.quality.mercury_volume, 1e-10);
  EXPECT_NEAR(2 * half.quality.steel_volume, full.quality.steel_volume, 1e-10);
  EXPECT_NEAR(2 * area(half, half.outer), area(full, full.outer), 1e-10);
  EXPECT_NEAR(2 * area(half, half.wetted), area(full, full.wetted), 1e-10);
}

TEST(JetFlow, ImpossibleShapesAreRefused) {
  const auto key_of = [](const GeometryOptions& g) {
    try {
      g.validate();
    } catch (const InputError& e) {
      return e.parts().key;
    }
    return std::string("none");
  };
  auto g = target(0.006);
  EXPECT_EQ(key_of(g), "none");
  g.nose_radius = 0.07;
  EXPECT_EQ(key_of(g), "nose_radius");
  g = target(0.006);
  g.jet.channel = 0.045;
  EXPECT_EQ(key_of(g), "jet.channel");
  g = target(1e-9);
  EXPECT_EQ(key_of(g), "element_size");
  g = target(0.006);
  g.walls.front = 0.003;
  EXPECT_EQ(key_of(g), "walls.front");
}
