#include "uq/posterior_file.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/json.hpp"
#include "base/netcdf_file.hpp"
#include "tests/command_output.hpp"
#include "tests/scratch.hpp"
#include "tests/unit/uq/sampler/densities.hpp"
#include "uq/sampler/sampler.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

struct Named : Gaussian {
  using Gaussian::Gaussian;
  std::vector<std::string> quantities() const override { return {"density", "mechanism.bubbly_liquid.alpha0"}; }
};
const std::vector<Parameter> parameters{{.name = "density", .key = "material.mercury.density", .unit = "kg m-3"}};
Named named() { return {Eigen::VectorXd::Zero(2), Eigen::MatrixXd::Identity(2, 2)}; }

std::vector<PosteriorGroup> all_groups(const SamplerResult& r) {
  auto groups = posterior_groups(parameters, r);
  const std::size_t n = r.quantities.chains * r.quantities.draws;
  const std::vector<PosteriorCoordinate> axes{{"sensor", "", {}, {"A", "B"}}, {"time", "s", {0, 1e-6, 2e-6}, {}}};
  std::vector<double> values(n * 6);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = double(i);
  PosteriorGroup likelihood{.name = "log_likelihood", .chains = r.quantities.chains, .draws = r.quantities.draws};
  likelihood.coordinates = {axes[0]};
  likelihood.variables = {{"strain", "", {"sensor"}, {values.begin(), values.begin() + std::ptrdiff_t(2 * n)}}};
  groups.push_back(likelihood);
  groups.push_back({"posterior_predictive", r.quantities.chains, r.quantities.draws, axes, {{"strain", "1", {"sensor", "time"}, values}}});
  groups.push_back({"prior", 1, 5, {}, {{"density", "kg m-3", {}, {1, 2, 3, 4, 5}}}});
  groups.push_back({"observed_data", 0, 0, axes, {{"strain", "1", {"sensor", "time"}, {1, 2, 3, 4, std::nan(""), 6}}}});
  return groups;
}

SamplerResult some_draws() { return run_sampler(named(), {.mean = Eigen::VectorXd::Zero(2)}, {.warmup = 50, .draws = 20}, {.seed = 2}); }

}  // namespace

TEST(PosteriorFile, ComesBackAsItWasWritten) {
  const auto r = some_draws();
  const auto groups = all_groups(r);
  const auto path = scratch("posterior") / "posterior.nc";
  write_posterior(path, groups, {.stage = "sample"});
  const auto back = read_posterior(path);
  ASSERT_EQ(back.size(), groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    EXPECT_EQ(back[g].name, groups[g].name);
    EXPECT_EQ(back[g].chains, groups[g].chains);
    EXPECT_EQ(back[g].draws, groups[g].draws);
    ASSERT_EQ(back[g].coordinates.size(), groups[g].coordinates.size());
    for (std::size_t k = 0; k < back[g].coordinates.size(); ++k) {
      EXPECT_EQ(back[g].coordinates[k].name, groups[g].coordinates[k].name);
      EXPECT_EQ(back[g].coordinates[k].words, groups[g].coordinates[k].words);
      EXPECT_EQ(back[g].coordinates[k].numbers, groups[g].coordinates[k].numbers);
      EXPECT_EQ(back[g].coordinates[k].unit, groups[g].coordinates[k].unit);
    }
    ASSERT_EQ(back[g].variables.size(), groups[g].variables.size());
    for (std::size_t k = 0; k < back[g].variables.size(); ++k) {
      EXPECT_EQ(back[g].variables[k].name, groups[g].variables[k].name);
      EXPECT_EQ(back[g].variables[k].unit, groups[g].variables[k].unit);
      EXPECT_EQ(back[g].variables[k].dims, groups[g].variables[k].dims);
      ASSERT_EQ(back[g].variables[k].values.size(), groups[g].variables[k].values.size());
      for (std::size_t i = 0; i < back[g].variables[k].values.size(); ++i) {
        const double a = back[g].variables[k].values[i], b = groups[g].variables[k].values[i];
        EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b)));
      }
    }
  }
  const auto draws = draws_of(read_posterior(path, {"posterior"}).at(0));
  EXPECT_EQ(draws.names, r.quantities.names);
  EXPECT_EQ(draws.values, r.quantities.values);
  EXPECT_THROW((void)read_posterior(path, {"warmup_posterior"}), InputError);
}

TEST(PosteriorFile, IsTheSameBytesForTheSameContent) {
  const auto groups = all_groups(some_draws());
  const auto dir = scratch("bytes");
  write_posterior(dir / "a.nc", groups, {.stage = "sample"});
  write_posterior(dir / "b.nc", groups, {.stage = "sample"});
  EXPECT_EQ(hash_file(dir / "a.nc"), hash_file(dir / "b.nc"));
}

TEST(PosteriorFile, NcdumpShowsGroupsDimensionsAndUnits) {
  if (output_of("ncdump").first.find("netcdf library") == std::string::npos) GTEST_SKIP() << "ncdump (netcdf-bin) is not here";
  const auto path = scratch("ncdump") / "posterior.nc";
  write_posterior(path, all_groups(some_draws()), {.stage = "sample"});
  const auto [text, well] = output_of("ncdump -h '" + path.string() + "'");
  EXPECT_TRUE(well);
  for (const char* part : {"group: posterior {",
                           "group: unconstrained_posterior {",
                           "group: sample_stats {",
                           "group: log_likelihood {",
                           "group: posterior_predictive {",
                           "group: prior {",
                           "group: observed_data {",
                           "chain = 4 ;",
                           "draw = 20 ;",
                           "int chain(chain) ;",
                           "int draw(draw) ;",
                           "double density(chain, draw) ;",
                           "density:units = \"kg m-3\" ;",
                           "double mechanism.bubbly_liquid.alpha0(chain, draw) ;",
                           "double lp(chain, draw) ;",
                           "double acceptance_rate(chain, draw) ;",
                           "double strain(chain, draw, sensor) ;",
                           "double strain(chain, draw, sensor, time) ;",
                           "double strain(sensor, time) ;",
                           "string sensor(sensor) ;",
                           "time:units = \"s\" ;",
                           ":inference_library = \"calomel\" ;",
                           ":provenance = "})
    EXPECT_THAT(text, HasSubstr(part));
}

// With thinning a draw has several transitions: whether any of them diverged is what ArviZ takes for a mask. Predictions of some draws carry the numbers of
// those.
TEST(PosteriorFile, DivergencesAreTruthsAndDrawsKeepTheirNumbers) {
  const std::string python3 = python_with_xarray();
  ASSERT_NE(python3, "") << no_xarray;
  auto r = some_draws();
  const std::size_t n = r.quantities.chains * r.quantities.draws;
  r.energy.assign(n, 1.5);
  r.diverging.assign(n, 0);
  r.depth.assign(n, 3);
  r.diverging[2] = 2;
  auto groups = posterior_groups(parameters, r);
  groups.push_back({.name = "posterior_predictive",
                    .chains = 4,
                    .draws = 2,
                    .coordinates = {},
                    .variables = {{"strain", "1", {}, std::vector<double>(8, 0.5)}},
                    .draw_numbers = {9, 19}});
  const auto path = scratch("truths") / "posterior.nc";
  write_posterior(path, groups, {.stage = "sample"});
  const auto [text, well] = output_of(python3 +
                                      " -c 'import sys, xarray as x\np = sys.argv[1]\ns = x.open_dataset(p, group=\"sample_stats\")\n"
                                      "print(s[\"diverging\"].dtype, int(s[\"diverging\"].sum()), s[\"tree_depth\"].dtype.kind, list(x.open_dataset(p, "
                                      "group=\"posterior_predictive\")[\"draw\"].values))' '" +
                                      path.string() + "'");
  EXPECT_TRUE(well) << text;
  EXPECT_THAT(text, HasSubstr("bool 1 i [9, 19]"));
}

// The tools that the file is for.
TEST(PosteriorFile, XarrayReadsEveryGroupWithItsCoordinates) {
  const std::string python3 = python_with_xarray();
  ASSERT_NE(python3, "") << no_xarray;
  const auto path = scratch("xarray") / "posterior.nc";
  const auto r = some_draws();
  write_posterior(path, all_groups(r), {.stage = "sample"});
  const auto [text, well] =
      output_of(python3 +
                " -c 'import sys, xarray as x\np = sys.argv[1]\nd = x.open_dataset(p, group=\"posterior\")\n"
                "print(dict(d.sizes), float(d[\"density\"].sel(chain=3, draw=19)), d.attrs[\"inference_library\"])\n"
                "for g in [\"sample_stats\", \"log_likelihood\", \"posterior_predictive\", \"prior\", \"observed_data\", \"unconstrained_posterior\"]:\n"
                "  e = x.open_dataset(p, group=g)\n  assert set(e.coords) == set(e.dims), g\n"
                "  assert all(v.dims[:2] == (\"chain\", \"draw\") for v in e.data_vars.values()) or g == \"observed_data\", g\n"
                "print(x.open_dataset(p, group=\"observed_data\")[\"strain\"].sel(sensor=\"B\", time=2e-6).item())' '" +
                path.string() + "'");
  EXPECT_TRUE(well) << text;
  EXPECT_THAT(text, HasSubstr("{'chain': 4, 'draw': 20} " + number_text(r.quantities.at(3, 19, 0)) + " calomel\n6.0\n"));
}

TEST(PosteriorFile, WhatDoesNotFitIsADefect) {
  const auto path = scratch("misfit") / "posterior.nc";
  EXPECT_THROW(write_posterior(path, {{"posteriors", 1, 2, {}, {}}}, {}), ContractFailure);
  EXPECT_THROW(write_posterior(path, {{"posterior", 1, 2, {}, {{"rho", "", {}, {1, 2, 3}}}}}, {}), ContractFailure);
  EXPECT_THROW(write_posterior(path, {{"posterior", 1, 2, {}, {{"strain", "", {"time"}, {1, 2}}}}}, {}), ContractFailure);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(PosteriorFile, SummaryHasTheKeysThatOthersRead) {
  const auto r = some_draws();
  const Json j = posterior_json(assess(r.quantities), "few draws", r, {.stage = "sample"});
  ASSERT_EQ(j["parameters"].size(), 2u);
  EXPECT_EQ(j["parameters"][0]["name"], "density");
  for (const char* key : {"name", "mean", "sd", "q05", "q50", "q95", "r_hat", "ess_bulk", "ess_tail", "mcse_mean"})
    EXPECT_TRUE(j["parameters"][0].contains(key)) << key;
  EXPECT_FALSE(j["converged"].get<bool>());  // 20 draws
  EXPECT_EQ(j["message"], "few draws");
  EXPECT_EQ(j["sampler"]["kind"], "dram");
  EXPECT_EQ(j["sampler"]["acceptance"].size(), 4u);
  EXPECT_EQ(j["provenance"]["stage"], "sample");
}
