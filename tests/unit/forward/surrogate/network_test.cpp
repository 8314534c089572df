#include "forward/surrogate/network.hpp"

#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "forward/surrogate/network_training.hpp"

using namespace calomel;

namespace {

using Matrix = Network<double>::Matrix;

Matrix random_matrix(Eigen::Index rows, Eigen::Index columns, std::uint64_t index) {
  RandomStream random(11, index);
  Matrix m(rows, columns);
  for (Eigen::Index i = 0; i < m.size(); ++i) m.data()[i] = random.normal();
  return m;
}

/// sum of squared errors / 2
double half_squares(const Network<double>& network, const Matrix& x, const Matrix& y) { return 0.5 * (network.forward(x) - y).squaredNorm(); }

}  // namespace

class NetworkGradient : public testing::TestWithParam<Activation> {};

TEST_P(NetworkGradient, AgreesWithCentralDifferencesInWeightsAndInputs) {
  RandomStream random(5, 0);
  Network<double> network({3, 7, 5, 4}, GetParam(), random);
  for (auto& layer : network.layers()) layer.b = random_matrix(layer.b.size(), 1, 9).col(0) * 0.3;
  Matrix x = random_matrix(3, 6, 1);
  const Matrix y = random_matrix(4, 6, 2);
  Network<double>::Tape tape;
  const Matrix h = network.hidden(x, tape);
  Matrix out(4, 6);
  network.output_rows(h, 0, 4, out);
  ASSERT_LT((out - network.forward(x)).norm(), 1e-13);
  std::vector<DenseLayer<double>> gradient;
  const Matrix dx = network.backward(tape, out - y, &gradient);
  const double step = 1e-5;
  const auto difference = [&](double& number) {
    const double kept = number;
    number = kept + step;
    const double up = half_squares(network, x, y);
    number = kept - step;
    const double down = half_squares(network, x, y);
    number = kept;
    return (up - down) / (2 * step);
  };
  double worst = 0, size = 0;
  for (std::size_t l = 0; l < network.layers().size(); ++l) {
    auto& layer = network.layers()[l];
    for (Eigen::Index i = 0; i < layer.W.size(); ++i) {
      worst = std::max(worst, std::abs(difference(layer.W.data()[i]) - gradient[l].W.data()[i]));
      size = std::max(size, std::abs(gradient[l].W.data()[i]));
    }
    for (Eigen::Index i = 0; i < layer.b.size(); ++i) worst = std::max(worst, std::abs(difference(layer.b[i]) - gradient[l].b[i]));
  }
  for (Eigen::Index i = 0; i < x.size(); ++i) worst = std::max(worst, std::abs(difference(x.data()[i]) - dx.data()[i]));
  EXPECT_LT(worst / size, 1e-8);
}
INSTANTIATE_TEST_SUITE_P(Activations, NetworkGradient, testing::Values(Activation::relu, Activation::tanh, Activation::silu, Activation::identity),
                         [](const auto& info) { return name_of(info.param); });

TEST(Activation, UnknownNameListsTheKnown) {
  EXPECT_EQ(activation_named("silu"), Activation::silu);
  try {
    (void)activation_named("rellu");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("did you mean \"relu\"?"), std::string::npos);
  }
}

// Two steps by hand with g = 2, then g = -1: m1 = 0.2, v1 = 0.004, so that x moves by rate 2 / (2 + eps);
// m2 = 0.08, v2 = 0.004996, m2 / (1 - 0.81) = 0.4210526, v2 / (1 - 0.998001) = 2.4992496.
TEST(Adam, FollowsTwoStepsWorkedByHand) {
  Adam adam{.rate = 0.1, .epsilon = 1e-8};
  double x = 1, m = 0, v = 0, g = 2;
  adam.step = 1;
  adam.update(&x, &g, &m, &v, 1, true);
  EXPECT_NEAR(x, 0.9, 1e-9);
  EXPECT_NEAR(m, 0.2, 1e-15);
  EXPECT_NEAR(v, 0.004, 1e-15);
  g = -1;
  adam.step = 2;
  adam.update(&x, &g, &m, &v, 1, true);
  EXPECT_NEAR(x, 0.9 - 0.1 * 0.42105263157894740 / std::sqrt(0.004996 / 0.001999), 1e-9);
}

TEST(Adam, DecoupledDecayShrinksWithoutAGradient) {
  Adam adam{.rate = 0.1, .decay = 0.5, .step = 1};
  double x = 2, m = 0, v = 0, g = 0;
  adam.update(&x, &g, &m, &v, 1, true);
  EXPECT_DOUBLE_EQ(x, 2 * (1 - 0.05));
  adam.update(&x, &g, &m, &v, 1, false);
  EXPECT_DOUBLE_EQ(x, 2 * (1 - 0.05));
}

TEST(PlateauSchedule, LowersTheRateAfterFiveEpochsWithoutImprovement) {
  PlateauSchedule schedule(1.0, 0.95, 5);
  EXPECT_EQ(schedule.next(3.0), 1.0);
  EXPECT_EQ(schedule.next(2.0), 1.0);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(schedule.next(2.0), 1.0);
  EXPECT_DOUBLE_EQ(schedule.next(2.5), 0.95);
  for (int i = 0; i < 4; ++i) EXPECT_DOUBLE_EQ(schedule.next(2.0), 0.95);
  EXPECT_DOUBLE_EQ(schedule.next(1.9), 0.95);  // an improvement restarts the count
  for (int i = 0; i < 4; ++i) EXPECT_DOUBLE_EQ(schedule.next(1.9), 0.95);
  EXPECT_DOUBLE_EQ(schedule.next(1.9), 0.95 * 0.95);
}

// The fused step over blocks of output rows equals Adam on the gradient of back-propagation.
TEST(NetworkTrainer, BlockwiseStepIsAdamOnTheWholeGradient) {
  RandomStream random(5, 1);
  Network<double> blocked({3, 6, 1300}, Activation::tanh, random);
  Network<double> whole = blocked;
  const Matrix x = random_matrix(3, 4, 3), y = random_matrix(1300, 4, 4);
  NetworkTrainer<double> trainer(blocked, {.learning_rate = 0.01, .loss = Loss::mse}, 2);
  const double loss = trainer.step(x, y);
  Network<double>::Tape tape;
  whole.hidden(x, tape);
  const Matrix error = whole.forward(x) - y;
  EXPECT_NEAR(loss, error.squaredNorm() / double(error.size()), 1e-12);
  std::vector<DenseLayer<double>> gradient;
  whole.backward(tape, 2.0 / double(error.size()) * error, &gradient);
  Adam adam{.rate = 0.01, .step = 1};
  for (std::size_t l = 0; l < gradient.size(); ++l) {
    auto m = gradient[l], v = gradient[l];
    m.W.setZero();
    m.b.setZero();
    v.W.setZero();
    v.b.setZero();
    auto& layer = whole.layers()[l];
    adam.update(layer.W.data(), gradient[l].W.data(), m.W.data(), v.W.data(), layer.W.size(), true);
    adam.update(layer.b.data(), gradient[l].b.data(), m.b.data(), v.b.data(), layer.b.size(), false);
    EXPECT_LT((layer.W - blocked.layers()[l].W).norm(), 1e-9);
    EXPECT_LT((layer.b - blocked.layers()[l].b).norm(), 1e-9);
  }
}

TEST(NetworkTraining, LearnsALineAndIsTheSameOnOneAndTwoThreads) {
  const Eigen::MatrixXf x = random_matrix(2, 64, 5).cast<float>();
  const Eigen::MatrixXf y = random_matrix(700, 2, 6).cast<float>() * x;
  const NetworkTraining options{.learning_rate = 5e-3, .epochs = 150, .loss = Loss::mae};
  std::vector<Network<float>> trained;
  for (int threads : {1, 2}) {
    RandomStream random(3, 7);
    trained.emplace_back(std::vector<int>{2, 16, 700}, Activation::relu, random);
    const auto summary = train_network<float>(trained.back(), x, y, x, y, options, random, threads);
    ASSERT_EQ(summary.train_loss.size(), 150u);
    ASSERT_EQ(summary.test_loss.size(), 150u);
    EXPECT_LT(summary.train_loss.back(), 0.1 * summary.train_loss.front());
  }
  for (std::size_t l = 0; l < trained[0].layers().size(); ++l) EXPECT_EQ(trained[0].layers()[l].W, trained[1].layers()[l].W);
}

TEST(NetworkTraining, DivergenceIsANumericsError) {
  RandomStream random(3, 8);
  Network<float> network({1, 4, 1}, Activation::relu, random);
  const Eigen::MatrixXf x = Eigen::MatrixXf::Constant(1, 4, 1), y = Eigen::MatrixXf::Constant(1, 4, std::numeric_limits<float>::infinity());
  EXPECT_THROW(train_network<float>(network, x, y, Eigen::MatrixXf(1, 0), Eigen::MatrixXf(1, 0), {.loss = Loss::mse}, random, 1), NumericsError);
}
