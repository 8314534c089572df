#include "forward/surrogate/lasso.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "base/errors.hpp"
#include "base/linear_algebra.hpp"
#include "base/random.hpp"

using namespace calomel;

namespace {

struct Data {
  Eigen::MatrixXd A;
  Eigen::VectorXd b;
};

/// The problems of lasso_reference.py.
Data reference_problem(const std::string& kind, Eigen::Index rows, Eigen::Index columns) {
  Data p{Eigen::MatrixXd(rows, columns), Eigen::VectorXd(rows)};
  for (Eigen::Index r = 0; r < rows; ++r) {
    const double i = double(r + 1);
    for (Eigen::Index c = 0; c < columns; ++c) {
      const double j = double(c + 1), a = std::cos(0.37 * i * j + 0.11 * j * j);
      p.A(r, c) = kind == "correlated" ? 0.05 * a + std::cos(0.2 * i + 0.01 * j) : a;
    }
    p.b[r] = 3 + std::sin(0.21 * i) + 0.5 * std::cos(1.3 * i * i);
  }
  return p;
}

Data with_ones(const Data& p) {
  Data q{Eigen::MatrixXd::Ones(p.A.rows(), p.A.cols() + 1), p.b};
  q.A.rightCols(p.A.cols()) = p.A;
  return q;
}

/// A sparse truth, observed through random rows with noise.
Data random_problem(Eigen::Index rows, Eigen::Index columns, Eigen::VectorXd& truth, std::uint64_t seed) {
  RandomStream random(seed, 0);
  Data p{Eigen::MatrixXd(rows, columns), Eigen::VectorXd(rows)};
  p.A = Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random.normal(); });
  truth = Eigen::VectorXd::Zero(columns);
  for (Eigen::Index j = 0; j < 8; ++j) truth[j * columns / 8] = double(j % 2 == 0 ? 2 + j : -2 - j);
  p.b = p.A * truth + 0.05 * Eigen::VectorXd::NullaryExpr(rows, [&] { return random.normal(); });
  return p;
}

double objective(const Data& p, const Eigen::VectorXd& z, double lambda, Eigen::Index free = -1) {
  const double norm = z.cwiseAbs().sum() - (free >= 0 ? std::abs(z[free]) : 0);
  return (p.A * z - p.b).squaredNorm() + lambda * norm;
}

/// Standard output of a command; empty when it fails.
std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen((command + " 2>/dev/null").c_str(), "r");
  if (!pipe) return {};
  std::array<char, 4096> buffer;
  while (const auto n = std::fread(buffer.data(), 1, buffer.size(), pipe)) text.append(buffer.data(), n);
  return pclose(pipe) == 0 ? text : std::string();
}

const std::string folder = CALOMEL_SOURCE_DIR "/tests/unit/forward/surrogate/";

/// Compares our optimal values with a table of lasso_reference.py and returns the number of rows.
int compare(const std::string& table) {
  std::istringstream in(table);
  std::string line;
  std::getline(in, line);
  int rows = 0;
  for (; std::getline(in, line); ++rows) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream row(line);
    std::string kind;
    Eigen::Index n = 0, m = 0;
    int intercept = 0;
    double lambda = 0, theirs = 0;
    row >> kind >> n >> m >> intercept >> lambda >> theirs;
    Data p = reference_problem(kind, n, m);
    if (intercept) p = with_ones(p);
    const Lasso lasso(p.A, p.b, intercept ? 0 : -1);
    const auto fit = lasso.solve(lambda);
    EXPECT_NEAR(fit.objective / theirs, 1, 1e-8) << line;
    EXPECT_NEAR(objective(p, fit.z, lambda, intercept ? 0 : -1) / theirs, 1, 1e-8) << line;
  }
  return rows;
}

}  // namespace

TEST(Lasso, AgreesWithTheStoredOptimaOfScikitLearn) {
  std::ifstream file(folder + "lasso_reference.csv");
  std::stringstream table;
  table << file.rdbuf();
  EXPECT_EQ(compare(table.str()), 36);
}

TEST(Lasso, AgreesWithScikitLearnWhereItIsInstalled) {
  for (const std::string python : {"python3", "/usr/bin/python3"})
    if (const auto table = output_of(python + " " + folder + "lasso_reference.py"); !table.empty()) {
      EXPECT_EQ(compare(table), 36);
      return;
    }
  GTEST_SKIP() << "absent: scikit-learn for python3 (Debian's python3-sklearn)";
}

TEST(Lasso, FulfilsTheOptimalityConditions) {
  Eigen::VectorXd truth;
  const Data p = random_problem(80, 300, truth, 1);
  const Lasso lasso(p.A, p.b);
  for (const double share : {0.7, 0.1, 0.01, 0.001}) {
    const double lambda = share * lasso.lambda_max();
    const auto fit = lasso.solve(lambda);
    EXPECT_LE(fit.gap, 1e-10);
    const Eigen::VectorXd g = 2 * p.A.transpose() * (p.b - p.A * fit.z);
    for (Eigen::Index j = 0; j < g.size(); ++j) {
      if (fit.z[j] == 0)
        EXPECT_LE(std::abs(g[j]), lambda * (1 + 1e-6));
      else
        EXPECT_NEAR(g[j], std::copysign(lambda, fit.z[j]), 1e-5 * lambda);
    }
    // Negative control: a step along any coordinate increases the objective.
    for (Eigen::Index j = 0; j < 300; j += 37) {
      Eigen::VectorXd z = fit.z;
      z[j] += 1e-3;
      EXPECT_GT(objective(p, z, lambda), fit.objective);
    }
  }
}

TEST(Lasso, FindsASparseTruthFromFewRows) {
  Eigen::VectorXd truth;
  const Data p = random_problem(80, 300, truth, 2);
  const Lasso lasso(p.A, p.b);
  const auto fit = lasso.solve(0.01 * lasso.lambda_max());
  EXPECT_LT((fit.z - truth).norm() / truth.norm(), 0.05);
  const Eigen::VectorXd least_norm = p.A.transpose() * solve_symmetric(p.A * p.A.transpose(), p.b);
  EXPECT_GT((least_norm - truth).norm() / truth.norm(), 0.5);  // negative control
}

TEST(Lasso, APathEndsWhereSingleSolutionsDo) {
  Eigen::VectorXd truth;
  const Data p = random_problem(60, 150, truth, 3);
  const Lasso lasso(p.A, p.b);
  const auto lambdas = descending(lasso.lambda_max(), 1e-4 * lasso.lambda_max(), 30);
  EXPECT_NEAR(lambdas.back(), 1e-4 * lasso.lambda_max(), 1e-12 * lasso.lambda_max());
  const auto path = lasso.path(lambdas);
  ASSERT_EQ(path.size(), 30u);
  EXPECT_TRUE(path[0].all_zero());
  for (std::size_t i = 1; i < path.size(); ++i) {
    EXPECT_FALSE(path[i].all_zero());
    EXPECT_LT(path[i].objective, path[i - 1].objective);  // the optimum falls with lambda
    EXPECT_NEAR(path[i].objective / lasso.solve(lambdas[i]).objective, 1, 1e-9);
  }
  EXPECT_THROW((void)lasso.path(std::array{1.0, 2.0}), ContractFailure);
}

TEST(Lasso, TheInterceptIsFreeOfPenalty) {
  Eigen::VectorXd truth;
  Data p = random_problem(60, 100, truth, 4);
  p.b.array() += 1000;
  const Data q = with_ones(p);
  const Lasso free(q.A, q.b, 0), paid(q.A, q.b);
  const double lambda = 2 * free.lambda_max();
  const auto fit = free.solve(lambda);
  EXPECT_TRUE(fit.all_zero());
  EXPECT_NEAR(fit.z[0], p.b.mean(), 1e-9);
  EXPECT_LT(std::abs(paid.solve(lambda).z[0]), p.b.mean() - 1);
  EXPECT_GT(paid.lambda_max(), free.lambda_max());
}
