#include "apps/report/sections/corner.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "apps/report/data/study.hpp"
#include "apps/report/report.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/unit/apps/report/study.hpp"
#include "uq/convergence/diagnostics.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::HasSubstr;

namespace {

/// The corner plot's numbers of a study with ENC, MAP and these draws.
Json corner_of(const std::filesystem::path& dir, const ReportInput& in, const Draws& draws, std::size_t points = 1500) {
  write_calibration(dir, in, "enc");
  write_calibration(dir, in, "map");
  write_sample(dir, draws);
  return corner_json(read_study(dir), in, points);
}

}  // namespace

TEST(ReportPosterior, DensitiesIntegrateToOneAndContoursHoldTheirShare) {
  const auto in = input();
  const auto draws = ridge_draws();
  const Json corner = corner_of(scratch("posterior_corner"), in, draws);
  ASSERT_EQ(corner["axes"].size(), 4u);
  EXPECT_EQ(corner["axes"][1]["name"], "density");
  EXPECT_EQ(corner["axes"][1]["label"], "density [kg/m\u00b3]");
  EXPECT_EQ(corner["pairs"].size(), 6u);
  for (const auto& a : corner["axes"]) {
    const double low = a["span"][0], high = a["span"][1];
    double sum = 0;
    for (const auto& v : a["density"]) sum += v.get<double>() * (high - low) / double(a["density"].size() - 1);
    EXPECT_NEAR(sum, 1, 0.01) << a["name"];
  }
  const auto rho = draws.of(1), speed = draws.of(2);
  EXPECT_NEAR(corner["axes"][1]["q50"].get<double>(), quantile(rho, 0.5), 1e-5 * 13000);
  for (const auto& p : corner["pairs"])
    for (const auto& [key, share] : {std::pair{"level50", 0.5}, std::pair{"level90", 0.9}}) {
      const Json &a = corner["axes"][p["i"].get<std::size_t>()], &b = corner["axes"][p["j"].get<std::size_t>()];
      const auto x = draws.of(p["i"].get<std::size_t>()), y = draws.of(p["j"].get<std::size_t>());
      const double n = p["cells"].get<double>();
      double inside = 0;
      for (std::size_t k = 0; k < x.size(); ++k) {
        const double i = std::floor((x[k] - a["span"][0].get<double>()) / (a["span"][1].get<double>() - a["span"][0].get<double>()) * n);
        const double j = std::floor((y[k] - b["span"][0].get<double>()) / (b["span"][1].get<double>() - b["span"][0].get<double>()) * n);
        if (i >= 0 && j >= 0 && i < n && j < n)
          inside += p["density"][std::size_t(j * n + i)].get<double>() >= p[key].get<double>() ? 1.0 / double(x.size()) : 0.0;
      }
      EXPECT_NEAR(inside, share, 0.04) << p["i"] << " " << p["j"] << " " << key;  // one cell of the narrow ridge holds up to 2 % of the draws
    }
  const double product = corner["ridge"]["product"];
  EXPECT_NEAR(product / 19.4e6, 1, 0.002);
  EXPECT_EQ(corner["ridge"]["i"], 1);
  EXPECT_EQ(corner["ridge"]["j"], 2);
}

TEST(ReportPosterior, AnswersOfTheCalibrationsAreMarksOnlyNearbyOnesWidenTheFrame) {
  const auto in = input();
  const Json corner = corner_of(scratch("posterior_marks"), in, ridge_draws());
  ASSERT_EQ(corner["marks"].size(), 5u);
  EXPECT_EQ(corner["marks"][0]["label"], "ENC");
  EXPECT_EQ(corner["marks"][1]["label"], "MAP");
  EXPECT_EQ(corner["marks"][2]["label"], "nominal");
  EXPECT_EQ(corner["marks"][3]["label"], "ENC, published");
  EXPECT_EQ(corner["marks"][4]["label"], "SPE, published");
  EXPECT_EQ(corner["marks"][4]["values"], Json({53300, 7720, 2449, nullptr}));
  EXPECT_EQ(corner["marks"][0]["values"][1], 10345.0);
  EXPECT_TRUE(corner["marks"][0]["values"][3].is_null());        // a gain that ENC does not have
  EXPECT_LT(corner["axes"][1]["span"][0].get<double>(), 10345);  // ENC, nearby
  EXPECT_GT(corner["axes"][1]["span"][0].get<double>(), 7720);   // MAP of this study, far off
}

TEST(ReportPosterior, DensityEndsAtABound) {
  auto in = input();
  in.parameters[0].max = 1.1e5;
  auto draws = ridge_draws();
  for (std::size_t i = 0; i < draws.values.size(); i += 4)
    if (draws.values[i] > 1.1e5) draws.values[i] = 1.1e5 * 1.1e5 / draws.values[i];  // folded at the median
  const Json a = corner_of(scratch("posterior_bound"), in, draws)["axes"][0];
  double beyond = 0, highest = 0, at_bound = 0;
  for (std::size_t k = 0; k < a["density"].size(); ++k) {
    const double x = a["span"][0].get<double>() + (a["span"][1].get<double>() - a["span"][0].get<double>()) * double(k) / double(a["density"].size() - 1),
                 v = a["density"][k].get<double>();
    highest = std::max(highest, v);
    (x > 1.1e5 ? beyond : at_bound) = v;
  }
  EXPECT_EQ(beyond, 0);
  EXPECT_GT(at_bound, 0.8 * highest);  // the density does not sag at the bound
}

TEST(ReportPosterior, ShowsSixQuantitiesAtMostAndThinsPointsEvenly) {
  Draws draws{.chains = 4, .draws = 500};
  for (int k = 0; k < 9; ++k) draws.names.push_back("nuisance_" + std::to_string(k));
  draws.names.push_back("sound_speed");
  RandomStream random(3, 0);
  for (std::size_t i = 0; i < 20000; ++i) draws.values.push_back(random.normal());
  const auto dir = scratch("posterior_many");
  const Json corner = corner_of(dir, input(), draws, 300);
  ASSERT_EQ(corner["axes"].size(), 6u);
  EXPECT_EQ(corner["axes"][0]["name"], "sound_speed");  // the case's own parameter comes first
  double highest = 0;
  for (const auto& v : corner["axes"][0]["density"]) highest = std::max(highest, v.get<double>());
  EXPECT_GT(highest, 0);  // although all draws lie beyond the case's bounds
  EXPECT_LE(corner["points"].size(), 300u);
  EXPECT_GT(corner["points"].size(), 200u);
  EXPECT_TRUE(corner["ridge"].is_null());  // density is not among the quantities
  write_report(dir, input());
  EXPECT_THAT(read_text(dir / "report.html"), HasSubstr("The first 6 of 10 quantities"));
}
