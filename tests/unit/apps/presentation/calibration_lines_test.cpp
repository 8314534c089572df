#include "apps/presentation/calibration_lines.hpp"

#include <gmock/gmock.h>

#include "apps/presentation/fit_words.hpp"

using namespace calomel;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST(CalibrationLines, OnlyFindingsAreReported) {
  EncSummary enc;
  EXPECT_THAT(enc_lines(enc), IsEmpty());
  enc.agreement.sentence = "the optimisers agree";
  EXPECT_THAT(enc_lines(enc), ElementsAre("enc: the optimisers agree"));
  enc.mesh.sentence = "the mesh takes 11 %";
  EXPECT_THAT(enc_lines(enc), ElementsAre("enc: the mesh takes 11 %", "enc: the optimisers agree"));
  SpeSummary spe;
  spe.mesh.sentence = "the mesh takes 9 %";
  EXPECT_THAT(spe_lines(spe), ElementsAre("spe: the mesh takes 9 %"));
}

TEST(CalibrationLines, MapReportsWhatIsIdentifiedOnlyIfThereIsAResult) {
  MapSummary map;
  map.identification.sentence = "the data pin the impedance";
  const std::string check = "map: " + check_sentence(map.check);
  map.status = CalibrationStatus::done;
  EXPECT_THAT(map_lines(map), ElementsAre("map: the data pin the impedance", check));
  map.status = CalibrationStatus::no_candidate;
  EXPECT_THAT(map_lines(map), ElementsAre(check));
}

TEST(CalibrationLines, AMissingOrPartialCorrectionHasAReason) {
  EXPECT_THAT(not_corrected_line("spe", EmulatorMeshes::one_size),
              testing::AllOf(HasSubstr("spe: predictions are not corrected for the mesh"), HasSubstr("emulator.element_sizes")));
  EXPECT_THAT(not_corrected_line("spe", EmulatorMeshes::from_file), testing::AllOf(HasSubstr("comes from a file"), Not(HasSubstr("emulator.element_sizes"))));
  EXPECT_EQ(viscosity_left_sentence("enc", 812.3456, 2000),
            "enc: the case's mesh has a regularising viscosity of 812.3 Pa s, the emulator one of 2000, and emulator.viscosity_sd = 0: the difference is not "
            "taken off");
}
