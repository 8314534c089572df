// Tests the mesh correction on functions that the regression represents exactly, and its gradient against finite differences.
#include "forward/emulator/mesh_correction.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "forward/emulator/infill.hpp"

namespace calomel {
namespace {

const std::vector<Parameter> parameters{{.name = "rho", .min = 10, .max = 1000}, {.name = "s", .min = 0, .max = 9}, {.name = "eta", .min = 1, .max = 100}};
const EmulatorBox box(parameters, std::vector<double>{100, 2, 10}, std::vector<double>{400, 6, 40});

/// Four values over (rho, s, eta) on the finest mesh; the error of the coarse mesh is a linear function of the coordinates.
Eigen::Vector4d history(const Eigen::VectorXd& u, int level) {
  Eigen::Vector4d y(1 + u[0] * u[1], 2 - u[2] * u[2] + u[0], u[1] - 0.5 * u[0] * u[2], 3 * u[2]);
  if (level == 1) y += Eigen::Vector4d(0.3, 0.2 * u[0], -0.4 * u[1], 0.1 * u[2]);
  return y;
}

struct Trained {
  Trained() {
    const Eigen::MatrixXd u = first_design(3, 30, 5);
    EmulatorRuns runs{Eigen::MatrixXd(3, 40), {}, 2};
    histories.resize(4, 40);
    for (int i = 0; i < 40; ++i) {
      const int level = i < 30 ? 1 : 0;
      runs.u.col(i) = u.col(i % 30);
      runs.level.push_back(level);
      histories.col(i) = history(runs.u.col(i), level);
    }
    regression = MultilevelRegression(runs, histories, Eigen::Vector4d::Ones());
  }
  Eigen::MatrixXd histories;
  MultilevelRegression regression;
};

/// y_i = i rho + i^2 s with its gradient; fails above rho 390.
class Line final : public ForwardModel {
 public:
  Line() { shape_.parameters = {parameters[0], parameters[1]}, shape_.conditions = {"default"}, shape_.sensors = {"S"}, shape_.times = {0, 1, 2, 3}; }
  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override {
    if (theta[0] > 390) return {.ok = false, .message = "the step collapsed"};
    Prediction p;
    for (const double t : shape_.times) p.mean.push_back(t * theta[0] + t * t * theta[1]);
    return p;
  }
  [[nodiscard]] bool has_gradient() const override { return true; }
  [[nodiscard]] Eigen::VectorXd vector_jacobian_product(std::span<const double>, std::span<const double> w) const override {
    Eigen::Vector2d g = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < 4; ++i) g += w[i] * shape_.times[i] * Eigen::Vector2d(1, shape_.times[i]);
    return g;
  }
  [[nodiscard]] HistoryBasis basis() const override {
    HistoryBasis b{Eigen::Vector4f::Zero(), Eigen::MatrixXf(4, 2)};
    b.directions << 0, 0, 1, 1, 2, 4, 3, 9;
    return b;
  }
  [[nodiscard]] Eigen::MatrixXf coefficients(const Eigen::MatrixXd& thetas) const override {
    Eigen::MatrixXf c = thetas.cast<float>();
    for (Eigen::Index i = 0; i < c.cols(); ++i)
      if (c(0, i) > 390) c.col(i).setConstant(std::nanf(""));
    return c;
  }

 private:
  ModelShape shape_;
};

TEST(MeshCorrection, IsFinestLessWorkingWithTheNumbersOfEitherMesh) {
  const Trained t;
  const std::vector<double> theta{180, 4.5}, fine{180, 4.5, 20}, working{180, 4.5, 35};
  for (const int level : {0, 1}) {
    const MeshCorrection c(box, t.regression, t.histories, level, {20}, {35});
    EXPECT_FALSE(c.empty());
    EXPECT_EQ(c.runs(), 40);
    EXPECT_TRUE(c.inside(theta));
    EXPECT_LT((c.shift(theta) - (history(box.u(fine), 0) - history(box.u(working), level))).norm(), 1e-8) << level;
  }
  const MeshCorrection nothing(box, t.regression, t.histories, 0, {20}, {20});
  EXPECT_LT(nothing.shift(theta).norm(), 1e-12);
  EXPECT_TRUE(MeshCorrection().empty());
  EXPECT_THROW(MeshCorrection(box, t.regression, t.histories, 2, {20}, {20}), ContractFailure);
  EXPECT_THROW((void)nothing.shift(fine), ContractFailure);
}

TEST(MeshCorrection, OutsideTheBoxIsThatOfItsNearestPoint) {
  const Trained t;
  const MeshCorrection c(box, t.regression, t.histories, 1, {20}, {35});
  const std::vector<double> far{800, 4}, edge{400, 4};
  EXPECT_FALSE(c.inside(far));
  EXPECT_LT((c.shift(far) - c.shift(edge)).norm(), 1e-9);
  EXPECT_GT((c.shift(edge) - c.shift(std::vector<double>{200, 4})).norm(), 0.1);
  const std::vector<double> weights{1, 2, 3, 4};
  EXPECT_EQ(c.vector_jacobian_product(far, weights)[0], 0);
  EXPECT_NE(c.vector_jacobian_product(far, weights)[1], 0);
  EXPECT_FALSE(MeshCorrection(box, t.regression, t.histories, 1, {20}, {60}).inside(edge));  // not trained on the working mesh's viscosity
}

TEST(CorrectedModel, AddsTheShiftToOneAndToManyAndToTheSlope) {
  const Trained t;
  const Line line;
  const MeshCorrection c(box, t.regression, t.histories, 1, {20}, {35}), none;
  const CorrectedModel corrected(line, c), plain(line, none);
  const std::vector<double> at{180, 4.5};
  const Eigen::VectorXd shift = c.shift(at);
  const auto p = corrected.evaluate(at).mean, own = line.evaluate(at).mean;
  for (std::size_t i = 0; i < 4; ++i) EXPECT_DOUBLE_EQ(p[i], own[i] + shift[Eigen::Index(i)]);
  EXPECT_EQ(plain.evaluate(at).mean, own);
  EXPECT_FALSE(corrected.evaluate(std::vector<double>{395, 4}).ok);
  Eigen::MatrixXd thetas(2, 2);
  thetas << 180, 395, 4.5, 4;
  const Eigen::MatrixXf y = corrected.means(thetas, 1);
  const HistoryBasis basis = corrected.basis();
  const Eigen::MatrixXf by_basis = (basis.directions * corrected.coefficients(thetas)).colwise() + basis.offset;
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_NEAR(y(i, 0), p[std::size_t(i)], 1e-4);
    EXPECT_NEAR(by_basis(i, 0), p[std::size_t(i)], 1e-4);
  }
  EXPECT_TRUE(y.col(1).hasNaN() && by_basis.col(1).hasNaN());  // where the model fails
  EXPECT_EQ(plain.basis().directions.cols(), 2);
  // The gradient agrees with central differences. Without the gradient of the shift it does not.
  const std::vector<double> weights{3, -10, 4, 0.5};
  const Eigen::VectorXd g = corrected.vector_jacobian_product(at, weights);
  for (std::size_t k = 0; k < 2; ++k) {
    auto up = at, down = at;
    const double h = 1e-5 * at[k];
    up[k] += h;
    down[k] -= h;
    double slope = 0;
    for (std::size_t i = 0; i < 4; ++i) slope += weights[i] * (corrected.evaluate(up).mean[i] - corrected.evaluate(down).mean[i]) / (2 * h);
    EXPECT_NEAR(g[Eigen::Index(k)], slope, 1e-6 * (1 + std::abs(slope)));
    EXPECT_GT(std::abs(line.vector_jacobian_product(at, weights)[Eigen::Index(k)] - slope), 1e-4);
  }
  EXPECT_EQ(plain.vector_jacobian_product(at, weights), line.vector_jacobian_product(at, weights));
}

}  // namespace
}  // namespace calomel
