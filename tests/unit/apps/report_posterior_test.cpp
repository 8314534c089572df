#include <gmock/gmock.h>

#include <cmath>

#include "apps/report/chains.hpp"
#include "apps/report/page.hpp"
#include "apps/report/posterior.hpp"
#include "apps/report/published.hpp"
#include "apps/report/report.hpp"
#include "apps/report/traces.hpp"
#include "tests/unit/apps/report_reading.hpp"
#include "tests/unit/apps/report_study.hpp"
#include "uq/convergence/diagnostics.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::HasSubstr;
using testing::Not;

namespace {

/// The corner plot's numbers of a study with ENC, MAP and these draws.
Json corner_of(const std::filesystem::path& dir, const ReportInput& in, const Draws& draws, std::size_t points = 1500) {
  write_calibration(dir, in, "enc");
  write_calibration(dir, in, "map");
  write_sample(dir, draws);
  return corner_json(read_study(dir), in, points);
}

}  // namespace

TEST(ReportPosterior, WithoutDrawsNamesTheCommand) {
  const auto dir = scratch("no_posterior");
  write_study(dir, input());
  write_report(dir, input());
  EXPECT_THAT(read_text(dir / "report.html"),
              HasSubstr("No posterior has been sampled (posterior.nc, posterior.json). Sample it with <code>calomel sample slice.toml</code>."));
  EXPECT_TRUE(corner_json(read_study(dir), input(), 100).is_null());
}

TEST(ReportPosterior, TableHoldsTheNumbersOfTheSummary) {
  const auto dir = scratch("posterior_table");
  const auto in = input();
  write_sample(dir, ridge_draws());
  write_report(dir, in);
  const std::string page = read_text(dir / "report.html");
  EXPECT_THAT(page, HasSubstr("The chains have converged"));
  EXPECT_THAT(page, HasSubstr("By the <a href=\"#posterior\">posterior</a>: tensile_cutoff <strong>"));
  EXPECT_THAT(page, Not(HasSubstr("gain_B <strong>")));  // the case's own alone
  EXPECT_THAT(page, Not(HasSubstr("No calibration has been run yet, so this page shows")));
  EXPECT_THAT(page, HasSubstr("density [kg/m\u00b3]"));
  EXPECT_THAT(page, HasSubstr("id=\"corner-plot\""));
  EXPECT_THAT(page, HasSubstr("4 chains of 2000 draws"));
  const Table t = posterior_table(read_study(dir), in);
  ASSERT_EQ(t.rows.size(), 4u);
  const Json json = read_json(dir / "posterior.json");
  EXPECT_EQ(std::get<double>(t.rows[1][1].value), json["parameters"][1]["mean"].get<double>());
}

TEST(ReportPosterior, ChainsThatDisagreeAreToldFirst) {
  const auto dir = scratch("posterior_apart");
  write_sample(dir, ridge_draws(true));
  write_report(dir, input());
  const std::string page = read_text(dir / "report.html");
  EXPECT_THAT(page, HasSubstr("Not converged, not to be trusted:"));
  EXPECT_THAT(page, HasSubstr("<strong>The posterior is not to be trusted</strong>"));
  EXPECT_THAT(page, Not(HasSubstr("By the <a href")));
  EXPECT_THAT(page, HasSubstr("<li>sampling: "));
  EXPECT_THAT(page, HasSubstr("chain 4"));
}

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
      EXPECT_NEAR(inside, share, 0.04) << p["i"] << " " << p["j"] << " " << key;  // a cell of the narrow ridge holds up to 2 % of the draws
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
  EXPECT_GT(at_bound, 0.8 * highest);  // does not sag there
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
  EXPECT_EQ(corner["axes"][0]["name"], "sound_speed");  // the case's own first
  double highest = 0;
  for (const auto& v : corner["axes"][0]["density"]) highest = std::max(highest, v.get<double>());
  EXPECT_GT(highest, 0);  // though all draws lie beyond the case's bounds
  EXPECT_LE(corner["points"].size(), 300u);
  EXPECT_GT(corner["points"].size(), 200u);
  EXPECT_TRUE(corner["ridge"].is_null());  // no density among them
  write_report(dir, input());
  EXPECT_THAT(read_text(dir / "report.html"), HasSubstr("The first 6 of 10 quantities"));
}

TEST(ReportPosterior, CsvHoldsEveryDraw) {
  const auto dir = scratch("posterior_csv");
  const auto draws = ridge_draws();
  write_sample(dir, draws);
  const auto paths = write_tables_csv(dir, input());
  const std::string csv = read_text(dir / "report_csv" / "posterior_draws.csv");
  EXPECT_THAT(csv, testing::StartsWith("chain,draw,tensile_cutoff,density,sound_speed,gain_B\n0,0,"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 8001);
  EXPECT_TRUE(std::filesystem::exists(dir / "report_csv" / "posterior.csv"));
}

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
    // 80 counts, each beyond two standard deviations with a chance of 5 %: 4 +- 2.
    if (apart)
      EXPECT_GT(density["ranks"][3][19].get<int>(), 300);
    else
      EXPECT_LT(outside, 10);
  }
}

TEST(ReportPosterior, DrawsThatBreakOffAreTold) {
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

TEST(ReportPosterior, PriorAgainstPosteriorTellsHowMuchNarrowerAndHowFarItMoved) {
  const auto dir = scratch("posterior_priors");
  auto in = input();
  in.parameters[2].prior = "normal", in.parameters[2].mean = 1450, in.parameters[2].sd = 145;
  write_sample_and_predictions(dir, in, ridge_draws());
  const Study study = read_study(dir);
  const Table t = prior_table(study, in);
  ASSERT_EQ(t.rows.size(), 2u);  // the gain and the cutoff have no draws of a prior here
  // Of a uniform density on +-1300 about its middle 68.27 % lie within +-887; the draws have 5 % of 12 900.
  EXPECT_NEAR(std::get<double>(t.rows[0][5].value), 887.0 / 645, 0.08);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(t.rows[0][6].value));  // bounds alone: nothing to have moved from
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
  EXPECT_THAT(text, HasSubstr("The records narrow what was known: sound_speed 2 times."));
  EXPECT_THAT(text, HasSubstr("Of sound_speed, which has a prior, none sits more than two prior standard deviations"));
  EXPECT_THAT(text, HasSubstr("Of tensile_cutoff, density nothing but bounds was given."));
  EXPECT_FALSE(data_of(read_text(dir / "report.html"))["priors"].is_null());
  write_tables_csv(dir, in);
  EXPECT_NEAR(number_in(csv_of(dir / "report_csv" / "posterior_priors.csv"), 1, "prior_median"), 1450, 15);
}

TEST(ReportPosterior, AParameterThatAbsorbsSomethingIsToldAtTheTopAndInItsSection) {
  const auto dir = scratch("posterior_absorbed");
  write_sample(dir, ridge_draws());
  Json json = read_json(dir / "posterior.json");
  json["absorption"] = {"density sits 2.4 prior standard deviations below what was known of it: the model leaves something else out, which it absorbs"};
  write_json(dir / "posterior.json", json);
  const std::string text = markup(report_of(dir, input()));
  EXPECT_THAT(text, HasSubstr("<li>sampling: density sits 2.4 prior standard deviations below"));
  EXPECT_THAT(
      text,
      HasSubstr(
          "<strong>density sits 2.4 prior standard deviations below what was known of it: the model leaves something else out, which it absorbs.</strong>"));
  EXPECT_THAT(text, HasSubstr("<code>calomel diagnose slice.toml</code> asks what was left out."));
  EXPECT_THAT(text, Not(HasSubstr("none sits more than")));
}

TEST(ReportPosterior, AFitThatTheRecordsContradictIsToldAndItsNumbersAreNotFinal) {
  const auto dir = scratch("posterior_inadequate");
  write_sample(dir, ridge_draws());
  Json json = read_json(dir / "posterior.json");
  json["final"] = false, json["adequate"] = false, json["adequacy"] = "the fit is not adequate: chi-squared 369 for 80 values";
  json["warnings"] = {json["adequacy"]};
  write_json(dir / "posterior.json", json);
  const std::string told = markup(report_of(dir, input()));
  EXPECT_THAT(told, HasSubstr("<strong>By chi-squared, the fit is not adequate: chi-squared 369 for 80 values.</strong>"));
  EXPECT_THAT(told, HasSubstr("<li>sampling: the fit is not adequate"));
  EXPECT_THAT(told, HasSubstr("<strong>Not final</strong>: the warnings say why."));
  json["final"] = true, json["adequate"] = true, json["adequacy"] = "the records do not contradict the fit: chi-squared 33 for 80 values",
  json["warnings"] = Json::array();
  write_json(dir / "posterior.json", json);
  const std::string fits = markup(report_of(dir, input()));
  EXPECT_THAT(fits, HasSubstr("<p>By chi-squared, the records do not contradict the fit: chi-squared 33 for 80 values.</p>"));
  EXPECT_THAT(fits, Not(HasSubstr("Not final")));
}

TEST(ReportPosterior, BandsHoldDrawsAndErrors) {
  const auto dir = scratch("posterior_bands");
  const auto in = input();
  write_sample_and_predictions(dir, in, ridge_draws());
  const Study study = read_study(dir);
  ASSERT_TRUE(study.predictive.has_value());
  const Histories& h = *study.predictive;
  const std::size_t at = 2 * h.record_time.size() + 150;  // the third gauge
  const double y = wave(150e-6, 2, 1), sd = std::abs(y) * 0.1 / std::sqrt(3.0);
  EXPECT_NEAR(h.predicted[at], y, 1e-9);
  EXPECT_NEAR(h.draws_high[at] - h.draws_low[at], 0.18 * std::abs(y), 0.003 * std::abs(y));  // 90 % of an even spread of 20 %
  EXPECT_NEAR(h.predicted_high[at] - y, 1.645 * std::hypot(sd, 20e-6), 0.02 * std::hypot(sd, 20e-6));
  const std::string page = report_of(dir, in);
  const Json data = data_of(page)["predictive"];
  EXPECT_EQ(data["conditions"][0]["sensors"][2]["name"], "F");
  EXPECT_EQ(data["series"].size(), 3u);
  EXPECT_EQ(data["scores"]["F"], "100\u00a0% of the record inside");
  EXPECT_THAT(page, HasSubstr("id=\"predictive-plots\""));
  // Without errors the narrow band alone is shown, and nothing is said of what lies inside.
  write_sample_and_predictions(dir, in, ridge_draws(), false);
  const Json narrow = data_of(report_of(dir, in))["predictive"];
  EXPECT_EQ(narrow["series"].size(), 2u);
  EXPECT_TRUE(narrow["scores"].empty());
}

TEST(ReportPosterior, PublishedAnswersStandOnlyWhereTheCaseAsksForTheSameOfMercury) {
  const auto dir = scratch("posterior_published");
  const auto in = input();
  write_sample(dir, ridge_draws());
  const std::string text = published_paragraph(read_study(dir), in);
  EXPECT_THAT(text, HasSubstr("Model Calibration of the Liquid Mercury Spallation Target using Evolutionary Neural Networks and Sparse Polynomial Expansions"));
  EXPECT_THAT(text, HasSubstr("ENC 10\u202f345\u00a0kg/m\u00b3, 2020\u00a0m/s, 85\u202f642\u00a0Pa"));
  EXPECT_THAT(text, HasSubstr("SPE 7720\u00a0kg/m\u00b3, 2449\u00a0m/s, 53\u202f300\u00a0Pa"));
  EXPECT_THAT(text, HasSubstr("\u03c1c = 20.9\u00a0MPa\u00b7s/m"));
  EXPECT_THAT(text, HasSubstr("Here \u03c1c is 19.4\u00a0MPa\u00b7s/m"));
  auto fewer = in, water = in, more = in;
  fewer.parameters.pop_back();
  water.options["material"]["mercury"]["density"] = 998.0;
  more.parameters.push_back({.name = "viscosity", .key = "solver.viscosity", .min = 0, .max = 1});
  for (const auto& other : {fewer, water, more}) {
    EXPECT_TRUE(published_answers(other).empty());
    EXPECT_EQ(published_paragraph(read_study(dir), other), "");
  }
}
