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
  shape.parameters = {{.name = "density", .min = 12000, .max = 14000}, {.name = "offset", .min = -1, .max = 1}};
  return shape;
}

}  // namespace

TEST(CalibrationLines, AProductHasItsMeaning) {
  EXPECT_EQ(meaning_sentence("tuned"),
            "tuned: the values with which this model imitates these recordings best within the case's bounds; not a material property. They compensate for "
            "whatever the model omits, and the published objective mixes percent with strain.");
  EXPECT_EQ(meaning_sentence("physical"),
            "physical: handbook priors, and a discrepancy that represents omitted physics; a material property only as far as that discrepancy is a fair "
            "picture of it.");
}

TEST(CalibrationLines, ACorrectionHasItsRunsItsSizeAndItsEffect) {
  EncSummary enc;
  EXPECT_EQ(correction_sentence(enc, two_parameters()), "");
  enc.theta = {13200, 0.5};
  enc.mesh = {.used = true, .runs = 90, .difference = 0.112, .without = {13000, 0}, .calibrated = {1, 2}};
  EXPECT_EQ(correction_sentence(enc, two_parameters()),
            "predictions are corrected for the mesh by 90 runs of the emulator; at the calibrated point the correction is 11 % of the histories; difference "
            "from the calibration without it: "
            "density +1.5 %, offset +0.5");
  enc.mesh.calibrated.clear();
  enc.mesh.without.clear();
  enc.at_nominal.inside_emulator = false;
  EXPECT_EQ(correction_sentence(enc, two_parameters()),
            "predictions are corrected for the mesh by 90 runs of the emulator; the nominal point lies outside the emulator's box, so that its scores are more "
            "reliable "
            "on the case's own mesh (working_mesh)");
}

TEST(CalibrationLines, AnAnswerHasAMessageAndMayHaveNoWarning) {
  Calibration c;
  EXPECT_EQ(calibration_message(c), "the calibration was not run");
  c.status = CalibrationStatus::done;
  c.objective.name = "rrmse";
  c.wanted = 2;
  c.candidates = {{.theta = {13200, 0.5}, .objective_model = 0.1234567}, {.theta = {13300, 0.4}, .objective_model = 0.2}};
  c.best = c.candidates[0];
  c.theta = c.best.theta;
  c.at_nominal = {.theta = {13000, 0}, .objective_model = 0.9};
  EXPECT_EQ(calibration_message(c), "rrmse = 0.123457 in the true model at the best of 2 candidates");
  EXPECT_THAT(calibration_warnings(c, two_parameters()), IsEmpty());
}

TEST(CalibrationLines, TheNominalParametersAreKeptWhereNoCandidateIsBetter) {
  Calibration c;
  c.status = CalibrationStatus::done;
  c.objective.name = "rrmse";
  c.wanted = 3;
  c.candidates = {{.theta = {13200, 0.5}, .objective_model = 0.12345}};
  c.failed = {{.message = "the step collapsed"}};
  c.best = c.at_nominal = {.theta = {13000, 0}, .objective_model = 0.1};
  c.theta = c.best.theta;
  EXPECT_EQ(calibration_message(c), "rrmse = 0.1 in the true model at the nominal parameters: none of 1 candidates is better");
  EXPECT_THAT(calibration_warnings(c, two_parameters()),
              ElementsAre("no candidate is better than the nominal parameters in the true model (0.1235 against 0.1): the nominal ones are kept; the surrogate "
                          "is too coarse near its optimum",
                          "the true model failed at 1 candidates, others took their place: the step collapsed",
                          "1 of 3 candidates: no more distinct points could be run"));
}

TEST(CalibrationLines, AnAnswerOnABoundOrBeyondTheCorrectionIsAWarning) {
  Calibration c;
  c.status = CalibrationStatus::no_candidate;
  EXPECT_EQ(calibration_message(c), "the surrogate failed at every point; the result is the surrogate's alone");
  c.wanted = 8;
  c.candidates = {{.theta = {12000, 0.9999}, .message = "the step collapsed"}};
  c.best = c.candidates[0];
  c.best.inside_emulator = false;
  c.theta = c.best.theta;
  c.at_nominal.message = "an element collapsed";
  c.mesh.reservations = {"the viscosity is not corrected"};
  EXPECT_EQ(calibration_message(c), "the true model failed at every candidate: the step collapsed; the result is the surrogate's alone");
  EXPECT_THAT(
      calibration_warnings(c, two_parameters()),
      ElementsAre(calibration_message(c), "the true model failed at the nominal parameters: an element collapsed",
                  "density = 12000 lies on its lower bound: its best value is beyond the bound, or the data do not determine it",
                  "offset = 0.9999 lies on its upper bound: its best value is beyond the bound, or the data do not determine it",
                  "the viscosity is not corrected",
                  "the answer lies outside the box about the posterior in which the emulator knows the mesh error: its correction is that of the box's nearest "
                  "point. See where `calomel sample` finds the parameters, and whether they are bounded too widely"));
  c.at_nominal.objective_model = 0.5;
  EXPECT_EQ(calibration_message(c), "the true model failed at every candidate: the step collapsed; the nominal parameters are kept");
}

TEST(CalibrationLines, SurrogatesThatAreLeftOutAreAWarning) {
  SpeSummary s;
  s.optima.resize(1);
  EXPECT_THAT(surrogate_warnings(s), IsEmpty());
  s.optima.clear();
  s.too_large = {"total_degree 8", "tensor_product 4"};
  s.most_terms = 60;
  s.surrogates.resize(3);
  s.surrogates[1].failure = "every coefficient vanishes";
  EXPECT_THAT(surrogate_warnings(s),
              ElementsAre("polynomial spaces of more than 60 terms are left out: total_degree 8, tensor_product 4",
                          "1 of 3 surrogates were left out: every coefficient vanishes",
                          "runs are likely to fail at every optimum of the last surrogates: candidates are the best runs that were made"));
}

TEST(CalibrationLines, OptimisersAndObjectivesAgreeOrNot) {
  const ModelShape shape = two_parameters();
  EncAgreement a;
  EXPECT_EQ(agreement_sentence(a, shape), "");
  a.optimizers = {{.name = "de", .rounds = 4, .agrees = true}, {.name = "es", .rounds = 4, .distance = 0.123, .shortfall = 4.56}, {.name = "gwo", .rounds = 0}};
  a.objectives = {
      {.objective = "paper_enc", .theta = {13000, 0}, .agrees = true}, {.objective = "rrmse", .theta = {13200, 0.5}}, {.objective = "paper_spe", .theta = {}}};
  EXPECT_EQ(agreement_sentence(a, shape),
            "The optimisers disagree: es ends 0.12 of the bounds away, 4.56 worse. The objectives disagree: rrmse moves density +1.5 %, offset +0.5; paper_spe "
            "has no value anywhere. The result depends on the formulation of the misfit.");
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

TEST(CalibrationLines, MapReportsWhatIsIdentifiedOnlyIfThereIsAResult) {
  MapSummary map;
  const MapWords words{.check = "the emulator holds", .nested = "", .identified = "the data pin the impedance", .score_tests = "nothing stands out"};
  map.status = CalibrationStatus::done;
  EXPECT_THAT(map_lines(map, words), ElementsAre("map: the data pin the impedance", "map: the emulator holds", "map: nothing stands out"));
  map.status = CalibrationStatus::no_candidate;
  EXPECT_THAT(map_lines(map, words), ElementsAre("map: the emulator holds", "map: nothing stands out"));
}

TEST(CalibrationLines, AMissingOrPartialCorrectionHasAReason) {
  EXPECT_THAT(not_corrected_line("spe", EmulatorMeshes::one_size),
              testing::AllOf(HasSubstr("spe: predictions are not corrected for the mesh"), HasSubstr("emulator.element_sizes")));
  EXPECT_THAT(not_corrected_line("spe", EmulatorMeshes::from_file), testing::AllOf(HasSubstr("comes from a file"), Not(HasSubstr("emulator.element_sizes"))));
  EXPECT_EQ(viscosity_left_sentence("enc", 812.3456, 2000),
            "enc: the case's mesh has a regularising viscosity of 812.3 Pa s, the emulator one of 2000, and emulator.viscosity_sd = 0: the difference is not "
            "taken off");
}
