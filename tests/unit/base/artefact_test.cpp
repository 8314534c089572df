#include "base/artefact.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

#include "base/identity.hpp"
#include "base/netcdf_file.hpp"
#include "base/provenance.hpp"
#include "tests/scratch.hpp"

using namespace calomel;

TEST(Artefact, IdentityFollowsOptionsSeedAndInputs) {
  Provenance a{.stage = "campaign", .options = {{"runs", 3}}, .seed = 1, .inputs = {{"case", "x"}}};
  Provenance b = a;
  EXPECT_EQ(a.identity(), b.identity());
  b.options["runs"] = 4;
  EXPECT_NE(a.identity(), b.identity());
  b = a;
  b.seed = 2;
  EXPECT_NE(a.identity(), b.identity());
  b = a;
  b.inputs["case"] = "y";
  EXPECT_NE(a.identity(), b.identity());
}

TEST(Artefact, ReuseNamesTheChangedKey) {
  const auto dir = scratch("reuse");
  Provenance p{.stage = "campaign", .options = {{"load", {{"peak_pressure", 1e7}}}}};
  EXPECT_EQ(reusable(dir / "campaign.json", p), Reuse::nothing_there);
  write_json(dir / "campaign.json", {{"provenance", p.json()}});
  EXPECT_EQ(reusable(dir / "campaign.json", p), Reuse::matches);
  p.options["load"]["peak_pressure"] = 2e7;
  try {
    (void)reusable(dir / "campaign.json", p);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("load.peak_pressure"));
    EXPECT_THAT(e.what(), testing::HasSubstr("--fresh"));
  }
}

// Older archives have solver.booking in every identity. They are still read; where the option decides what is written, it still counts.
TEST(Artefact, TheOldNameOfTheEnergyBalanceIsNoOtherSetting) {
  const auto dir = scratch("older");
  for (const char* stage : {"campaign", "simulate"}) {
    Provenance before{.stage = stage, .options = {{"solver", {{"precision", "double"}, {"booking", true}}}}, .seed = 3, .inputs = {{"sensors", "x"}}};
    Provenance now = before;
    now.options["solver"].erase("booking");
    write_json(dir / "old.json", {{"provenance", before.json()}});
    const bool counts = before.stage == "simulate";
    EXPECT_EQ(identity_of(before.json()) == now.identity(), !counts);
    if (counts)
      EXPECT_THROW((void)reusable(dir / "old.json", now), InputError);
    else
      EXPECT_EQ(reusable(dir / "old.json", now), Reuse::matches);
    now.options["solver"]["precision"] = "single";
    try {
      (void)reusable(dir / "old.json", now);
      ADD_FAILURE() << "another precision is another artefact";
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), testing::HasSubstr("solver.precision"));
      EXPECT_EQ(std::string(e.what()).find("booking") == std::string::npos, !counts);
    }
  }
}

// The interval between saved states, which was part of every identity once, does not matter either.
TEST(Artefact, CheckpointOfAnOlderArtefactIsNoOtherSetting) {
  for (const char* stage : {"campaign", "simulate"}) {
    const Provenance now{.stage = stage, .options = {{"solver", {{"precision", "double"}}}}, .seed = 3, .inputs = {}};
    Provenance before = now;
    before.options["solver"]["checkpoint"] = 60.0;
    EXPECT_NE(before.identity(), now.identity());
    EXPECT_EQ(identity_of(before.json()), now.identity());
    before.options["solver"]["precision"] = "single";
    EXPECT_NE(identity_of(before.json()), now.identity());
  }
}

TEST(Artefact, SetAsideNeverDeletes) {
  const auto dir = scratch("aside");
  write_atomically(dir / "a.json", "1");
  set_aside(dir / "a.json");
  write_atomically(dir / "a.json", "2");
  set_aside(dir / "a.json");
  EXPECT_EQ(read_text(dir / "a.json.old-1"), "1");
  EXPECT_EQ(read_text(dir / "a.json.old-2"), "2");
}

TEST(Artefact, NanInJsonIsOurDefect) { EXPECT_THROW(write_json(scratch("nan") / "x.json", {{"x", std::nan("")}}), ContractFailure); }

TEST(NetcdfFile, RoundTrip) {
  const auto path = scratch("netcdf") / "a.nc";
  {
    NetcdfWriter w(path);
    w.dimension("sensor", 2);
    w.dimension("time", 3);
    const std::vector<double> strain{1, 2, 3, 4, std::nan(""), 6};
    w.variable("strain", {"sensor", "time"}, strain, {{"units", "1"}});
    const std::vector<std::string> names{"A", "B"};
    w.variable("sensor", {"sensor"}, names);
    const std::vector<int> status{0, 1};
    const std::vector<std::string> meanings{"done", "failed"};
    w.flags("status", {"sensor"}, status, meanings);
    w.attribute("title", "test");
    EXPECT_FALSE(std::filesystem::exists(path));  // no file exists before the commit
    w.commit();
  }
  const NetcdfReader r(path);
  EXPECT_EQ(r.shape("strain"), (std::vector<std::size_t>{2, 3}));
  EXPECT_EQ(r.doubles("strain")[3], 4);
  EXPECT_TRUE(std::isnan(r.doubles("strain")[4]));
  EXPECT_EQ(r.strings("sensor"), (std::vector<std::string>{"A", "B"}));
  EXPECT_EQ(r.integers("status"), (std::vector<int>{0, 1}));
  EXPECT_EQ(r.attribute("units", "strain"), "1");
  EXPECT_EQ(r.attribute("flag_meanings", "status"), "done failed");
  EXPECT_THROW((void)r.doubles("stress"), InputError);
  EXPECT_THROW(NetcdfReader("/nowhere.nc"), InputError);
}
