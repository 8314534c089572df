// posterior.nc is opened by xarray, group by group, with the dimensions chain and draw first, as ArviZ expects them.
#include <gmock/gmock.h>

#include "base/json.hpp"
#include "base/provenance.hpp"
#include "tests/command_output.hpp"
#include "tests/scratch.hpp"
#include "tests/verification/reference_scores.hpp"
#include "uq/posterior_file.hpp"

namespace calomel::testing {
namespace {

/// Draws of eight schools by nuts, with every group that a posterior.nc may have.
std::filesystem::path written() {
  const auto data = Json::parse(R"({"y": [28, 8, -3, 7, -1, 1, 18, 12], "sigma": [15, 10, 16, 11, 9, 11, 10, 18]})");
  const auto& p = reference_posterior("eight_schools");
  const auto density = p.make(data, Jacobian::kept);
  const auto r = run_sampler(*density, start_of(p), {.kind = "nuts", .warmup = 100, .draws = 50, .thin = 1}, {.seed = 1});
  auto groups = posterior_groups({}, r);
  const std::vector<PosteriorCoordinate> schools{{"school", "", {}, {"A", "B", "C", "D", "E", "F", "G", "H"}}};
  const std::size_t n = r.quantities.chains * r.quantities.draws;
  std::vector<double> theta;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < 8; ++j) theta.push_back(r.quantities.values[10 * i + 2 + j]);
  for (const std::string name : {"log_likelihood", "posterior_predictive"})
    groups.push_back({name, r.quantities.chains, r.quantities.draws, schools, {{"y", "", {"school"}, theta}}});
  groups.push_back({"prior", 1, 3, {}, {{"mu", "", {}, {1, 2, 3}}}});
  groups.push_back({"observed_data", 0, 0, schools, {{"y", "", {"school"}, data["y"].get<std::vector<double>>()}}});
  const auto path = scratch("xarray") / "posterior.nc";
  write_posterior(path, groups, {.stage = "sample"});
  return path;
}

/// Opens every group of the file and reports errors; with `turned`, chain and draw are exchanged first.
const char* const script =
    "import sys, netCDF4, xarray\n"
    "path, turned = sys.argv[1], sys.argv[2] == 'turned'\n"
    "for g in netCDF4.Dataset(path).groups:\n"
    "  d = xarray.open_dataset(path, group=g)\n"
    "  if turned and 'chain' in d.dims: d = d.transpose('draw', 'chain', ...)\n"
    "  print(g, dict(d.sizes), len(d.data_vars))\n"
    "  assert len(d.data_vars) > 0 and set(d.coords) == set(d.dims), g\n"
    "  for name, v in d.data_vars.items():\n"
    "    assert v.dims[:2] == ('chain', 'draw') if g != 'observed_data' else 'chain' not in v.dims, (g, name, v.dims)\n"
    "    assert bool((v == v).all()), (g, name)\n";

TEST(PosteriorFile, OpensInXarrayGroupByGroupWithChainAndDrawFirst) {
  const std::string python3 = python_with_xarray();
  ASSERT_NE(python3, "") << no_xarray;
  const auto path = written();
  const auto command = [&](const std::string& how) { return python3 + " -c \"" + script + "\" '" + path.string() + "' " + how; };
  const auto [text, well] = output_of(command("as_it_is"));
  EXPECT_TRUE(well) << text;
  EXPECT_EQ(text,
            "posterior {'chain': 4, 'draw': 50} 10\nunconstrained_posterior {'chain': 4, 'draw': 50} 10\nsample_stats {'chain': 4, 'draw': 50} 5\n"
            "log_likelihood {'chain': 4, 'draw': 50, 'school': 8} 1\nposterior_predictive {'chain': 4, 'draw': 50, 'school': 8} 1\nprior {'chain': 1, 'draw': "
            "3} 1\nobserved_data {'school': 8} 1\n");
  const auto [complaint, turned_well] = output_of(command("turned"));
  EXPECT_FALSE(turned_well);
  EXPECT_THAT(complaint, ::testing::HasSubstr("('draw', 'chain')"));
}

}  // namespace
}  // namespace calomel::testing
