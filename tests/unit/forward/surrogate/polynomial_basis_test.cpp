#include "forward/surrogate/polynomial_basis.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <set>

#include "base/random.hpp"

using namespace calomel;

namespace {

Eigen::MatrixXd random_points(Eigen::Index d, Eigen::Index n, std::uint64_t seed) {
  RandomStream random(seed, 0);
  return Eigen::MatrixXd::NullaryExpr(d, n, [&] { return random.uniform(); });
}

}  // namespace

TEST(PolynomialBasis, IsOrthonormalUnderTheChebyshevMeasure) {
  // Gauss-Chebyshev quadrature with n nodes is exact to degree 2 n - 1: 16 nodes for products of two polynomials of degree 15.
  constexpr Eigen::Index n = 16;
  Eigen::MatrixXd nodes(2, n * n);
  const auto node = [](Eigen::Index i) { return 0.5 + 0.5 * std::cos(std::numbers::pi * (double(i) + 0.5) / double(n)); };
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) nodes.col(i * n + j) << node(i), node(j);
  for (const char* kind : {"total_degree", "tensor_product", "hyperbolic_cross", "sparse_grid"}) {
    const auto degrees = PolynomialSpace{kind, std::string(kind) == "sparse_grid" ? 3 : 15}.degrees(2);
    const Eigen::MatrixXd a = basis_matrix(degrees, nodes);
    const Eigen::MatrixXd gram = a.transpose() * a / double(n * n);
    EXPECT_LT((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff(), 1e-12) << kind;
  }
  // Negative control: uniform nodes do not follow that measure.
  const Eigen::MatrixXd a = basis_matrix(PolynomialSpace{"total_degree", 3}.degrees(2), random_points(2, 20000, 1));
  EXPECT_GT((a.transpose() * a / 20000.0 - Eigen::MatrixXd::Identity(10, 10)).cwiseAbs().maxCoeff(), 0.2);
}

TEST(PolynomialBasis, HasThePublishedNumbersOfTerms) {
  // The published method reports 286 to 1330 degrees of freedom in total degree 10 to 18, and 216 to 1728 in tensor products 5 to 11.
  EXPECT_EQ(PolynomialSpace({"total_degree", 10}).terms(3, 100000), 286u);
  EXPECT_EQ(PolynomialSpace({"total_degree", 18}).degrees(3).cols(), 1330);
  EXPECT_EQ(PolynomialSpace({"tensor_product", 5}).terms(3, 100000), 216u);
  EXPECT_EQ(PolynomialSpace({"tensor_product", 11}).degrees(3).cols(), 1728);
  EXPECT_EQ(PolynomialSpace({"tensor_product", 11}).terms(8, 5000), 5000u);  // the count stops there
  const auto cross = PolynomialSpace{"hyperbolic_cross", 3}.degrees(2);      // (i+1)(j+1) <= 4
  EXPECT_EQ(cross.cols(), 8);
  EXPECT_EQ(cross.col(0), Eigen::Vector2i(0, 0));
}

TEST(SparseGridSpace, HasAsManyTermsAsTheSparseGridHasNodes) {
  // Numbers of nodes of the Clenshaw-Curtis sparse grids of levels 0, 1, 2, ..., as tabulated since Novak and Ritter (1996).
  const auto sizes = [](std::size_t d, int levels) {
    std::vector<std::size_t> n;
    for (int l = 0; l <= levels; ++l) n.push_back(PolynomialSpace{"sparse_grid", l}.terms(d, 1000000));
    return n;
  };
  EXPECT_EQ(sizes(1, 5), (std::vector<std::size_t>{1, 3, 5, 9, 17, 33}));
  EXPECT_EQ(sizes(2, 6), (std::vector<std::size_t>{1, 5, 13, 29, 65, 145, 321}));
  EXPECT_EQ(sizes(3, 7), (std::vector<std::size_t>{1, 7, 25, 69, 177, 441, 1073, 2561}));
  EXPECT_EQ(sizes(10, 4), (std::vector<std::size_t>{1, 21, 221, 1581, 8801}));
  // In closed form a level of one dimension adds 1, 2, 2, 4, 8, ... degrees; the number of terms is the sum of their products over |l|_1 <= L.
  for (std::size_t d = 1; d <= 6; ++d) {
    std::vector<std::size_t> by_level{1, 0, 0, 0, 0};
    for (std::size_t k = 0; k < d; ++k) {
      std::vector<std::size_t> more(5, 0);
      for (std::size_t l = 0; l < 5; ++l)
        for (std::size_t m = 0; l + m < 5; ++m) more[l + m] += by_level[l] * (m == 0 ? 1 : m == 1 ? 2 : std::size_t(1) << (m - 1));
      by_level = more;
    }
    std::size_t all = 0;
    for (int l = 0; l < 5; ++l) EXPECT_EQ(PolynomialSpace({"sparse_grid", l}).terms(d, 1000000), all += by_level[std::size_t(l)]) << d << ' ' << l;
  }
}

TEST(SparseGridSpace, IsTheUnionOfItsBoxesAndClosedDownwards) {
  const auto reach = [](int level) { return level == 0 ? 0 : 1 << level; };
  std::set<std::vector<int>> boxes;
  for (int a = 0; a <= 4; ++a)
    for (int b = 0; a + b <= 4; ++b)
      for (int c = 0; a + b + c <= 4; ++c)
        for (int i = 0; i <= reach(a); ++i)
          for (int j = 0; j <= reach(b); ++j)
            for (int k = 0; k <= reach(c); ++k) boxes.insert({i, j, k});
  const auto degrees = PolynomialSpace{"sparse_grid", 4}.degrees(3);
  std::set<std::vector<int>> space;
  for (Eigen::Index t = 0; t < degrees.cols(); ++t) space.insert({degrees(0, t), degrees(1, t), degrees(2, t)});
  EXPECT_EQ(space, boxes);
  EXPECT_EQ(Eigen::Index(space.size()), degrees.cols());  // every product occurs once
  EXPECT_EQ(degrees.col(0), Eigen::Vector3i(0, 0, 0));
  for (const auto& product : space)
    for (std::size_t k = 0; k < 3; ++k) {
      auto below = product;
      EXPECT_TRUE(below[k]-- == 0 || space.contains(below)) << product[0] << ' ' << product[1] << ' ' << product[2];
    }
  EXPECT_TRUE(space.contains({0, 16, 0}) && space.contains({8, 0, 2}) && space.contains({4, 2, 2}));
  EXPECT_FALSE(space.contains({17, 0, 0}) || space.contains({9, 2, 0}) || space.contains({4, 4, 1}));
}

TEST(Expansion, IsTheSumOfItsTerms) {
  for (const Eigen::Index d : {1, 2, 3, 5}) {
    const auto degrees = PolynomialSpace{"total_degree", d == 5 ? 4 : 9}.degrees(std::size_t(d));
    RandomStream random(3, std::uint64_t(d));
    Eigen::VectorXd c = Eigen::VectorXd::NullaryExpr(degrees.cols(), [&] { return random.uniform() < 0.4 ? random.normal() : 0.0; });
    const auto units = random_points(d, 37, 4);  // not a multiple of the block
    const Expansion f(degrees, c);
    EXPECT_EQ(f.terms(), std::size_t((c.array() != 0).count()));
    Eigen::VectorXd values(37);
    f.evaluate(units, {values.data(), 37});
    EXPECT_LT((values - basis_matrix(degrees, units) * c).cwiseAbs().maxCoeff(), 1e-12 * c.cwiseAbs().sum());
  }
}

TEST(Expansion, GradientIsThatOfDifferences) {
  const auto degrees = PolynomialSpace{"tensor_product", 6}.degrees(3);
  RandomStream random(5, 0);
  const Eigen::VectorXd c = Eigen::VectorXd::NullaryExpr(degrees.cols(), [&] { return random.uniform() < 0.3 ? random.normal() : 0.0; });
  const Expansion f(degrees, c);
  const Eigen::MatrixXd units = random_points(3, 21, 6) * 0.9 + Eigen::MatrixXd::Constant(3, 21, 0.05);
  Eigen::VectorXd values(21), plain(21);
  Eigen::MatrixXd gradients;
  f.evaluate(units, {values.data(), 21}, gradients);
  f.evaluate(units, {plain.data(), 21});
  EXPECT_EQ(values, plain);
  constexpr double h = 1e-6;
  for (Eigen::Index k = 0; k < 3; ++k) {
    Eigen::MatrixXd up = units, down = units;
    up.row(k).array() += h;
    down.row(k).array() -= h;
    Eigen::VectorXd high(21), low(21);
    f.evaluate(up, {high.data(), 21});
    f.evaluate(down, {low.data(), 21});
    const Eigen::VectorXd slope = (high - low) / (2 * h);
    EXPECT_LT((slope - gradients.row(k).transpose()).cwiseAbs().maxCoeff(), 1e-5 * gradients.cwiseAbs().maxCoeff());
  }
}

TEST(Expansion, WithoutTermsIsZero) {
  const auto degrees = PolynomialSpace{"total_degree", 2}.degrees(2);
  const Expansion f(degrees, Eigen::VectorXd::Zero(degrees.cols()));
  std::vector<double> values(3, 7.0);
  f.evaluate(random_points(2, 3, 1), values);
  EXPECT_EQ(values, (std::vector<double>{0, 0, 0}));
}
