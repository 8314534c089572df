#include <gmock/gmock.h>
#include <exodusII.h>

#include <fstream>

#include "base/artefact.hpp"
#include "forward/mesh/exodus_fields.hpp"
#include "forward/mesh/make_mesh.hpp"
#include "forward/mesh/mesh_file.hpp"
#include "forward/mesh/write_mesh.hpp"
#include "tests/scratch.hpp"
#include "tests/unit/forward/mesh/mesh_checks.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

namespace {

GeometryOptions box(double size) {
  GeometryOptions g;
  g.kind = "box";
  g.length = 0.05;
  g.width = 0.04;
  g.height = 0.03;
  g.wall = 0.004;
  g.element_size = size;
  return g;
}

std::vector<std::pair<std::string, GeometryOptions>> targets() {
  std::vector<std::pair<std::string, GeometryOptions>> all{
      {"full", box(0.005)}, {"half", box(0.005)}, {"plane_strain", box(0.002)}, {"tied", box(0.005)}, {"closed", box(0.005)}};
  all[1].second.half = true;
  all[2].second.plane_strain = true;
  all[3].second.wetted = "tied";
  all[4].second.rear = "wall";
  all[4].second.wall_elements = 3;
  GeometryOptions jet;
  jet.kind = "jet_flow";
  jet.element_size = 0.012;
  jet.half = true;
  all.emplace_back("jet_flow", jet);
  GeometryOptions bar;
  bar.kind = "bar";
  bar.radius = 0.01;
  bar.length = 0.05;
  all.emplace_back("bar", bar);
  bar.quarter = false;
  all.emplace_back("whole_bar", bar);
  return all;
}

GeometryOptions from(const std::filesystem::path& path, const std::string& wetted = "slip") {
  GeometryOptions g;
  g.kind = "mesh";
  g.file = path.filename().string();
  g.folder = path.parent_path();
  g.wetted = wetted;
  return g;
}

void expect_same_faces(const std::vector<Face>& a, const std::vector<Face>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].nodes, b[i].nodes);
    EXPECT_EQ(a[i].element, b[i].element);
  }
}

/// Meshes are equal: positions within `tolerance` [m], everything else exactly.
void expect_same(const Mesh& a, const Mesh& b, double tolerance = 0) {
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t n = 0; n < a.nodes.size(); ++n)
    for (int i = 0; i < 3; ++i) ASSERT_NEAR(a.nodes[n][i], b.nodes[n][i], tolerance) << "node " << n;
  EXPECT_EQ(a.elements, b.elements);
  EXPECT_EQ(a.region, b.region);
  EXPECT_EQ(a.fixed, b.fixed);
  EXPECT_EQ(a.plane_strain, b.plane_strain);
  EXPECT_EQ(a.liquid_element_size, b.liquid_element_size);
  EXPECT_EQ(a.quality.least_wall_elements, b.quality.least_wall_elements);
  expect_same_faces(a.outer, b.outer);
  expect_same_faces(a.wetted, b.wetted);
  expect_same_faces(a.rear, b.rear);
  expect_same_faces(a.loaded, b.loaded);
  ASSERT_EQ(a.slip.size(), b.slip.size());
  std::map<NodeId, SlipPair> pair;  // the order of the pairs is free
  for (const auto& p : a.slip) pair[p.steel] = p;
  for (const auto& p : b.slip) {
    ASSERT_TRUE(pair.contains(p.steel));
    EXPECT_EQ(pair[p.steel].mercury, p.mercury);
    EXPECT_EQ(pair[p.steel].count, p.count);
    EXPECT_EQ(pair[p.steel].normals, p.normals);
  }
  ASSERT_EQ(a.mirrors.size(), b.mirrors.size());
  for (std::size_t i = 0; i < a.mirrors.size(); ++i) {
    EXPECT_EQ(a.mirrors[i].axis, b.mirrors[i].axis);
    EXPECT_EQ(a.mirrors[i].at, b.mirrors[i].at);
    EXPECT_EQ(a.mirrors[i].above, b.mirrors[i].above);
  }
}

/// An Abaqus file of 10 elements of 1 cm: mercury of 2 x 1 x 1 elements between two layers of steel below and two above.
/// All other sides are symmetry planes.
std::string column() {
  std::string s = "*Heading\nanything\n** a comment\n*Node\n";
  int n = 0;
  for (int k = 0; k <= 5; ++k)
    for (int j = 0; j <= 1; ++j)
      for (int i = 0; i <= 2; ++i)
        s += std::to_string(++n) + ", " + std::to_string(i * 0.01) + ", " + std::to_string(j * 0.01) + ", " + std::to_string(k * 0.01) + "\n";
  const auto node = [](int i, int j, int k) { return std::to_string(1 + i + 3 * j + 6 * k); };
  for (int k = 0; k < 5; ++k) {
    s += "*ELEMENT, Type=C3D8R, elset=" + std::string(k == 2 ? "fluid" : k < 2 ? "Lower" : "upper") + "\n";
    for (int i = 0; i < 2; ++i)
      s += std::to_string(1 + i + 2 * k) + ", " + node(i, 0, k) + ", " + node(i + 1, 0, k) + ", " + node(i + 1, 1, k) + ", " + node(i, 1, k) + ",\n " +
           node(i, 0, k + 1) + ", " + node(i + 1, 0, k + 1) + ", " + node(i + 1, 1, k + 1) + ", " + node(i, 1, k + 1) + "\n";
  }
  s += "*ELSET, ELSET=walls\nlower, UPPER\n*Elset, elset=odd, generate\n1, 9, 2\n";
  s += "*NSET, NSET=left, GENERATE\n1, 34, 3\n*NSET, NSET=right, GENERATE\n3, 36, 3\n*NSET, NSET=ends\nleft, right\n";
  s += "*SURFACE, NAME=sides, TYPE=ELEMENT\nlower, S3\nlower, S5\nfluid, S3\nfluid, S5\nupper, S3\nupper, S5\n";
  s += "*SOLID SECTION, ELSET=walls, MATERIAL=\"Steel 316L\"\n*SOLID SECTION, ELSET=fluid, MATERIAL=Mercury\n*MATERIAL, NAME=Mercury\n*DENSITY\n13500\n";
  return s;
}

GeometryOptions column_options(const std::string& name, const std::string& text) {
  std::ofstream(scratch_file(name)) << text;
  GeometryOptions g = from(scratch_file(name));
  g.sets.symmetry_x = {"ends"};
  g.sets.symmetry_y = {"SIDES"};
  return g;
}

std::string message_of(const GeometryOptions& g) {
  try {
    (void)make_mesh(g);
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

std::string with(std::string text, const std::string& old, const std::string& now) {
  EXPECT_NE(text.find(old), std::string::npos) << old;
  return text.replace(text.find(old), old.size(), now);
}

}  // namespace

TEST(OutsideMesh, ComesBackTheSameThroughBothFormats) {
  for (const auto& [name, g] : targets()) {
    const Mesh before = make_mesh(g);
    for (const char* ending : {".inp", ".exo"}) {
      SCOPED_TRACE(name + ending);
      const auto path = scratch_file(name + ending);
      write_mesh(before, path);
      const Mesh after = make_mesh(from(path, g.wetted));
      // Abaqus reads at most 20 characters of a number, so the last digit of a small coordinate may be rounded.
      expect_same(before, after, ending == std::string(".inp") ? 1e-17 : 0);
      if (g.kind != "bar") expect_sound(after, 0.2);
      EXPECT_THAT(after.notes, ::testing::IsEmpty());
    }
  }
}

TEST(OutsideMesh, ReadsGeneratedSetsSetsOfSetsAndMaterialsOfAbaqusFiles) {
  const Mesh m = make_mesh(column_options("column.inp", column()));
  EXPECT_EQ(m.elements.size(), 10u);
  EXPECT_NEAR(m.quality.mercury_volume, 2e-6, 1e-18);
  EXPECT_NEAR(m.quality.steel_volume, 8e-6, 1e-18);
  EXPECT_EQ(m.quality.least_wall_elements, 2);
  EXPECT_EQ(m.slip.size(), 12u);
  EXPECT_TRUE(m.plane_strain);
  EXPECT_TRUE(m.mirrors.empty());
  EXPECT_EQ(m.outer.size(), 4u);
  ASSERT_EQ(m.notes.size(), 1u);
  EXPECT_THAT(m.notes[0], HasSubstr("taken to y = 0"));
  for (const auto& x : m.nodes) EXPECT_NEAR(std::abs(x[1]), 0.005, 1e-15);
  const MeshFile file = read_mesh_file(scratch_file("column.inp"));
  EXPECT_THAT(file.element_sets.at("odd"), ::testing::ElementsAre(0, 2, 4, 6, 8));
  EXPECT_EQ(file.node_sets.at("ends").size(), 24u);
}

TEST(OutsideMesh, ScaleAndLooseNodesAndMerging) {
  // The upper wall gets nodes of its own, like parts that were meshed separately.
  std::string text = column();
  const Mesh whole = make_mesh(column_options("whole.inp", text));
  std::string own = "*NODE, NSET=again\n";
  for (int j = 0; j <= 1; ++j)
    for (int i = 0; i <= 2; ++i)
      own += std::to_string(101 + i + 3 * j) + ", " + std::to_string(i * 0.01) + ", " + std::to_string(j * 0.01) + ", 0.0300000001\n";
  own += "200, 1, 1, 1\n*NSET, NSET=left\n101, 104\n*NSET, NSET=right\n103, 106\n";
  const auto upper = text.find("*ELEMENT, Type=C3D8R, elset=upper");
  text = text.substr(0, upper) + own + text.substr(upper);
  text = with(text, "\n7, 19, 20, 23, 22,", "\n7, 101, 102, 105, 104,");
  text = with(text, "\n8, 20, 21, 24, 23,", "\n8, 102, 103, 106, 105,");
  GeometryOptions g = column_options("parts.inp", text);
  EXPECT_THAT(message_of(g), HasSubstr("6 pairs of nodes"));
  EXPECT_THAT(message_of(g), HasSubstr("(mercury)"));
  EXPECT_THAT(message_of(g), HasSubstr("merge_distance"));
  g.merge_distance = 1e-8;
  const Mesh merged = make_mesh(g);
  EXPECT_EQ(merged.elements, whole.elements);
  EXPECT_THAT(merged.notes, ::testing::Contains(HasSubstr("6 nodes nearer")));
  EXPECT_THAT(merged.notes, ::testing::Contains(HasSubstr("1 nodes of")));
  g.merge_distance = 0.0101;
  EXPECT_THAT(message_of(g), HasSubstr("would become one"));

  GeometryOptions scaled = column_options("scaled.inp", column());
  scaled.scale = 1e3;
  const Mesh large = make_mesh(scaled);
  EXPECT_NEAR(large.quality.mercury_volume, 2e3, 1e-6);
  EXPECT_THAT(large.notes, ::testing::Contains(HasSubstr("millimetres")));
}

// Exodus field files hold split nodes in single precision.
TEST(OutsideMesh, ReadsWhatTheFieldWriterWritesOnceItsNodesAreMerged) {
  GeometryOptions g = box(0.005);
  g.half = true;
  const Mesh before = make_mesh(g);
  const auto path = scratch_file("fields.exo");
  ExodusFieldWriter(path, before).commit();
  EXPECT_THAT(message_of(from(path)), HasSubstr("parts touch without sharing nodes"));
  GeometryOptions again = from(path);
  again.merge_distance = 1e-6;
  const Mesh after = make_mesh(again);
  EXPECT_EQ(after.elements, before.elements);
  EXPECT_EQ(after.slip.size(), before.slip.size());
  EXPECT_EQ(after.rear.size(), before.rear.size());
  EXPECT_EQ(after.mirrors.size(), 1u);
}

TEST(OutsideMesh, LongIntegersAndSetsWithoutNames) {
  const auto path = scratch_file("long.exo");
  int memory = 8, disk = 8;
  const int id = ex_create(path.c_str(), EX_CLOBBER | EX_NETCDF4 | EX_ALL_INT64_DB | EX_ALL_INT64_API, &memory, &disk);
  ASSERT_GE(id, 0);
  // Two cubes of steel along x.
  std::array<std::vector<double>, 3> x;
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 3; ++i) x[0].push_back(i), x[1].push_back(j), x[2].push_back(k);
  ex_put_init(id, "two cubes", 3, 12, 2, 1, 0, 1);
  ex_put_coord(id, x[0].data(), x[1].data(), x[2].data());
  ex_put_block(id, EX_ELEM_BLOCK, 5000000000, "hex", 2, 8, 0, 0, 0);
  const std::vector<std::int64_t> nodes{1, 2, 5, 4, 7, 8, 11, 10, 2, 3, 6, 5, 8, 9, 12, 11}, elements{1}, sides{4};
  ex_put_conn(id, EX_ELEM_BLOCK, 5000000000, nodes.data(), nullptr, nullptr);
  ex_put_set_param(id, EX_SIDE_SET, 7, 1, 0);
  ex_put_set(id, EX_SIDE_SET, 7, elements.data(), sides.data());
  ex_close(id);
  GeometryOptions g = from(path);
  EXPECT_THAT(message_of(g), HasSubstr("block_5000000000"));
  g.sets.steel = {"block_5000000000"};
  g.sets.loaded = {"side_set_7"};
  const Mesh m = make_mesh(g);
  ASSERT_EQ(m.loaded.size(), 1u);
  EXPECT_NEAR(hexahedron::centre(m, m.loaded[0]).x(), 0, 1e-15);
  EXPECT_EQ(m.outer.size(), 9u);
  EXPECT_NEAR(m.quality.steel_volume, 2, 1e-12);
}

// A file that is cut at any length is refused with a message, or it is still complete.
TEST(OutsideMesh, FilesThatAreCutShortAreRefused) {
  GeometryOptions g = box(0.01);
  g.half = true;
  const Mesh m = make_mesh(g);
  for (const char* ending : {".exo", ".inp"}) {
    const auto path = scratch_file(std::string("cut") + ending);
    write_mesh(m, path);
    const std::string whole = read_text(path);
    int refused = 0;
    for (int part = 0; part < 40; ++part) {
      std::ofstream(path, std::ios::binary) << whole.substr(0, whole.size() * std::size_t(part) / 40);
      const std::string said = message_of(from(path));
      EXPECT_NE(said, "accepted") << part << ending;
      refused += said != "accepted";
    }
    EXPECT_EQ(refused, 40);
    if (std::string(ending) == ".inp") continue;  // a text file does not show that its last lines are missing
    for (const std::size_t missing : {1, 5, 20, 200, 2000}) {
      std::ofstream(path, std::ios::binary) << whole.substr(0, whole.size() - missing);
      EXPECT_NE(message_of(from(path)), "accepted") << missing;
    }
  }
}

TEST(OutsideMesh, WallsAreCountedThroughTheSteel) {
  for (const int layers : {2, 3, 4}) {
    GeometryOptions g = box(0.005);
    g.wall_elements = layers;
    const auto path = scratch_file("walls.exo");
    write_mesh(make_mesh(g), path);
    EXPECT_EQ(make_mesh(from(path)).quality.least_wall_elements, layers);
  }
  // The upper wall has one layer less, so 1 element through its thickness.
  std::string text = column();
  const auto last = text.find("\n9, 25") + 1;
  text.erase(last, text.find("*ELEMENT", last) == std::string::npos ? text.find("*ELSET", last) - last : text.find("*ELEMENT", last) - last);
  text = with(text, "1, 9, 2", "1, 7, 2");
  text = with(text, "3, 36, 3", "3, 30, 3");
  text = with(text, "1, 34, 3", "1, 28, 3");
  const auto said = message_of(column_options("thin.inp", text));
  EXPECT_THAT(said, HasSubstr("one element through a wall"));
  EXPECT_THAT(said, HasSubstr("thin.inp:"));
}

TEST(OutsideMesh, TheFormatFollowsFromTheEnding) {
  EXPECT_THAT(message_of(from(scratch_file("target.msh"))), HasSubstr(".inp"));
  EXPECT_THAT(message_of(from(scratch_file("absent.inp"))), HasSubstr("does not exist"));
  EXPECT_THROW(write_mesh(make_mesh(box(0.01)), scratch_file("target.vtk")), InputError);
}
