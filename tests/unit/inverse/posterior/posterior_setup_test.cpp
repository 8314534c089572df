#include "inverse/posterior/posterior_setup.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "apps/inputs/provenances.hpp"
#include "apps/inputs/study_case.hpp"
#include "inverse/posterior/emulator_meshes.hpp"
#include "tests/slice_case.hpp"

using namespace calomel;
using calomel::testing::folder_with;
using calomel::testing::slice_case;
using ::testing::ElementsAre;

namespace {

const std::string density = "[parameter.density]\nmin = 12000\nmax = 14500\n", normal = "prior = \"normal\"\nmean = 13500\nsd = 100\n";

StudyCase study(const std::string& more, const std::vector<std::string>& set = {}) {
  return StudyCase::read(folder_with("posterior_setup", {{"case.toml", slice_case + more}}) / "case.toml", set);
}

double own_mesh_error(const StudyCase& s) { return mesh_error(*s.simulator, s.emulator, s.errors.mesh, 0); }
std::vector<Parameter> parameters_of(const StudyCase& s) { return posterior_parameters(*s.simulator, s.posterior_settings()); }
std::vector<double> sizes_of(const StudyCase& s) { return element_sizes(*s.simulator, s.emulator); }
EmulatorMeshes meshes_of_emulator(const StudyCase& s) { return emulator_meshes(*s.simulator, s.emulator); }
std::optional<int> level_of_case(const StudyCase& s) { return own_level(*s.simulator, s.emulator); }

std::vector<std::string> names(const std::vector<Parameter>& parameters) {
  std::vector<std::string> out;
  for (const auto& p : parameters) out.push_back(p.name);
  return out;
}

}  // namespace

TEST(PosteriorSetup, TheBasinIsSoughtOnTheSurrogateWhereAParameterHasNoPrior) {
  EXPECT_TRUE(basin_on_surrogate(study(density)));
  EXPECT_FALSE(basin_on_surrogate(study(density + normal)));
  EXPECT_FALSE(basin_on_surrogate(study(density, {"map.product=physical"})));
  EXPECT_FALSE(basin_on_surrogate(study(density, {"emulator.start=nominal"})));
  EXPECT_TRUE(basin_on_surrogate(study(density + normal, {"emulator.start=surrogate"})));
}

TEST(PosteriorSetup, TheMeshErrorIsThatOfTheMeshThatItRepresents) {
  const double own = own_mesh_error(study(density));
  EXPECT_GT(own, 0);
  EXPECT_EQ(own_mesh_error(study(density, {"emulator.element_sizes=[1e-3]"})), 0.08);
  EXPECT_EQ(own_mesh_error(study(density, {"emulator.element_sizes=[2e-3]"})), 0.16);
  EXPECT_EQ(own_mesh_error(study(density, {"emulator.element_sizes=[2e-3, 1e-3]"})), own);
  EXPECT_EQ(own_mesh_error(study(density, {"errors.mesh=0.3"})), 0.3);
}

TEST(PosteriorSetup, NuisancesFollowTheCasesParametersWhereTheyHaveAPriorAndAreNoneOfThem) {
  EXPECT_THAT(names(parameters_of(study(density))), ElementsAre("density", "regularising_viscosity", "young", "wall_film"));
  EXPECT_THAT(names(parameters_of(study(density, {"errors.young_sd=0", "errors.wall_film_sd=0"}))), ElementsAre("density", "regularising_viscosity"));
  for (const char* no_film : {"geometry.wetted=no_separation", "material.mercury.law=linear"})  // nothing parts from a wall there
    EXPECT_THAT(names(parameters_of(study(density, {no_film}))), ElementsAre("density", "regularising_viscosity", "young"));
  const auto with_young = parameters_of(study(density + "[parameter.steel]\nkey = \"material.steel.young\"\nmin = 1.8e11\nmax = 2.1e11\n"));
  EXPECT_THAT(names(with_young), ElementsAre("density", "steel", "regularising_viscosity", "wall_film"));
  const auto hints_with = [](const std::string& more) { return study(density + more).simulator->hints(); };
  const InferenceHints hints = hints_with("");
  EXPECT_EQ(first_half_width(with_young[0], hints), 0.035);
  const auto cutoff_width = [&](const std::string& nominal) {
    const std::string cutoff = "[parameter.tensile_cutoff]\nmin = 0\nmax = 1.5e6\nnominal = " + nominal + "\n";
    return first_half_width(study(cutoff).parameters()[0], study(cutoff).simulator->hints());
  };
  EXPECT_DOUBLE_EQ(cutoff_width("1.5e5"), 0.9e5);  // whatever its bounds
  EXPECT_DOUBLE_EQ(cutoff_width("0"), 1.5e5);
  const InferenceHints own_young = hints_with("[parameter.steel]\nkey = \"material.steel.young\"\nmin = 1.8e11\nmax = 2.1e11\n");
  EXPECT_DOUBLE_EQ(first_half_width(with_young[1], own_young), 0.1 * std::log(2.1 / 1.8));
  EXPECT_DOUBLE_EQ(first_half_width(with_young[2], own_young), 1.8 * *with_young[2].sigma);
  EXPECT_DOUBLE_EQ(first_half_width(with_young[3], own_young), 2.5 * *with_young[3].sd);
  EXPECT_EQ(with_young[3].nominal, 0.0);
}

TEST(PosteriorSetup, TheEmulatorHasTheCasesMeshAndItsHalf) {
  EXPECT_THAT(sizes_of(study(density)), ElementsAre(0.002, 0.001));
  EXPECT_EQ(meshes_of_emulator(study(density)), EmulatorMeshes::several);
  EXPECT_EQ(level_of_case(study(density)), 1);
  EXPECT_EQ(level_of_case(study(density, {"emulator.element_sizes=[0.0015,0.001]"})), std::nullopt);
  EXPECT_EQ(meshes_of_emulator(study(density, {"emulator.element_sizes=[0.002]"})), EmulatorMeshes::one_size);
}

TEST(PosteriorSetup, TheFinestMeshIsHeldAgainstTheFrontOfThePulse) {
  const auto elements = [](const std::vector<std::string>& set) {
    const auto s = study(density, set);
    return elements_per_front(*s.simulator, s.emulator);
  };
  const double front = study(density).simulator->hints().resolved_length;
  EXPECT_DOUBLE_EQ(front, 1450.0 * 0.7e-6);
  EXPECT_DOUBLE_EQ(elements({}).value(), front / 0.001);
  EXPECT_LT(elements({}).value(), front_resolved);
  EXPECT_DOUBLE_EQ(elements({"emulator.element_sizes=[0.001,0.0005]"}).value(), front / 0.0005);
  EXPECT_GT(elements({"emulator.element_sizes=[0.001,0.0005]"}).value(), front_resolved);
  EXPECT_EQ(elements({"load.pulse_length=0"}), std::nullopt);
}
