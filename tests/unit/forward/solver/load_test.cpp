#include "forward/solver/load.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "forward/mesh/make_mesh.hpp"
#include "tests/scratch.hpp"

using namespace calomel;
using ::testing::HasSubstr;

namespace {

std::filesystem::path file(const std::string& text) {
  const auto path = scratch_file("history.txt");
  std::ofstream(path) << text;
  return path;
}
std::string complaint(const std::string& text) {
  try {
    (void)read_history(file(text));
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

}  // namespace

TEST(Profile, ItsAnalyticMaximumIsTheGreatestSample) {
  for (const double buildup : {0.0, 0.1, 1.5, 4.0})
    for (const double length : {0.005, 0.02, 0.2}) {
      ProfileOptions p;
      p.buildup = buildup;
      p.buildup_length = length;
      double greatest = 0, shape = 0;
      for (double x = 0; x <= 0.6; x += 1e-5) {
        greatest = std::max(greatest, (1 + buildup * (1 - std::exp(-x / length))) * std::exp(-x / p.decay));
        shape = std::max(shape, p.shape({x, p.center[0], p.center[1]}, false));
      }
      EXPECT_NEAR(p.greatest(), greatest, 1e-7 * greatest) << buildup << ' ' << length;
      EXPECT_NEAR(shape, 1, 1e-7);
    }
}

TEST(Profile, TransverseWidthsAreStandardDeviationsAndPlaneStrainDropsY) {
  ProfileOptions p;
  p.center = {0.01, 0.03};
  const double here = p.shape({0.05, 0.01, 0.03}, false);
  EXPECT_NEAR(p.shape({0.05, 0.01, 0.05}, false), here * std::exp(-0.5), 1e-12);
  EXPECT_NEAR(p.shape({0.05, 0.01 + 0.058, 0.03}, false), here * std::exp(-0.5), 1e-12);
  EXPECT_DOUBLE_EQ(p.shape({0.05, 0.4, 0.03}, true), here);
}

TEST(HeatingShape, HeatsTheMercuryOnlyAndIntegratesTheProfile) {
  GeometryOptions g;
  g.kind = "box";
  g.length = 0.08;
  g.width = 0.05;
  g.height = 0.04;
  g.wall = 0.004;
  g.element_size = 0.004;
  const Mesh mesh = make_mesh(g);
  ProfileOptions p;
  p.center = {0, 0.02};
  const auto heat = heating_shape(mesh, p);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) EXPECT_EQ(heat.element[e] > 0, mesh.region[e] == Region::mercury);
  // Midpoint sum over the mercury, 0.076 x 0.042 x 0.032 m.
  double sum = 0;
  const int n = 40;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) sum += p.shape({0.004 + 0.076 * (i + 0.5) / n, -0.021 + 0.042 * (j + 0.5) / n, 0.004 + 0.032 * (k + 0.5) / n}, false);
  EXPECT_NEAR(heat.integral, sum * 0.076 * 0.042 * 0.032 / (n * n * n), 1e-3 * heat.integral);
}

// Gamma = beta c^2 / c_p, 2.73 at the nominal values (physics.md section 2).
TEST(Gruneisen, IsThePublishedValueAtNominal) { EXPECT_NEAR(gruneisen({}, 1450), 2.73, 0.01); }

TEST(LoadOptions, RequireOneStrengthOfThePulse) {
  LoadOptions o;
  EXPECT_THROW(o.validate(), InputError);
  o.peak_pressure = 25e6;
  EXPECT_NO_THROW(o.validate());
  o.energy = 13e3;
  EXPECT_THROW(o.validate(), InputError);
  LoadOptions end;
  end.kind = "end_stress";
  EXPECT_THROW(end.validate(), InputError);
  end.file = "pulse.txt";
  EXPECT_NO_THROW(end.validate());
}

TEST(History, IsLinearBetweenSamplesAndKeepsItsEnds) {
  const History h{{1, 2, 4}, {10, 20, 0}};
  EXPECT_EQ(h.at(0), 10);
  EXPECT_EQ(h.at(1.5), 15);
  EXPECT_EQ(h.at(2), 20);
  EXPECT_EQ(h.at(3), 10);
  EXPECT_EQ(h.at(9), 0);
  EXPECT_EQ(History{}.at(1), 0);
}

TEST(ReadHistory, TakesCommasSpacesCommentsAndAHeader) {
  const History h = read_history(file("time,stress\n# measured\n0, 1e6\n1e-6 2e6\n\n2e-6,\t-3e6\n"));
  EXPECT_THAT(h.time, ::testing::ElementsAre(0, 1e-6, 2e-6));
  EXPECT_THAT(h.value, ::testing::ElementsAre(1e6, 2e6, -3e6));
}

TEST(ReadHistory, NamesTheLineOfAMistake) {
  EXPECT_THAT(complaint("0 1\n1e-6 x\n"), HasSubstr(".txt:2: \"1e-6 x\": two numbers are expected"));
  EXPECT_THAT(complaint("0 1\n2 1\n2 3\n"), HasSubstr(".txt:3: 2: time must increase"));
  EXPECT_THAT(complaint("# nothing\n0 1\n"), HasSubstr("fewer than two samples"));
  EXPECT_THROW((void)read_history("/nowhere/at/all.txt"), InputError);
}
