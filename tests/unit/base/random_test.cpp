#include "base/random.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "base/parallel.hpp"
#include "base/registry.hpp"

using namespace calomel;

TEST(RandomStream, DependsOnSeedAndIndexAlone) {
  RandomStream a(1, 5), b(1, 5), c(1, 6), d(2, 5);
  const auto x = a();
  EXPECT_EQ(x, b());
  EXPECT_NE(x, c());
  EXPECT_NE(x, d());
}

// Mean and variance of 1e5 normal numbers. The standard errors are 0.0032 and 0.0045; the bounds are 4 standard errors.
TEST(RandomStream, NormalHasUnitVariance) {
  RandomStream s(3, 0);
  double sum = 0, squares = 0;
  const int n = 100000;
  for (int i = 0; i < n; ++i) {
    const double x = s.normal();
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / n, 0, 0.0127);
  EXPECT_NEAR(squares / n, 1, 0.018);
}

TEST(RandomStream, PermutationHoldsEveryIndexOnce) {
  RandomStream s(3, 1);
  auto p = s.permutation(100);
  std::sort(p.begin(), p.end());
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(p[i], i);
}

TEST(ParallelFor, VisitsEveryIndexOnceAndRethrows) {
  std::vector<int> seen(1000);
  parallel_for(seen.size(), 4, [&](std::size_t i) { ++seen[i]; });
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), 1000);
  EXPECT_THROW(parallel_for(10, 2,
                            [](std::size_t i) {
                              if (i == 3) throw InputError({.problem = "x"});
                            }),
               InputError);
}

TEST(Registry, UnknownNameListsTheKnown) {
  Registry<int> r("law");
  r.add("riemer", "", 1).add("linear", "", 2);
  EXPECT_EQ(r.get("linear"), 2);
  try {
    (void)r.get("reimer", "material.mercury.law");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("did you mean \"riemer\"?"), std::string::npos);
    EXPECT_NE(std::string(e.what()).find("linear"), std::string::npos);
  }
}
