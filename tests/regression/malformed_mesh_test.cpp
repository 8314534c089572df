// Malformed mesh files through the program: exit status 2, the file, its line or element, what is allowed, what to do.
#include "base/artefact.hpp"
#include "forward/mesh/make_mesh.hpp"
#include "forward/mesh/write_mesh.hpp"
#include "tests/regression/slice_case.hpp"

using namespace calomel::testing;

namespace {

const std::string good_case = R"([geometry]
kind = "mesh"
file = "target.inp"
[geometry.sets]
rear = ["rear"]
[load]
policy = "fixed"
peak_pressure = 25e6
profile = { center = [0.0, 0.02], widths = [0.1, 0.02], decay = 0.13 }
[time]
end = 2e-6
output_interval = 1e-6
[[sensor]]
name = "A"
position = [0.03, 0.0, 0.04]
direction = [1, 0, 0]
)";

/// A half box of 5 mm walls, as `check --write-mesh` writes it.
const std::string& good_mesh() {
  static const std::string text = [] {
    calomel::GeometryOptions g;
    g.kind = "box";
    g.length = 0.06;
    g.width = 0.05;
    g.height = 0.04;
    g.wall = 0.005;
    g.element_size = 0.01;
    g.half = true;
    const auto path = calomel::scratch_file("good_mesh.inp");
    calomel::write_mesh(calomel::make_mesh(g), path);
    return calomel::read_text(path);
  }();
  return text;
}

struct Edit {
  std::string name;
  std::string old, now;            ///< change of the mesh file
  std::vector<std::string> words;  ///< all must be said
  std::string case_old, case_now;  ///< change of the case file
};

void PrintTo(const Edit& edit, std::ostream* out) { *out << edit.name; }

/// The line that element `number` stands in.
std::string element_line(int number) {
  const auto& mesh = good_mesh();
  const auto elements = mesh.find("*ELEMENT"), begin = mesh.find("\n" + std::to_string(number) + ", ", elements) + 1;
  return mesh.substr(begin, mesh.find('\n', begin) - begin);
}
std::string node_line(int number) {
  const auto& mesh = good_mesh();
  const auto begin = mesh.find("\n" + std::to_string(number) + ", ", mesh.find("*NODE")) + 1;
  return mesh.substr(begin, mesh.find('\n', begin) - begin);
}
/// Element 7 with its upper and lower faces exchanged.
std::string turned_inside_out() {
  std::stringstream line(element_line(7));
  std::vector<std::string> words;
  for (std::string w; std::getline(line, w, ',');) words.push_back(w);
  std::string s = words[0];
  for (const int i : {5, 6, 7, 8, 1, 2, 3, 4}) s += ',' + words[std::size_t(i)];
  return s;
}
/// A cube of steel far away, with nodes of its own.
const std::string island = R"(*NODE
9001, 1, 1, 1
9002, 1.01, 1, 1
9003, 1.01, 1.01, 1
9004, 1, 1.01, 1
9005, 1, 1, 1.01
9006, 1.01, 1, 1.01
9007, 1.01, 1.01, 1.01
9008, 1, 1.01, 1.01
*ELEMENT, TYPE=C3D8, ELSET=steel
9001, 9001, 9002, 9003, 9004, 9005, 9006, 9007, 9008
)";

std::vector<Edit> edits() {
  const std::string& mesh = good_mesh();
  const std::string surface = "*SURFACE, NAME=rear";
  const std::string first = element_line(1), node = node_line(3);
  const std::string last = node_line(std::stoi(first.substr(first.rfind(',') + 1)));
  return {
      {"tetrahedra", "TYPE=C3D8, ELSET=steel", "TYPE=C3D10, ELSET=steel", {"target.inp:", "TYPE=c3d10", "C3D8", "hexahedra"}},
      {"quadratic", "TYPE=C3D8, ELSET=mercury", "TYPE=C3D20R, ELSET=mercury", {"target.inp:", "TYPE=c3d20r", "C3D8"}},
      {"shells", surface, "*ELEMENT, TYPE=S4\n8001, 1, 2, 3, 4\n" + surface, {"target.inp:", "TYPE=s4", "leave them out"}},
      {"parts", "*NODE\n", "*PART, NAME=body\n*NODE\n", {"target.inp:3", "*part", "noPartsInputFile"}},
      {"include", "*NODE\n", "*INCLUDE, INPUT=nodes.inp\n*NODE\n", {"target.inp:3", "*include", "paste"}},
      {"nan_coordinate", node, "3, NaN, 0, 0", {"target.inp:", "node 3", "not finite"}},
      {"text_coordinate", node, "3, 0.1, o.2, 0", {"target.inp:", "o.2", "node 3"}},
      {"absent_node", first, "1, 1, 2, 3, 4, 5, 6, 7, 77777", {"target.inp:", "element 1", "77777"}},
      {"short_element", first, "1, 1, 2, 3, 4, 5, 6, 7", {"target.inp:", "element 1"}},
      {"element_twice", surface, "*ELEMENT, TYPE=C3D8, ELSET=steel\n" + first + "\n" + surface, {"target.inp:", "element 1", "twice"}},
      {"part_twice", surface, "*ELEMENT, TYPE=C3D8, ELSET=steel\n777" + first + "\n" + surface, {"target.inp:", "three elements share one face"}},
      {"inverted", element_line(7), turned_inside_out(), {"target.inp:", "element 7", "inside out", "1 of"}},
      {"wedge", first, "1, 1, 2, 2, 3, 4, 5, 5, 6", {"target.inp:", "element 1", "twice", "wedge"}},
      {"island", surface, island + surface, {"target.inp:", "2 pieces", "element 9001"}},
      {"doubled_node",
       first,
       "*NODE\n9001" + last.substr(last.find(',')) + "\n*ELEMENT, TYPE=C3D8, ELSET=steel\n" + first.substr(0, first.rfind(',')) + ", 9001",
       {"target.inp", "without sharing nodes", "1 pairs", "(steel)", "merge_distance"}},
      {"no_material",
       first,
       "*ELEMENT, TYPE=C3D8, ELSET=lead\n" + first + "\n*ELEMENT, TYPE=C3D8, ELSET=steel",
       {"target.inp:", "1 of", "neither steel nor mercury", "element 1", "lead"}},
      {"renamed_material", "ELSET=mercury", "ELSET=quicksilver", {"target.inp:", "neither steel nor mercury", "quicksilver", "geometry.sets"}},
      {"two_materials", surface, "*ELSET, ELSET=mercury\n1\n" + surface, {"target.inp:", "both steel and mercury", "element 1"}},
      {"missing_steel_set",
       "",
       "",
       {"case.toml:", "geometry.sets.steel", "stele", "mercury, steel", "did you mean \"steel\""},
       "rear = ",
       "steel = [\"stele\"]\nrear = "},
      {"missing_rear_set", "", "", {"case.toml:5", "geometry.sets.rear", "raer", "did you mean \"rear\""}, "rear = [\"rear\"]", "rear = [\"raer\"]"},
      {"bare_mercury", "NAME=rear", "NAME=back", {"target.inp:", "mercury lies bare", "geometry.sets"}, "rear = [\"rear\"]\n", ""},
      {"wrong_plane", "", "", {"case.toml:", "geometry.sets.symmetry_x", "normal to x"}, "rear = ", "symmetry_x = [\"symmetry_y\"]\nrear = "},
      {"bad_side", surface, "*SURFACE, NAME=lid, TYPE=ELEMENT\n1, S7\n" + surface, {"target.inp:", "S1 to S6"}},
      {"inner_side",
       surface,
       "*SURFACE, NAME=lid, TYPE=ELEMENT\nsteel, S1\n" + surface,
       {"case.toml:", "geometry.sets.loaded", "not free"},
       "rear = ",
       "loaded = [\"lid\"]\nrear = "},
      {"circular_set", surface, "*ELSET, ELSET=a\nb\n*ELSET, ELSET=b\na\n" + surface, {"target.inp:", "contains itself"}},
      {"unknown_set", surface, "*ELSET, ELSET=a\nsteal\n" + surface, {"target.inp:", "steal", "did you mean \"steel\""}},
      {"bad_generate", surface, "*ELSET, ELSET=a, GENERATE\n1, 5, x\n" + surface, {"target.inp:", "GENERATE"}},
      {"no_elements", mesh.substr(mesh.find("*ELEMENT")), "", {"target.inp", "no elements"}},
      {"no_text", mesh, std::string("CDF\x01\0\0", 6), {"target.inp:1"}},
      {"empty", mesh, "", {"target.inp", "no elements"}},
      {"absent", "", "", {"absent.inp", "does not exist"}, "target.inp", "absent.inp"},
      {"format", "", "", {"target.stl", ".inp", ".exo"}, "target.inp", "target.stl"},
      {"not_exodus", "", "", {"target.exo", "no Exodus II file"}, "target.inp", "target.exo"},
      {"foreign_key", "", "", {"case.toml:4", "geometry.wall", "no such key"}, "[geometry.sets]", "wall = 0.004\n[geometry.sets]"},
      {"gauge_far_off", "", "", {"case.toml:15", "sensor[0].position", "nearest place"}, "[0.03, 0.0, 0.04]", "[0.03, 0.0, 0.06]"},
      {"no_loaded_face",
       "",
       "",
       {"case.toml:", "geometry.sets.loaded"},
       "policy = \"fixed\"\npeak_pressure = 25e6",
       "kind = \"end_stress\"\nfile = \"stress.csv\""},
  };
}

std::filesystem::path folder_of(const Edit& e) {
  const std::string mesh = e.old.empty() ? good_mesh() : with(good_mesh(), e.old, e.now);
  return folder_with("mesh_" + e.name, {{"target.inp", mesh},
                                        {"target.exo", mesh},
                                        {"target.stl", mesh},
                                        {"stress.csv", "time,stress\n0,0\n1e-6,-1e6\n2e-6,0\n"},
                                        {"case.toml", e.case_old.empty() ? good_case : with(good_case, e.case_old, e.case_now)}});
}

class MalformedMesh : public testing::TestWithParam<Edit> {};

}  // namespace

TEST(WellFormedMesh, IsAcceptedAndRuns) {
  const auto dir = folder_of({"good", "", "", {}});
  EXPECT_EQ(run(dir, "check case.toml").status, 0);
  const auto out = run(dir, "simulate case.toml");
  EXPECT_EQ(out.status, 0) << out.said;
}

TEST(WellFormedMesh, WritesItselfThroughTheCommandLine) {
  const auto dir = folder_of({"written", "", "", {}});
  EXPECT_EQ(run(dir, "check case.toml --write-mesh again.inp").status, 0);
  EXPECT_EQ(calomel::read_text(dir / "again.inp"), good_mesh());
  EXPECT_EQ(run(dir, "check case.toml --write-mesh again.exo").status, 0);
  EXPECT_EQ(run(dir, "check case.toml --set geometry.file=again.exo --write-mesh back.inp").status, 0);
  EXPECT_EQ(calomel::read_text(dir / "back.inp"), good_mesh());
  EXPECT_EQ(run(dir, "check case.toml --write-mesh again.vtk").status, 2);
}

// A campaign on a mesh belongs to that mesh's bytes.
TEST(WellFormedMesh, ChangedMeshDoesNotMatchTheCampaignMadeBefore) {
  const auto dir = folder_of({"changed", "", "", {}});
  const std::string words =
      "campaign case.toml --quiet --set campaign.runs=2 --set campaign.floor=false --set parameter.density.min=13000 --set parameter.density.max=13600";
  ASSERT_EQ(run(dir, words).status, 0);
  EXPECT_EQ(run(dir, words).status, 0);
  std::ofstream(dir / "target.inp") << with(good_mesh(), "*HEADING\n", "*HEADING\nanother\n");
  const auto out = run(dir, words);
  EXPECT_EQ(out.status, 2);
  EXPECT_THAT(out.said, testing::HasSubstr("geometry.file"));
}

TEST_P(MalformedMesh, ExitsTwoWithAMessageThatNamesTheMistakeAndTheRemedy) {
  const Edit& e = GetParam();
  const auto out = run(folder_of(e), "check case.toml");
  EXPECT_EQ(out.status, 2) << out.said;
  for (const auto& w : e.words) EXPECT_THAT(out.said, testing::HasSubstr(w));
  EXPECT_LT(out.said.size(), 1500u) << out.said;
}

INSTANTIATE_TEST_SUITE_P(Files, MalformedMesh, testing::ValuesIn(edits()), [](const auto& info) { return info.param.name; });
