// The meshes of an emulator: what mechanisms that a case does not have would do, against runs of cases that have them.
#include "forward/target/target_simulator.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "forward/mesh/make_mesh.hpp"
#include "forward/simulation/meshed_runs.hpp"
#include "forward/target/offered_groups.hpp"
#include "tests/unit/forward/target/small_case.hpp"
#include "tests/model_simulator.hpp"

namespace calomel {
namespace {

using testing::small_case_text;

Eigen::VectorXd mean_of(const std::string& more) {
  CaseFile file = CaseFile::from_text(small_case_text(more));
  const auto p = BuiltInModel(ForwardCase::read(file), {.pulses = 1}).evaluate({});
  EXPECT_TRUE(p.ok) << p.message;
  return Eigen::Map<const Eigen::VectorXd>(p.mean.data(), Eigen::Index(p.mean.size()));
}

/// Runs on the case's own mesh, at the case's regularising viscosity.
struct OwnMesh {
  explicit OwnMesh(const ForwardCase& c)
      : simulator(c, {.pulses = 1}), runs(simulator, 2), meshed(runs, {}, meshes_of({0}, {{viscosity_key, c.mercury.regularising_viscosity}})) {}
  TargetSimulator simulator;
  RunsInMemory runs;
  MeshedRuns meshed;
};

std::vector<MechanismDirections> of_case(const std::string& more) { return mechanism_directions(OwnMesh(testing::small_case(more)).meshed, {}); }

const MechanismDirections* find(const std::vector<MechanismDirections>& all, const std::string& name) {
  const auto at = std::find_if(all.begin(), all.end(), [&](const auto& l) { return l.name == name; });
  return at == all.end() ? nullptr : &*at;
}

Eigen::VectorXd column(const MechanismDirections& l, const std::string& key) {
  const auto at = std::find(l.keys.begin(), l.keys.end(), key);
  EXPECT_NE(at, l.keys.end()) << key;
  return l.directions.col(at - l.keys.begin());
}

TEST(TargetSimulator, DirectionsAreTheDifferencesOfCasesThatHaveTheMechanism) {
  const auto all = of_case("");
  const MechanismDirections* beam = find(all, "beam_profile");
  ASSERT_NE(beam, nullptr);
  const auto with = [](const std::string& line) { return mean_of("[mechanism.beam_profile]\nenabled = true\n" + line + "\n"); };
  const Eigen::VectorXd by_offset = (with("offset_z = 0.00125") - with("offset_z = -0.00125")) / 0.0025;
  ASSERT_GT(by_offset.norm(), 0);
  // The store keeps single precision.
  EXPECT_LT((column(*beam, "offset_z") - by_offset).norm(), 1e-5 * by_offset.norm());
  const MechanismDirections* viscous = find(all, "liquid_viscosity");
  ASSERT_NE(viscous, nullptr);
  const double zeta = 1 + 0.25 * 9999;  // one-sided: 0 is the least
  const Eigen::VectorXd by_zeta = (mean_of("[mechanism.liquid_viscosity]\nenabled = true\nzeta = " + std::to_string(zeta) + "\n") - mean_of("")) / zeta;
  EXPECT_LT((column(*viscous, "zeta") - by_zeta).norm(), 1e-5 * by_zeta.norm());
  const MechanismDirections* earlier = find(all, "previous_pulses");
  ASSERT_NE(earlier, nullptr);
  const auto left = [](const std::string& share) { return mean_of("[mechanism.previous_pulses]\nenabled = true\nleft_2 = " + share + "\n"); };
  const Eigen::VectorXd by_share = (left("0.1") - left("-0.1")) / 0.2;
  ASSERT_GT(by_share.norm(), 0);
  EXPECT_LT((column(*earlier, "left_2") - by_share).norm(), 1e-5 * by_share.norm());
}

// What acts on one wall goes through the store as any other number does: the run is that of the case that says so.
TEST(TargetSimulator, ANumberOfAWallIsTheCaseThatNamesTheWall) {
  const ForwardCase c = testing::small_case();
  const OwnMesh own(c);
  std::set<std::string> walls;
  for (const auto& g : offered_groups(c, make_mesh(c.geometry))) {
    if (g.name != "wall_thinning") continue;
    const Eigen::MatrixXd theta = Eigen::MatrixXd::Constant(1, 1, 0.2);
    const RunRecord r = own.meshed.get(theta, {0}, g.added)[0];
    const std::string wall = g.place.substr(0, g.place.find(','));
    if (wall == "rear" || wall == "side") {  // the mercury goes on there; a slice has none
      EXPECT_FALSE(r.done);
      continue;
    }
    std::string stretch;
    for (const auto& [key, value] : g.added[0].with)
      if (g.part && !key.ends_with(".wall")) stretch += key.substr(key.rfind('.') + 1) + " = " + number_text(value) + '\n';
    EXPECT_EQ(stretch.empty(), !g.part) << g.place;
    if (g.part && !r.done) {  // a corner, where no mercury wets the wall
      EXPECT_THAT(r.message, ::testing::HasSubstr("no wetted face"));
      continue;
    }
    ASSERT_TRUE(r.done) << g.place << ": " << r.message;
    const Eigen::VectorXd said = mean_of("[mechanism.wall_thinning]\nenabled = true\nfraction = 0.2\nwall = \"" + wall + "\"\n" + stretch);
    EXPECT_LT((r.history() - said).norm(), 1e-6 * said.norm()) << g.place;
    EXPECT_GT((r.history() - mean_of("")).norm(), 1e-3 * said.norm()) << g.place;
    walls.insert(g.place);
  }
  EXPECT_TRUE(walls.contains("top") && walls.contains("bottom"));
}

// A face's strength is a share of the cutoff: that of the run where it is a parameter, else the case's.
TEST(OfferedGroups, AStrengthIsAShareOfTheCutoff) {
  const ForwardCase c = testing::small_case();
  const auto groups = offered_groups(c, make_mesh(c.geometry));
  const auto face = std::find_if(groups.begin(), groups.end(), [](const auto& g) { return g.name == "interface" && g.part; });
  ASSERT_NE(face, groups.end());
  const AddedParameter& strength = face->added[0];
  EXPECT_EQ(strength.whole, c.mercury.tensile_cutoff);
  std::map<std::string, double> numbers, of_run{{"material.mercury.tensile_cutoff", 4e5}}, off;
  set_added(numbers, std::vector<double>{0.25}, std::vector<AddedParameter>{strength});
  set_added(of_run, std::vector<double>{0.25}, std::vector<AddedParameter>{strength});
  set_added(off, std::vector<double>{1.0}, std::vector<AddedParameter>{strength});
  EXPECT_DOUBLE_EQ(numbers.at("mechanism.interface.strength"), 0.25 * c.mercury.tensile_cutoff);
  EXPECT_DOUBLE_EQ(of_run.at("mechanism.interface.strength"), 1e5);
  EXPECT_TRUE(off.empty());
}

// Begin and end of a stretch are shapes: no stretch of a box's length can end before it begins, and one that is moved is the case's with those keys.
TEST(TargetSimulator, MovesTheEndsOfAStretch) {
  const ForwardCase c = testing::small_case();
  const OwnMesh own(c);
  int moved = 0;
  for (const auto& g : offered_groups(c, make_mesh(c.geometry))) {
    if (g.name != "wall_thinning" || !g.part) continue;
    ASSERT_EQ(g.shapes.size(), 2u);
    const Parameter &begin = g.shapes[0].parameter, &end = g.shapes[1].parameter;
    EXPECT_LE(begin.min, *begin.nominal);
    EXPECT_LT(*begin.nominal, begin.max);
    EXPECT_LT(begin.max, end.min);
    EXPECT_LT(end.min, *end.nominal);
    EXPECT_LE(*end.nominal, end.max);
    if (!g.place.starts_with("top, 15 ")) continue;
    std::vector<AddedParameter> all = g.added;
    all.insert(all.end(), g.shapes.begin(), g.shapes.end());
    const RunRecord r = own.meshed.get(Eigen::MatrixXd(Eigen::Vector3d(0.2, 0.0163, 0.0281)), {0}, all)[0];
    ASSERT_TRUE(r.done) << r.message;
    const Eigen::VectorXd said = mean_of("[mechanism.wall_thinning]\nenabled = true\nfraction = 0.2\nwall = \"top\"\nbegin = 0.0163\nend = 0.0281\n");
    EXPECT_LT((r.history() - said).norm(), 1e-6 * said.norm());
    ++moved;
  }
  EXPECT_EQ(moved, 1);
}

// A range is two standard deviations of a normal prior about off. A fit may leave it up to twice, as far as the law goes: a bound where the range ends would
// hold a number there.
TEST(OfferedGroups, MayLeaveTheirRangeAsFarAsTheLawGoes) {
  const auto groups = offered_groups(testing::small_case(), make_mesh(testing::small_case().geometry));
  const auto number = [&](const std::string& name) {
    for (const auto& g : groups)
      for (const auto& a : g.added)
        if (a.parameter.name == name) return a;
    throw InputError({.problem = "no number " + name});
  };
  const AddedParameter offset = number("beam_profile.offset_z"), pulse = number("beam_profile.pulse_length"), rear = number("rear_reflection.coefficient");
  EXPECT_EQ(offset.parameter.prior, "truncated_normal");
  EXPECT_DOUBLE_EQ(*offset.parameter.sd, 2.5e-3);
  EXPECT_DOUBLE_EQ(offset.parameter.min, -10e-3);
  EXPECT_DOUBLE_EQ(offset.parameter.max, 10e-3);
  EXPECT_DOUBLE_EQ(*pulse.parameter.mean, 0.7e-6);
  EXPECT_DOUBLE_EQ(*pulse.parameter.sd, 1.65e-6);  // half of the wider side
  EXPECT_EQ(pulse.parameter.min, 0);
  EXPECT_DOUBLE_EQ(pulse.parameter.max, 7.3e-6);
  EXPECT_EQ(rear.parameter.min, -1);
  EXPECT_EQ(rear.parameter.max, 1);
}

TEST(OfferedGroups, CarryTheWordsAndUnitsOfTheRegistry) {
  for (const auto& g : offered_groups(testing::small_case(), make_mesh(testing::small_case().geometry))) {
    EXPECT_FALSE(g.plain.empty() || g.check.empty()) << g.name;
    if (g.name == "beam_profile") {
      EXPECT_EQ(g.plain, mechanisms().get("beam_profile", "").plain);
    }
    for (const auto& a : g.added) {
      EXPECT_FALSE(a.doc.empty()) << a.parameter.name;
      if (a.parameter.name == "beam_profile.offset_z") {
        EXPECT_EQ(a.unit, "m");
      }
    }
    for (const auto& a : g.shapes) {
      EXPECT_FALSE(a.doc.empty()) << a.parameter.name;
      if (a.parameter.name == "bubbly_liquid.radius") {
        EXPECT_EQ(a.unit, "m");
      }
    }
  }
}

TEST(TargetSimulator, WhatIsEnabledOrCannotBeShownIsNotAmongThem) {
  const auto all = of_case("[mechanism.beam_profile]\nenabled = true\noffset_z = 0.001\n");
  EXPECT_EQ(find(all, "beam_profile"), nullptr);
  EXPECT_NE(find(all, "bubbly_liquid"), nullptr);
  const auto plain = of_case("");
  const MechanismDirections* beam = find(plain, "beam_profile");
  ASSERT_NE(beam, nullptr);
  EXPECT_EQ(std::count(beam->keys.begin(), beam->keys.end(), "offset_y"), 0);  // a slice has no sideways
  EXPECT_TRUE(find(plain, "sensor_response") && find(plain, "structural_damping"));
  // What a coarse mesh does too is what the registry says, of every one; nothing here knows a name.
  int like_the_mesh = 0;
  for (const auto& l : plain) {
    EXPECT_EQ(l.like_the_mesh, mechanisms().get(l.name, "").like_the_mesh) << l.name;
    EXPECT_LE(mechanisms().get(l.name, "").cost, 4) << l.name;
    like_the_mesh += l.like_the_mesh;
  }
  EXPECT_EQ(like_the_mesh, 4);
}

// One gauge that cannot be moved towards an edge does not take the others' errors of place with it.
TEST(TargetSimulator, AGaugeNearAnEdgeLeavesTheOthersTheirPlaces) {
  const auto places = [](const std::string& more) { return gauge_place_effects(OwnMesh(testing::small_case(more)).meshed, {}, 0.5e-3, 0); };
  const Eigen::MatrixXd alone = places(""),
                        with = places("[[sensor]]\nname = \"E\"\nposition = [0.0025, 0.0, 0.03]\ndirection = [1, 0, 0]\ngauge_length = 4e-3\n");
  ASSERT_EQ(alone.cols(), 2);
  ASSERT_EQ(with.cols(), 3);
  EXPECT_GT(alone.col(0).norm(), 0);  // the other sits where all is symmetric about it
  for (int s = 0; s < 2; ++s) EXPECT_EQ(with.col(s).head(alone.rows()), alone.col(s)) << s;
  EXPECT_GT(with.col(2).norm(), 0);  // to one side
}

}  // namespace
}  // namespace calomel
