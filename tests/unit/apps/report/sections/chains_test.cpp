#include "apps/report/sections/chains.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <variant>

#include "apps/report/data/study.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/unit/apps/report/reading.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::HasSubstr;

TEST(ReportPosterior, RanksAreLevelWhereChainsAgreeAndNotWhereOneLiesApart) {
  const auto dir = scratch("posterior_ranks");
  for (const bool apart : {false, true}) {
    write_sample(dir, ridge_draws(apart));
    const Json chains = chains_json(read_study(dir), input());
    ASSERT_EQ(chains["quantities"].size(), 4u);
    EXPECT_EQ(chains["expected"], 100);
    const Json& density = chains["quantities"][1];
    ASSERT_EQ(density["ranks"].size(), 4u);
    EXPECT_EQ(density["trace"][3].size(), chains["iterations"].size());
    int outside = 0;
    for (const auto& counts : density["ranks"]) {
      int all = 0;
      for (const auto& n : counts) {
        all += n.get<int>();
        outside += std::abs(n.get<double>() - 100) > chains["spread"][1].get<double>();
      }
      EXPECT_EQ(all, 2000);
    }
    // Of 80 counts 4 +- 2 lie beyond two standard deviations by chance.
    if (apart)
      EXPECT_GT(density["ranks"][3][19].get<int>(), 300);
    else
      EXPECT_LT(outside, 10);
  }
}

TEST(ReportPosterior, DrawsThatBreakOffAreReported) {
  const auto dir = scratch("posterior_cut");
  auto draws = ridge_draws();
  EXPECT_TRUE(broken_off(draws).empty());
  for (std::size_t i = 2; i < draws.values.size(); i += 4) draws.values[i] = 1450 + std::abs(draws.values[i] - 1450);  // folded within the bulk
  const auto cut = broken_off(draws);
  ASSERT_EQ(cut.size(), 1u);
  EXPECT_EQ(cut[0].name, "sound_speed");
  EXPECT_NEAR(cut[0].at, 1450, 1);
  write_sample(dir, draws);
  EXPECT_THAT(markup(report_of(dir, input())), HasSubstr("The draws break off: sound_speed at 1450"));
}

TEST(ReportPosterior, PriorAndPosteriorGiveRatioOfWidthsAndMove) {
  const auto dir = scratch("posterior_priors");
  auto in = input();
  in.parameters[2].prior = "normal";
  in.parameters[2].mean = 1450;
  in.parameters[2].sd = 145;
  write_sample_and_predictions(dir, in, ridge_draws());
  const Study study = read_study(dir);
  const Table t = prior_table(study, in);
  ASSERT_EQ(t.rows.size(), 2u);  // the gain and the cutoff have no draws of a prior here
  // A uniform density on +-1300 has a half width of 887; the draws have one of 5 % of 12 900.
  EXPECT_NEAR(std::get<double>(t.rows[0][5].value), 887.0 / 645, 0.08);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(t.rows[0][6].value));  // a prior of bounds alone has no half width to count moves in
  EXPECT_NEAR(std::get<double>(t.rows[1][6].value), (19.4e6 / 12900 - 1450) / 145, 0.1);
  const Json priors = priors_json(study, in);
  ASSERT_EQ(priors["panels"].size(), 2u);
  for (const auto& p : priors["panels"])
    for (const char* key : {"prior", "posterior"}) {
      const double low = p[key]["span"][0], high = p[key]["span"][1];
      double sum = 0;
      for (const auto& v : p[key]["density"]) sum += v.get<double>() * (high - low) / double(p[key]["density"].size() - 1);
      EXPECT_NEAR(sum, 1, 0.03) << p["label"] << " " << key;
    }
  const std::string text = markup(report_of(dir, in));
  EXPECT_THAT(text, HasSubstr("The records narrow the priors: sound_speed 2 times."));
  EXPECT_THAT(text, HasSubstr("Of sound_speed, which has a prior, none differs by more than two prior standard deviations"));
  EXPECT_THAT(text, HasSubstr("For tensile_cutoff, density only bounds were given."));
  EXPECT_FALSE(data_of(read_text(dir / "report.html"))["priors"].is_null());
  write_tables_csv(dir, in);
  EXPECT_NEAR(number_in(csv_of(dir / "report_csv" / "posterior_priors.csv"), 1, "prior_median"), 1450, 15);
}
