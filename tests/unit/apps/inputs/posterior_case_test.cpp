#include "apps/inputs/posterior_case.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/slice_case.hpp"

using namespace calomel;
using calomel::testing::folder_with;
using calomel::testing::slice_case;
using ::testing::ElementsAre;

namespace {

const std::string density = "[parameter.density]\nmin = 12000\nmax = 14500\n", normal = "prior = \"normal\"\nmean = 13500\nsd = 100\n";

StudyCase study(const std::string& more, const std::vector<std::string>& set = {}) {
  return StudyCase::read(folder_with("posterior_case", {{"case.toml", slice_case + more}}) / "case.toml", set);
}

std::vector<std::string> names(const std::vector<Parameter>& parameters) {
  std::vector<std::string> out;
  for (const auto& p : parameters) out.push_back(p.name);
  return out;
}

}  // namespace

TEST(PosteriorCase, TheBasinIsSoughtOnTheSurrogateWhereAParameterHasNoPrior) {
  EXPECT_TRUE(basin_on_surrogate(study(density)));
  EXPECT_FALSE(basin_on_surrogate(study(density + normal)));
  EXPECT_FALSE(basin_on_surrogate(study(density, {"map.product=physical"})));
  EXPECT_FALSE(basin_on_surrogate(study(density, {"emulator.start=nominal"})));
  EXPECT_TRUE(basin_on_surrogate(study(density + normal, {"emulator.start=surrogate"})));
}

TEST(PosteriorCase, TheMeshesErrorIsThatOfTheMeshThatItStandsFor) {
  const double own = mesh_error(study(density), 0);
  EXPECT_GT(own, 0);
  EXPECT_EQ(mesh_error(study(density, {"emulator.element_sizes=[1e-3]"}), 0), 0.08);
  EXPECT_EQ(mesh_error(study(density, {"emulator.element_sizes=[2e-3]"}), 0), 0.16);
  EXPECT_EQ(mesh_error(study(density, {"emulator.element_sizes=[2e-3, 1e-3]"}), 0), own);
  EXPECT_EQ(mesh_error(study(density, {"errors.mesh=0.3"}), 0), 0.3);
}

TEST(PosteriorCase, NuisancesFollowTheCasesParametersWhereTheyHaveAPriorAndAreNoneOfThem) {
  EXPECT_THAT(names(posterior_parameters(study(density))), ElementsAre("density", "regularising_viscosity", "young", "wall_film"));
  EXPECT_THAT(names(posterior_parameters(study(density, {"errors.young_sd=0", "errors.wall_film_sd=0"}))), ElementsAre("density", "regularising_viscosity"));
  for (const char* no_film : {"geometry.wetted=no_separation", "material.mercury.law=linear"})  // nothing parts from a wall there
    EXPECT_THAT(names(posterior_parameters(study(density, {no_film}))), ElementsAre("density", "regularising_viscosity", "young"));
  const auto with_young = posterior_parameters(study(density + "[parameter.steel]\nkey = \"material.steel.young\"\nmin = 1.8e11\nmax = 2.1e11\n"));
  EXPECT_THAT(names(with_young), ElementsAre("density", "steel", "regularising_viscosity", "wall_film"));
  EXPECT_EQ(first_half_width(with_young[0], false), 0.035);
  Parameter cutoff;
  cutoff.key = "material.mercury.tensile_cutoff", cutoff.min = 0, cutoff.max = 1.5e6, cutoff.nominal = 1.5e5;
  EXPECT_DOUBLE_EQ(first_half_width(cutoff, false), 0.9e5);  // whatever its bounds
  cutoff.nominal = 0;
  EXPECT_DOUBLE_EQ(first_half_width(cutoff, false), 1.5e5);
  EXPECT_DOUBLE_EQ(first_half_width(with_young[1], false), 0.1 * std::log(2.1 / 1.8));
  EXPECT_DOUBLE_EQ(first_half_width(with_young[2], true), 1.8 * *with_young[2].sigma);
  EXPECT_DOUBLE_EQ(first_half_width(with_young[3], true), 2.5 * *with_young[3].sd);
  EXPECT_EQ(with_young[3].nominal, 0.0);
}

TEST(PosteriorCase, TheEmulatorHasTheCasesMeshAndItsHalf) {
  EXPECT_THAT(element_sizes(study(density)), ElementsAre(0.002, 0.001));
  EXPECT_EQ(emulator_meshes(study(density)), EmulatorMeshes::several);
  EXPECT_EQ(own_level(study(density)), 1);
  EXPECT_EQ(own_level(study(density, {"emulator.element_sizes=[0.0015,0.001]"})), std::nullopt);
  EXPECT_EQ(emulator_meshes(study(density, {"emulator.element_sizes=[0.002]"})), EmulatorMeshes::one_size);
}

TEST(PosteriorCase, TheFinestMeshIsHeldAgainstTheFrontOfThePulse) {
  const auto elements = [](const std::vector<std::string>& set) { return elements_per_front(study(density, set)); };
  const double front = study(density).forward.mercury.sound_speed * 0.7e-6;
  EXPECT_DOUBLE_EQ(elements({}).value(), front / 0.001);
  EXPECT_LT(elements({}).value(), front_resolved);
  EXPECT_DOUBLE_EQ(elements({"emulator.element_sizes=[0.001,0.0005]"}).value(), front / 0.0005);
  EXPECT_GT(elements({"emulator.element_sizes=[0.001,0.0005]"}).value(), front_resolved);
  EXPECT_EQ(elements({"load.pulse_length=0"}), std::nullopt);
}
