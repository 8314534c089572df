// Names, places and numbers of a diagnosis, as a person would write them.
#include "apps/presentation/diagnosis_numbers.hpp"

#include <gtest/gtest.h>

#include "tests/unit/apps/presentation/judged_diagnosis.hpp"

namespace calomel {
namespace {

TEST(DiagnosisNumbers, HaveUnitsThatAPersonWouldUse) {
  const auto value = [](const std::string& unit, double off, double mean, double sd, bool inverse = false, double max = 1) {
    std::vector<ParameterGroup> g{{.name = "g", .added = {number_of("g.x", unit, off, "")}}};
    g[0].added[0].inverse = inverse;
    g[0].added[0].parameter.max = max;
    Alternative a;
    a.groups = {"g"};
    const PlainNumber n = plain_number(a, {"g.x", mean, sd}, g);
    return n.value + " | " + n.off;
  };
  EXPECT_EQ(value("m", 0, 2.312e-3, 1.61e-4), "2.31 ± 0.16 mm | 0 mm");
  EXPECT_EQ(value("m", 0, 1.37e-5, 3.4e-6), "13.7 ± 3.4 µm | 0 µm");
  EXPECT_EQ(value("s", 7e-7, 9.5e-7, 1.2e-7), "0.95 ± 0.12 µs | 0.7 µs");
  EXPECT_EQ(value("Pa", 0, 1.234e5, 2e4), "0.123 ± 0.020 MPa | 0 MPa");
  EXPECT_EQ(value("Pa s", 0, 812, 95), "812 ± 95 Pa s | 0 Pa s");
  EXPECT_EQ(value("", 0, 3.2e-7, 1.1e-8), "3.20e-07 ± 1.1e-08 | 0");
  EXPECT_EQ(value("", 0, 1.0029878, 3.64e-5), "1.002988e+00 ± 3.6e-05 | 0");  // enough digits to distinguish it from 1
  EXPECT_EQ(value("", 1, 0.94, 0), "0.94 | 1");
  EXPECT_EQ(value("Hz", 0, 1 / 50e3, 1 / 500e3, true), "50.0 ± 5.0 kHz | none");
  EXPECT_EQ(value("Hz", 0, 1e-6, 2e-6, true), "above 200 kHz | none");  // 1 / (1e-6 + 4e-6)
  EXPECT_EQ(value("Pa", 0, -1 / 98e3, 1e-7, true, 0), "-98.00 ± 0.96 kPa | none");
}

TEST(DiagnosisNumbers, AShareThatTheRecordsDoNotNarrowIsNoNumber) {
  std::vector<ParameterGroup> g{{.name = "g", .added = {number_of("g.x", "Pa", 1, "")}}};
  g[0].added[0].share_of = "material.mercury.tensile_cutoff";
  Alternative a;
  a.groups = {"g"};
  a.numbers = {{"g.x", 1e5, 5e4, false}};
  const PlainNumber n = plain_number(a, a.numbers[0], g);
  EXPECT_EQ(n.value, "below the mercury's own (the records do not narrow it)");
  EXPECT_EQ(n.off, "the mercury's own");
  EXPECT_EQ(plain_size(a, g), "x below the mercury's own (the records do not narrow it)");
}

TEST(DiagnosisNumbers, ManySmallNumbersAreGivenTogether) {
  Alternative a;
  a.explanation.name = "left";
  a.groups = {"left"};
  a.numbers = {{"left.a_1", 0.03, 0.01}, {"left.a_2", 0, 0.01}, {"left.a_3", -0.04, 0.01}};
  const std::vector<ParameterGroup> many{
      {.name = "left", .added = {number_of("left.a_1", "", 0, ""), number_of("left.a_2", "", 0, ""), number_of("left.a_3", "", 0, "")}, .linear = true}};
  EXPECT_EQ(plain_size(a, many), "a_1 to a_3 together 0.05 (root of the sum of squares) in place of 0");
}

TEST(DiagnosisNumbers, AStretchIsGivenAsItWasFitted) {
  const std::vector<Estimate> numbers{{"wall_thinning.fraction", 0.1, 0.01}, {"wall_thinning.begin", 0.0103, 1e-3}, {"wall_thinning.end", 0.02547, 1e-3}};
  EXPECT_EQ(fitted_place("wall_thinning", "front, 14.2 to 23.8 mm", numbers), "front, 10.3 to 25.5 mm");
  EXPECT_EQ(fitted_place("wall_thinning", "front", numbers), "front, 10.3 to 25.5 mm");
  EXPECT_EQ(fitted_place("interface", "top", numbers), "top");
  Alternative a = wall(8);
  a.numbers = numbers;
  EXPECT_EQ(fitted_places(a).at("wall_thinning"), "top, 10.3 to 25.5 mm");
  EXPECT_EQ(plain_name(a, judged_groups()), "a wall that is thinner than drawn (top, 10.3 to 25.5 mm)");
}

TEST(DiagnosisNumbers, AFaultyGaugeIsCalledByItsName) {
  Alternative a;
  a.groups = {"sensor_response"};
  a.sensor = "S02";
  EXPECT_EQ(plain_name(a, judged_groups()), "a fault of gauge S02");
}

TEST(DiagnosisNumbers, ATermIsAChange) {
  EXPECT_EQ(plain_term({.what = "mass", .place = "on the top wall", .unit = "kg/m^2", .value = -4.5, .sd = 0.7}), "-4.50 ± 0.70 kg/m²");
  EXPECT_EQ(plain_term({.what = "bulk modulus", .place = "in all of the mercury", .unit = "", .value = 0.031, .sd = 0.004}), "+3.10 ± 0.40 %");
}

}  // namespace
}  // namespace calomel
