// A target gives the same results from a mesh that was made here and from a mesh file, for any order and place of nodes and elements.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>

#include "base/random.hpp"
#include "forward/target/built_in_model.hpp"
#include "forward/mesh/make_mesh.hpp"
#include "forward/mesh/mesh_file.hpp"
#include "forward/mesh/write_mesh.hpp"
#include "tests/scratch.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

ForwardCase target(const std::string& kind, double end) {
  ForwardCase c;
  auto& g = c.geometry;
  g.kind = kind;
  if (kind == "box") {
    g.length = 0.06;
    g.width = 0.05;
    g.height = 0.04;
    g.wall = 0.004;
    g.element_size = 0.004;
    g.half = true;
  } else {
    g.element_size = 0.012;
    g.half = true;
  }
  c.load.peak_pressure = 25e6;
  c.load.profile.center = {0.0, 0.02};
  c.time.end = end;
  c.time.output_interval = end / 20;
  const double top = kind == "box" ? 0.04 : 0.12;
  int n = 0;
  for (const Vec3& at : {Vec3{0.03, 0.0, top}, Vec3{0.04, -0.007, top}, Vec3{0.035, 0.011, 0.0}}) {
    SensorOptions s;
    s.name = std::string(1, char('A' + n));
    s.position = {kind == "box" ? at[0] : 0.1 + at[0], at[1], at[2]};
    s.direction = {1, 0.5 * n, 0};
    s.gauge_length = n == 2 ? 0.004 : 0;
    s.max_distance = 1e-3;
    c.sensors.push_back(s);
    ++n;
  }
  return c;
}

std::vector<double> strain(const ForwardCase& c) { return BuiltInModel(c, {.pulses = 1}).simulate({}).strain; }

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double d = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) d = std::max(d, std::abs(a[i] - b[i])), size = std::max(size, std::abs(b[i]));
  return d / size;
}

ForwardCase from(ForwardCase c, const std::filesystem::path& path) {
  c.geometry = {};
  c.geometry.kind = "mesh";
  c.geometry.file = path.string();
  return c;
}

/// Writes `mesh` again as Abaqus input: nodes and elements in random order with gaps in their numbers, every hexahedron
/// turned to one of its 24 orientations, and the whole moved; with `reversed`, y changes its sign.
void write_shuffled(const MeshFile& mesh, const std::filesystem::path& path, const Vec3& move, bool reversed) {
  std::mt19937_64 random(7);
  std::vector<std::size_t> node(mesh.nodes.size()), element(mesh.elements.size());
  std::iota(node.begin(), node.end(), 0), std::iota(element.begin(), element.end(), 0);
  std::shuffle(node.begin(), node.end(), random), std::shuffle(element.begin(), element.end(), random);
  std::vector<std::size_t> label(mesh.nodes.size());
  std::ofstream out(path);
  out.precision(17);
  out << "*NODE\n";
  for (std::size_t i = 0; i < node.size(); ++i) {
    const auto& x = mesh.nodes[node[i]];
    label[node[i]] = 10 + 3 * i;
    out << label[node[i]] << ", " << x[0] + move[0] << ", " << (reversed ? -x[1] : x[1]) + move[1] << ", " << x[2] + move[2] << '\n';
  }
  // Right-handed orders of the corners: images (+-axis, +-axis, +-axis) of the three coordinates.
  std::vector<std::array<std::size_t, 8>> turns;
  for (const auto& p : {std::array{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}})
    for (int flips = 0; flips < 8; ++flips) {
      const bool odd = (p[1] == (p[0] + 2) % 3) != (__builtin_popcount(unsigned(flips)) % 2 == 1);
      if (odd != reversed) continue;
      std::array<std::size_t, 8> turn{};
      for (std::size_t a = 0; a < 8; ++a) {
        std::size_t to = 0;
        for (std::size_t k = 0; k < 3; ++k) to |= ((a >> k & 1) ^ (std::size_t(flips) >> k & 1)) << p[k];
        turn[a] = to;
      }
      turns.push_back(turn);
    }
  constexpr std::array<std::size_t, 8> order{0, 1, 3, 2, 4, 5, 7, 6};
  for (const auto& name : {"steel", "mercury"}) {
    const auto& set = mesh.element_sets.at(name);
    out << "*ELEMENT, TYPE=C3D8, ELSET=" << name << '\n';
    for (const auto e : element) {
      if (std::find(set.begin(), set.end(), std::int32_t(e)) == set.end()) continue;
      const auto& turn = turns[random() % turns.size()];
      out << 1000 + 2 * e;
      for (const auto a : order) out << ", " << label[std::size_t(mesh.elements[e][turn[a]])];
      out << '\n';
    }
  }
  const auto write_nodes = [&](const std::string& name, std::vector<NodeId> nodes) {
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    out << "*NSET, NSET=" << name << '\n';
    for (const NodeId n : nodes) out << label[std::size_t(n)] << '\n';
  };
  write_nodes("symmetry_y", mesh.node_sets.at("symmetry_y"));
  std::vector<NodeId> rear;
  for (const FaceId f : mesh.side_sets.at("rear"))
    for (const NodeId n : face_nodes(mesh.elements, f)) rear.push_back(n);
  write_nodes("rear", rear);
}

}  // namespace

TEST(OutsideMesh, TargetsThroughAFileGiveTheSameBits) {
  for (const char* kind : {"box", "jet_flow"}) {
    const ForwardCase c = target(kind, 2e-5);
    const auto own = strain(c);
    for (const char* ending : {"inp", "exo"}) {
      const auto path = scratch_file(std::string(kind) + '.' + ending);
      write_mesh(make_mesh(c.geometry), path);
      const double d = difference(strain(from(c, path)), own);
      measured(std::string(kind) + "_through_" + ending, d);
      EXPECT_EQ(d, 0);
    }
  }
}

TEST(OutsideMesh, OrderTurnsAndPlaceChangeTheResultByRoundingAlone) {
  const ForwardCase c = target("box", 2e-5);
  const auto own = strain(c);
  write_mesh(make_mesh(c.geometry), scratch_file("own.inp"));
  const MeshFile file = read_mesh_file(scratch_file("own.inp"));
  write_shuffled(file, scratch_file("shuffled.inp"), {0, 0, 0}, false);
  const double shuffled = difference(strain(from(c, scratch_file("shuffled.inp"))), own);
  measured("shuffled", shuffled);
  EXPECT_LT(shuffled, 1e-9);

  // The symmetry plane is at y = 0.3 with the mesh above or below it; gauges on either side are mapped to the mesh.
  for (const bool reversed : {false, true}) {
    write_shuffled(file, scratch_file("moved.inp"), {0, 0.3, 0}, reversed);
    ForwardCase moved = from(c, scratch_file("moved.inp"));
    moved.load.profile.center[0] += 0.3;
    for (auto& s : moved.sensors) {
      s.position[1] = (reversed ? -s.position[1] : s.position[1]) + 0.3;
      if (reversed) s.direction[1] *= -1;
    }
    const double d = difference(strain(moved), own);
    measured(reversed ? "moved_and_mirrored" : "moved", d);
    EXPECT_LT(d, 1e-9);
  }
  // Controls: a gauge on the wrong side of its mirror, and a wall that is 1 % thicker.
  ForwardCase wrong = from(c, scratch_file("shuffled.inp"));
  wrong.sensors[1].position[1] += 0.003;
  EXPECT_GT(difference(strain(wrong), own), 1e-4);
  ForwardCase thicker = c;
  thicker.geometry.wall = 0.00404;
  EXPECT_GT(difference(strain(thicker), own), 1e-4);
}
