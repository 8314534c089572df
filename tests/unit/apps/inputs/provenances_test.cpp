#include "apps/inputs/provenances.hpp"

#include <gmock/gmock.h>

#include "base/artefact.hpp"
#include "base/provenance.hpp"
#include "tests/slice_case.hpp"

using namespace calomel;
using calomel::testing::folder_with;
using calomel::testing::slice_case;
using ::testing::ElementsAre;

/// Names of a provenance's inputs in a folder where what it may hash stands.
class Provenances : public ::testing::Test {
 protected:
  const std::filesystem::path dir =
      folder_with("provenances", {{"case.toml", slice_case + "[parameter.density]\nmin = 12000\nmax = 14500\n[recordings]\nfile = \"records.csv\"\n"},
                                  {"records.csv", "sensor,pulse,time,strain\n"},
                                  {"campaign.nc", "runs"},
                                  {"surrogate.nc", "learnt"}});
  Provenance of(const std::string& method, std::vector<std::string> set = {}) const {
    const CommandLine command{.verb = "calibrate", .case_file = dir / "case.toml", .out = dir, .overrides = std::move(set), .quiet = true};
    const StudyInputs inputs(command);
    return method == "sample" ? posterior_provenance(inputs) : method == "diagnose" ? diagnosis_provenance(inputs) : calibration_provenance(inputs, method);
  }
  std::vector<std::string> inputs(const std::string& method, std::vector<std::string> set = {}) const {
    std::vector<std::string> names;
    for (const auto& [name, hash] : of(method, std::move(set)).inputs) names.push_back(name);
    return names;
  }
};

TEST_F(Provenances, ListTheSurrogateWhereTheBasinIsFoundOnIt) {
  EXPECT_THAT(inputs("sample"), ElementsAre("model", "recordings", "surrogate.nc"));
  EXPECT_THAT(inputs("map"), ElementsAre("model", "recordings", "surrogate.nc"));
  EXPECT_THAT(inputs("spe"), ElementsAre("campaign.nc", "recordings", "surrogate.nc"));
  EXPECT_THAT(inputs("enc"), ElementsAre("recordings", "surrogate.nc"));
}

TEST_F(Provenances, DoNotListItWhereTheBasinIsNominalOrThereIsNoCorrection) {
  EXPECT_THAT(inputs("sample", {"emulator.start=nominal"}), ElementsAre("model", "recordings"));
  EXPECT_THAT(inputs("map", {"emulator.start=nominal"}), ElementsAre("model", "recordings"));
  EXPECT_THAT(inputs("spe", {"emulator.start=nominal"}), ElementsAre("campaign.nc", "recordings"));
  EXPECT_THAT(inputs("spe", {"spe.mesh_correction=false"}), ElementsAre("campaign.nc", "recordings"));
  EXPECT_THAT(inputs("spe", {"emulator.element_sizes=[0.002]"}), ElementsAre("campaign.nc", "recordings"));
}

TEST_F(Provenances, ChangeWithTheSurrogateOfTheBasinAlone) {
  const auto spe = of("spe").identity(), bare = of("spe", {"spe.mesh_correction=false"}).identity();
  write_atomically(dir / "surrogate.nc", "learnt anew");
  EXPECT_NE(of("spe").identity(), spe);
  EXPECT_EQ(of("spe", {"spe.mesh_correction=false"}).identity(), bare);
}

// What a diagnosis of an external model offers is no part of its runs, but of its verdict.
TEST(ProvenancesOfModelsOutside, ADiagnosisHangsOnWhatItOffers) {
  const auto dir = folder_with(
      "provenances_outside",
      {{"case.toml",
        "[model]\nkind = \"umbridge\"\nurl = \"http://127.0.0.1:1\"\nname = \"m\"\n[output]\nsensors = [\"A\"]\ntime = { step = 1.0, count = 2 }\n"
        "[recordings]\nfile = \"records.csv\"\n[parameter.a]\nmin = 0.0\nmax = 1.0\n[mechanism.drag.parameter.b]\noff = 0.0\nmin = 0.0\nmax = 1.0\n"},
       {"records.csv", "sensor,pulse,time,strain\n"}});
  const auto of = [&](std::vector<std::string> set) {
    const CommandLine command{.verb = "diagnose", .case_file = dir / "case.toml", .out = dir, .overrides = std::move(set), .quiet = true};
    const StudyInputs inputs(command);
    return std::pair(runs_provenance(inputs.study()).identity(), diagnosis_provenance(inputs).identity());
  };
  const auto usual = of({}), wider = of({"mechanism.drag.parameter.b.max=2.0"}), elsewhere = of({"model.url=http://127.0.0.1:2"});
  EXPECT_EQ(wider.first, usual.first);
  EXPECT_NE(wider.second, usual.second);
  EXPECT_EQ(elsewhere, usual);
}

// Draws of a kind hang on its own keys alone.
TEST_F(Provenances, SampleHangsOnTheKeysOfItsSampler) {
  const auto dram = of("sample").identity(), delayed = of("sample", {"sampler.kind=delayed_acceptance"}).identity();
  EXPECT_EQ(of("sample", {"sampler.smc.keep=0.8"}).identity(), dram);
  EXPECT_NE(of("sample", {"sampler.dram.stages=1"}).identity(), dram);
  EXPECT_NE(of("sample", {"sampler.kind=delayed_acceptance", "sampler.dram.stages=1"}).identity(), delayed);
  EXPECT_NE(of("sample", {"sampler.kind=smc"}).identity(), of("sample", {"sampler.kind=smc", "sampler.smc.keep=0.8"}).identity());
  EXPECT_EQ(of("sample", {"sampler.kind=smc"}).identity(), of("sample", {"sampler.kind=smc", "sampler.smc.evaluations=100"}).identity());
}

TEST_F(Provenances, WhatSampleDoesWithTheEmulatorIsItsAlone) {
  const std::vector<std::string> changed{"posterior.hyperparameter_draws=3", "posterior.refinements=0"};
  EXPECT_NE(of("sample", changed).identity(), of("sample").identity());
  for (const char* other : {"map", "diagnose", "enc", "spe"}) EXPECT_EQ(of(other, changed).identity(), of(other).identity()) << other;
}
