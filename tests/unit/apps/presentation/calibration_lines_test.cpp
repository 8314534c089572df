#include "apps/presentation/calibration_lines.hpp"

#include <gmock/gmock.h>

using namespace calomel;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

namespace {

ModelShape two_parameters() {
  ModelShape shape;
  shape.parameters = {{.name = "density"}, {.name = "offset"}};
  return shape;
}

}  // namespace

TEST(CalibrationLines, AProductHasItsMeaning) {
  EXPECT_EQ(meaning_sentence("tuned"),
            "tuned: the values with which this model imitates these recordings best within the case's bounds; not a material property. They take up whatever "
            "the model leaves out, and the published objective mixes percent with strain.");
  EXPECT_EQ(meaning_sentence("physical"),
            "physical: handbook priors, and a discrepancy that takes up what the model leaves out; a material property only as far as that discrepancy is a fair "
            "picture of it.");
}

TEST(CalibrationLines, ACorrectionHasItsRunsItsSizeAndItsEffect) {
  EncSummary enc;
  EXPECT_EQ(correction_sentence(enc, two_parameters()), "");
  enc.theta = {13200, 0.5};
  enc.mesh = {.used = true, .runs = 90, .difference = 0.112, .without = {13000, 0}, .calibrated = {1, 2}};
  EXPECT_EQ(correction_sentence(enc, two_parameters()),
            "predictions are corrected for the mesh by 90 runs of the emulator; at the answer that is 11 % of the histories; against the answer without it: "
            "density +1.5 %, offset +0.5");
  EXPECT_THAT(correction_warnings(enc), IsEmpty());
  enc.mesh.calibrated.clear();
  enc.mesh.without.clear();
  enc.at_nominal.inside_emulator = false;
  enc.best.inside_emulator = false;
  EXPECT_EQ(correction_sentence(enc, two_parameters()),
            "predictions are corrected for the mesh by 90 runs of the emulator; the nominal point lies outside the emulator's box, so that its scores are surer "
            "on the case's own mesh (working_mesh)");
  EXPECT_THAT(correction_warnings(enc),
              ElementsAre("the answer lies outside the box about the posterior in which the emulator knows the mesh: its correction is that of the box's nearest "
                          "point. See where `calomel sample` finds the parameters, and whether they are bounded too widely"));
}

TEST(CalibrationLines, OptimisersAndObjectivesAgreeOrNot) {
  const ModelShape shape = two_parameters();
  EncAgreement a;
  EXPECT_EQ(agreement_sentence(a, shape), "");
  a.optimizers = {{.name = "de", .rounds = 4, .agrees = true}, {.name = "es", .rounds = 4, .distance = 0.123, .shortfall = 4.56}, {.name = "gwo", .rounds = 0}};
  a.objectives = {{.objective = "paper_enc", .theta = {13000, 0}, .agrees = true},
                  {.objective = "rrmse", .theta = {13200, 0.5}},
                  {.objective = "paper_spe", .theta = {}}};
  EXPECT_EQ(agreement_sentence(a, shape),
            "The optimisers disagree: es ends 0.12 of the bounds away, 4.56 worse. The objectives disagree: rrmse moves density +1.5 %, offset +0.5; paper_spe "
            "has no value anywhere. The answer depends on the formulation of the misfit.");
  a.optimizers_agree = true;
  a.objectives_agree = true;
  EXPECT_EQ(agreement_sentence(a, shape),
            "The optimisers agree: the best of each lies within 0.05 of the bounds of the best of all. The objectives agree within 0.05 of the bounds.");
  a.optimizers.resize(1);
  EXPECT_EQ(agreement_sentence(a, shape), "The objectives agree within 0.05 of the bounds.");
}

TEST(CalibrationLines, EverySentenceHasALine) {
  EXPECT_THAT(enc_lines({}), IsEmpty());
  EXPECT_THAT(enc_lines({.calibration = {.meaning = "tuned", .mesh = "the mesh takes 11 %"}, .agreement = "the optimisers agree"}),
              ElementsAre("enc: the mesh takes 11 %", "enc: the optimisers agree"));
  EXPECT_THAT(spe_lines({.meaning = "tuned", .mesh = "the mesh takes 9 %"}), ElementsAre("spe: the mesh takes 9 %"));
}

TEST(CalibrationLines, MapReportsWhatIsIdentifiedOnlyWhereThereIsAnAnswer) {
  MapSummary map;
  const MapWords words{.check = "the emulator holds", .nested = "", .identified = "the data pin the impedance", .score_tests = "nothing stands out"};
  map.status = CalibrationStatus::done;
  EXPECT_THAT(map_lines(map, words), ElementsAre("map: the data pin the impedance", "map: the emulator holds", "map: nothing stands out"));
  map.status = CalibrationStatus::no_candidate;
  EXPECT_THAT(map_lines(map, words), ElementsAre("map: the emulator holds", "map: nothing stands out"));
}

TEST(CalibrationLines, ACorrectionThatIsMissingOrPartialSaysWhy) {
  EXPECT_THAT(not_corrected_line("spe", EmulatorMeshes::one_size),
              testing::AllOf(HasSubstr("spe: predictions are not corrected for the mesh"), HasSubstr("emulator.element_sizes")));
  EXPECT_THAT(not_corrected_line("spe", EmulatorMeshes::from_file), testing::AllOf(HasSubstr("comes from a file"), Not(HasSubstr("emulator.element_sizes"))));
  EXPECT_EQ(viscosity_left_sentence("enc", 812.3456, 2000),
            "enc: the case's mesh has a regularising viscosity of 812.3 Pa s, the emulator one of 2000, and emulator.viscosity_sd = 0: the difference is not "
            "taken off");
}
