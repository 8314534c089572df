#include "inverse/posterior/model_posterior.hpp"

#include <gtest/gtest.h>

#include "uq/model_density.hpp"
#include "uq/sampler/modes.hpp"

namespace calomel {
namespace {

/// log density of a correlated normal, mean (1, -2), sd (1, 3), correlation 0.6.
class Normal : public ForwardModel {
 public:
  Normal() {
    for (const char* name : {"a", "b"}) {
      Parameter p{.name = name, .key = name, .min = -40, .max = 60};
      p.nominal = 10;
      shape_.parameters.push_back(p);
    }
    shape_.conditions = {"default"};
    shape_.sensors = {"log_density"};
    shape_.times = {0};
  }
  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] Prediction evaluate(std::span<const double> t) const override {
    if (t[0] > 55) return {.ok = false, .message = "too far"};
    const double x = t[0] - 1, y = (t[1] + 2) / 3;
    return {.mean = {-0.5 * (x * x - 1.2 * x * y + y * y) / 0.64}};
  }
  [[nodiscard]] bool has_gradient() const override { return true; }
  [[nodiscard]] Eigen::VectorXd vector_jacobian_product(std::span<const double> t, std::span<const double> w) const override {
    const double x = t[0] - 1, y = (t[1] + 2) / 3;
    return w[0] * Eigen::Vector2d(-(x - 0.6 * y) / 0.64, -(y - 0.6 * x) / 0.64 / 3);
  }

 private:
  ModelShape shape_;
};

TEST(ModelPosterior, CoordinatesTransformBothWaysWithinTheBounds) {
  const Normal model;
  const ModelPosterior posterior(model, std::nullopt);
  const auto back = posterior.theta(posterior.q(std::vector{3.0, -20.0}));
  EXPECT_NEAR(back[0], 3, 1e-10);
  EXPECT_NEAR(back[1], -20, 1e-10);
  for (const double far : {-800.0, 800.0}) {
    const auto edge = posterior.theta(Eigen::Vector2d(far, far));
    EXPECT_GE(edge[0], -40);
    EXPECT_LE(edge[0], 60);
    EXPECT_FALSE(std::isnan(posterior.log_density(Eigen::Vector2d(far, far))));
  }
}

TEST(ModelPosterior, GradientIsTheDerivativeOfTheDensity) {
  const Normal model;
  const ModelPosterior posterior(model, std::nullopt);
  const Eigen::Vector2d q(-0.3, 0.2);
  Eigen::VectorXd g;
  EXPECT_EQ(posterior.log_density(q, g), posterior.log_density(q));
  for (Eigen::Index k = 0; k < 2; ++k) {
    const Eigen::Vector2d step = 1e-5 * Eigen::Vector2d::Unit(k);
    EXPECT_NEAR(g[k], (posterior.log_density(q + step) - posterior.log_density(q - step)) / 2e-5, 1e-6 * std::abs(g[k]) + 1e-6);
  }
}

/// With the Jacobian of the transformation the density of q integrates to what the density of theta does; without it, it does not.
TEST(ModelPosterior, TheJacobianIsInIt) {
  const Normal model;
  const ModelPosterior posterior(model, std::nullopt);
  const double step = 0.01;
  double sum = 0, without = 0;
  for (double a = -4; a < 4; a += step)
    for (double b = -4; b < 4; b += step) {
      const Eigen::Vector2d q(a, b);
      const double d = posterior.log_density(q);
      sum += std::exp(d) * step * step;
      without += std::exp(d - posterior.scale(q).array().log().sum()) * step * step;
    }
  const double closed = 2 * M_PI * 3 * 0.8 / 1e4;  // over the uniform prior's area
  EXPECT_NEAR(sum / closed, 1, 1e-4);
  EXPECT_GT(std::abs(without / closed - 1), 0.5);
}

TEST(ModelPosterior, AFailedModelHasNoDensityAndIsCounted) {
  const Normal model;
  const ModelPosterior posterior(model, std::nullopt);
  EXPECT_TRUE(std::isinf(posterior.log_density(posterior.q(std::vector{59.0, 0.0}))));
  EXPECT_EQ(posterior.failed(), 1u);
}

TEST(ModelDensity, ItsModeIsTheDensitysTopWithItsCurvature) {
  const Normal model;
  const ModelPosterior posterior(model, std::nullopt);
  const auto modes = density_modes(ModelDensity(posterior), Eigen::MatrixXd(2, 0), posterior.q(std::vector{10.0, 10.0}), 1);
  ASSERT_EQ(modes.size(), 1u);
  const auto& mode = modes[0];
  const auto theta = posterior.theta(mode.x);
  EXPECT_NEAR(theta[0], 1, 0.1);  // the Jacobian moves the top of q's density by a little
  EXPECT_NEAR(theta[1], -2, 0.5);
  const Eigen::VectorXd scale = posterior.scale(mode.x);
  EXPECT_NEAR(std::sqrt(mode.covariance(0, 0)) * scale[0], 1, 0.05);
  EXPECT_NEAR(std::sqrt(mode.covariance(1, 1)) * scale[1], 3, 0.15);
}

}  // namespace
}  // namespace calomel
