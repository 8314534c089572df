#include "forward/mechanism/wall_thinning.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "base/json.hpp"
#include "forward/target/built_in_model.hpp"
#include "forward/mesh/deform_mesh.hpp"
#include "forward/mesh/make_mesh.hpp"
#include "forward/target/offered_groups.hpp"
#include "tests/unit/forward/target/small_case.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

namespace {

/// The box with 4 mm of top wall, thinned by the mechanism.
ForwardCase thinned(const std::string& thinning) { return ringing_box(0.004, "[mechanism.wall_thinning]\nenabled = true\n" + thinning); }

double frequency(const ForwardCase& c) {
  const BuiltInModel model(c, {.pulses = 1});
  const auto p = model.evaluate({});
  EXPECT_TRUE(p.ok) << p.message;
  return fitted_frequency(model.shape().times, p.mean, 1500, 9000);
}

InputError refused(const std::string& lines) {
  try {
    const BuiltInModel model(small_case("[mechanism.wall_thinning]\nenabled = true\n" + lines), {.pulses = 1});
  } catch (const InputError& e) {
    return e;
  }
  ADD_FAILURE() << "it should have been refused";
  return InputError(InputError::Parts{});
}

}  // namespace

// The wall rings like a wall that is made so thin. Thinning of another wall, of a stretch of it, or of less does not give that.
TEST(WallThinning, TheWallRingsAsAThinnerOne) {
  const double thin = frequency(ringing_box(0.0028)), by_mechanism = frequency(thinned("wall = \"top\"\nfraction = 0.3\n"));
  measured("thinned_over_thin", by_mechanism / thin);
  EXPECT_NEAR(by_mechanism, thin, 0.003 * thin);
  for (const char* other :
       {"wall = \"front\"\nfraction = 0.3\n", "wall = \"top\"\nfraction = 0.3\nbegin = 0.0\nend = 0.015\n", "wall = \"top\"\nfraction = 0.2\n"})
    EXPECT_GT(std::abs(frequency(thinned(other)) / thin - 1), 0.015) << other;
}

TEST(WallThinning, OnlyTheInsideOfTheStretchMoves) {
  const BuiltInModel base(small_case(), {.pulses = 1}),
      model(small_case("[mechanism.wall_thinning]\nenabled = true\nwall = \"bottom\"\nfraction = 0.4\nbegin = 0.02\nend = 0.04\n"), {.pulses = 1});
  double deepest = 0;
  for (const auto& p : model.mesh().slip) {
    const Vec3 &x = model.mesh().nodes[std::size_t(p.steel)], &was = base.mesh().nodes[std::size_t(p.steel)];
    // A node represents the wall for half an element on either side, and moves by the share of that length in the stretch.
    const double share = was[2] < 0.01 ? std::clamp((std::min(was[0] + 0.0015, 0.04) - std::max(was[0] - 0.0015, 0.02)) / 0.003, 0.0, 1.0) : 0;
    EXPECT_NEAR(was[2] - x[2], share * 0.4 * 0.003, 1e-12);
    EXPECT_EQ(x[0], was[0]);
    deepest = std::max(deepest, was[2] - x[2]);
  }
  EXPECT_NEAR(deepest, 0.0012, 1e-12);
  EXPECT_EQ(model.gauges()[0].placed, base.gauges()[0].placed);
}

TEST(WallThinning, AWallThatIsNotThereIsAnErrorWithItsPlace) {
  const InputError lid = refused("fraction = 0.1\nwall = \"lid\"\n");
  EXPECT_EQ(lid.parts().key, "mechanism.wall_thinning.wall");
  EXPECT_GT(lid.parts().line, 0);
  for (const char* name : {"lid", "front", "rear", "side", "top", "bottom"}) EXPECT_THAT(lid.what(), HasSubstr(name));
  EXPECT_EQ(refused("fraction = 0.1\nwall = 3\n").parts().key, "mechanism.wall_thinning.wall");
  EXPECT_EQ(refused("fraction = 0.1\nwall = \"rear\"\n").parts().key, "mechanism.wall_thinning.wall");  // a non-reflecting rear has no wall
  EXPECT_EQ(refused("fraction = 0.1\nwall = \"top\"\nbegin = 0.5\n").parts().key, "mechanism.wall_thinning.wall");
  EXPECT_EQ(refused("fraction = 0.1\nbegin = 0.02\nend = 0.01\n").parts().key, "mechanism.wall_thinning.end");
}

// A wall is a word and not a number: it is echoed as a word, and no parameter can change it.
TEST(WallThinning, TheWallIsNoParameter) {
  const std::string text = "[mechanism.wall_thinning]\nenabled = true\nwall = \"top\"\n";
  EXPECT_EQ(small_case(text).echo()["mechanism"]["wall_thinning"]["wall"], "top");
  EXPECT_THROW((void)small_case(text + "[parameter.w]\nkey = \"mechanism.wall_thinning.wall\"\nmin = 0\nmax = 1\n"), InputError);
  EXPECT_NO_THROW((void)small_case(text + "[parameter.w]\nkey = \"mechanism.wall_thinning.fraction\"\nmin = 0\nmax = 0.5\n"));
}

// The prior of a stretch prefers ends within the region that is searched first, and allows ends as far out as the wall reaches.
TEST(WallThinning, AStretchMayReachToTheEndsOfTheWall) {
  const ForwardCase c = small_case();
  std::size_t wholes = 0, parts = 0;
  for (const auto& g : offered_groups(c, make_mesh(c.geometry))) {
    if (g.name != "wall_thinning") continue;
    ++(g.part ? parts : wholes);
    ASSERT_EQ(g.shapes.size(), 2u);
    const Parameter &begin = g.shapes[0].parameter, &end = g.shapes[1].parameter;
    const double wall = *(g.place.starts_with("front") ? c.geometry.height : c.geometry.length), extent = *end.nominal - *begin.nominal;
    EXPECT_NEAR(extent, g.part ? wall / 4 : wall, 1e-12) << g.place;
    EXPECT_EQ(begin.min, 0) << g.place;
    EXPECT_EQ(end.max, wall) << g.place;
    EXPECT_NEAR(0.5 * (begin.max + end.min), 0.5 * (*begin.nominal + *end.nominal), 1e-12) << g.place;
    EXPECT_NEAR(end.min - begin.max, extent / (g.part ? 8 : 16), 1e-12) << g.place << ": shorter ones are beyond the mesh";
    for (const Parameter* p : {&begin, &end}) {
      EXPECT_EQ(*p->mean, *p->nominal) << g.place;
      EXPECT_NEAR(*p->sd, extent / (g.part ? 4 : 8), 1e-12) << g.place;
    }
  }
  EXPECT_EQ(wholes, 3u);
  EXPECT_EQ(parts, 3u * 7u);
}

// The ends of plates that reach the rear end do not belong to its wall.
TEST(WallThinning, LeavesTheEndsOfPlatesAlone) {
  GeometryOptions g;
  g.kind = "jet_flow";
  g.half = true;
  g.rear = "wall";
  g.element_size = 0.012;
  const Mesh before = make_mesh(g);
  Mesh after = before;
  thin_wall(after, {.wall = "rear", .fraction = 0.1, .begin = -1, .end = 1});
  const double end = std::max_element(before.nodes.begin(), before.nodes.end(), [](const Vec3& a, const Vec3& b) { return a[0] < b[0]; })->at(0);
  double most = 0, elsewhere = 0;
  for (const auto& pair : before.slip) {  // the steel moves, and the mercury follows
    const auto n = std::size_t(pair.steel);
    const double moved = std::abs(after.nodes[n][0] - before.nodes[n][0]);
    (before.nodes[n][0] > end - 0.02 ? most : elsewhere) = std::max(before.nodes[n][0] > end - 0.02 ? most : elsewhere, moved);
  }
  EXPECT_NEAR(most, 0.1 * 0.004, 1e-5);
  EXPECT_LE(elsewhere, most);  // the mercury beside it limits the movement; a tenth of a plate's length would turn elements inside out
}

// An end that the case does not set is the end of the wall. A parameter for it begins at the nearer of its bounds.
TEST(WallThinning, AnEndMayBeAParameterWithoutANominalValue) {
  const ForwardCase c = small_case(
      "[mechanism.wall_thinning]\nenabled = true\nwall = \"top\"\nfraction = 0.2\nend = 0.05\n[parameter.b]\nkey = \"mechanism.wall_thinning.begin\"\nmin = "
      "0\nmax = 0.02\n");
  EXPECT_EQ(*c.parameters[0].nominal, 0);
}

// ringing_box has a rear wall, and plane strain has no side walls.
TEST(WallThinning, IsOfferedOnTheWallsThatThereAre) {
  const auto walls = [](const ForwardCase& c) {
    std::set<std::string> names;
    for (const auto& g : offered_groups(c, make_mesh(c.geometry)))
      if (g.name == "wall_thinning") names.insert(g.place.substr(0, g.place.find(',')));
    return names;
  };
  EXPECT_THAT(walls(small_case()), ::testing::ElementsAre("bottom", "front", "top"));
  EXPECT_THAT(walls(ringing_box(0.004)), ::testing::ElementsAre("bottom", "front", "rear", "top"));
}
