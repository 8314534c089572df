#include "apps/presentation/case_lines.hpp"

#include <gmock/gmock.h>

#include "tests/slice_case.hpp"

using namespace calomel;
using calomel::testing::folder_with;
using calomel::testing::slice_case;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

namespace {

StudyCase study(const std::string& more = "", const std::vector<std::string>& set = {}) {
  return StudyCase::read(folder_with("case_lines", {{"case.toml", slice_case + more}}) / "case.toml", set);
}

/// Numbers made up: nothing is meshed or run.
struct MadeUp {
  ModelDescription model{.elements = 1200,
                         .nodes = 1500,
                         .time_step = 1.25e-7,
                         .steps = 160,
                         .viscosity = 800,
                         .mesh_decides_viscosity = true,
                         .deposited_energy = 42.5,
                         .slice_thickness = 0.002,
                         .run_threads = 1,
                         .estimated_bytes = 3e6};
  ModelShape shape{.conditions = {"default"}, .sensors = {"A"}, .times = {0, 1e-6}};
  Mesh mesh;
  MadeUp() {
    mesh.plane_strain = true;
    mesh.quality = {.least_scaled_jacobian = 0.9, .greatest_aspect_ratio = 2, .shortest_edge = 0.002, .least_wall_elements = 2};
  }
};

}  // namespace

TEST(CaseLines, ThePlanTellsModelPhysicsStudyAndCost) {
  const auto c = study("[parameter.density]\nmin = 13000\nmax = 13600\n[campaign]\nruns = 40\n");
  const MadeUp m;
  const auto lines =
      plan_lines({.study = c, .model = m.model, .shape = m.shape, .mesh = m.mesh, .cost = {.run = 30, .campaign = 720, .floor = 12000}, .threads = 4});
  EXPECT_THAT(
      lines,
      ElementsAre("case: slice, box in plane strain", "model: 1200 elements, 1500 nodes, 160 steps of 1.25e-07 s, 1 sensors at 2 times, about 3 MB",
                  StartsWith("load: "), "pulse: 42.5 J deposited in a slice 2 mm thick; regularising viscosity 800 Pa s (decided by the mesh)",
                  StartsWith("mesh: scaled Jacobian at least 0.900, aspect ratio at most 2.00, shortest edge 2 mm, 2 elements through the thinnest wall"),
                  "parameters: density 1.3e+04 to 1.36e+04",
                  "study: campaign of 40 ensemble means of 8 (chebyshev), train " + c.surrogate.kind + ", calibrate by enc, report",
                  "cost on 4 threads: one run about 30 s; the campaign of 40 ensemble means over 0 parameters about 12 min, its repeatability floor 3 h 20 min",
                  "a single run is too small to gain by more than 1 thread"));
}

TEST(CaseLines, ThePlanLeavesOutWhatTheCaseDoesNotHave) {
  const auto c = study("", {"campaign.floor=false"});
  MadeUp m;
  m.model.deposited_energy = 0, m.mesh.plane_strain = false;
  const auto lines = plan_lines({.study = c, .model = m.model, .shape = m.shape, .mesh = m.mesh, .threads = 1});
  for (const char* absent : {"pulse: ", "parameters: ", "mechanisms: ", "conditions: ", "sub-cycling: ", "recordings: ", "a single run"})
    EXPECT_THAT(lines, Not(Contains(StartsWith(absent))));
  EXPECT_THAT(lines, Contains("case: slice, box"));
  EXPECT_THAT(lines, Contains(HasSubstr("a repeatability floor")));
}

TEST(CaseLines, ThePlanTellsConditionsSubCyclesAndRecords) {
  const auto c = study();
  MadeUp m;
  m.model.subcycles = 3, m.shape.conditions = {"low", "high"};
  Problem problem;
  problem.observations.resize(7), problem.time.resize(50);
  const auto lines = plan_lines({.study = c, .model = m.model, .shape = m.shape, .mesh = m.mesh, .problem = &problem});
  EXPECT_THAT(lines, Contains("conditions: low, high"));
  EXPECT_THAT(lines, Contains("sub-cycling: mercury away from the steel takes one step in 3"));
  EXPECT_THAT(lines, Contains("recordings: 7 records, compared at 50 times"));
}

TEST(CaseLines, ANominalValueLeftOutIsToldAtItsPlaceWithTheKeyToSet) {
  const std::string density = "[parameter.density]\nmin = 13000\nmax = 13600\n";
  EXPECT_THAT(nominals_left_out(study(density)), IsEmpty());
  EXPECT_THAT(nominals_left_out(study(density + "nominal = 13500.0\n")), IsEmpty());  // what the table says
  const auto told = nominals_left_out(study(density + "nominal = 13100\n"));
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].parts().key, "parameter.density.nominal");
  EXPECT_THAT(told[0].what(), HasSubstr("set material.mercury.density itself, which is 13500: --set material.mercury.density=13100"));
  EXPECT_GT(told[0].parts().line, 30);
}
