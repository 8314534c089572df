#include "inverse/spe/spe.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <set>

#include "base/artefact.hpp"
#include "base/case_file.hpp"
#include "base/netcdf_file.hpp"
#include "base/provenance.hpp"
#include "forward/campaign/campaign.hpp"
#include "inverse/spe/adaptive_space.hpp"
#include "tests/unit/inverse/meshed.hpp"
#include "tests/scratch.hpp"

using namespace calomel;
using testing::Contains;
using testing::HasSubstr;

namespace {

/// A smooth model: three gauges, each with its own mixture of three shapes whose amplitudes follow from the parameters.
class Mixture : public ForwardModel {
 public:
  Mixture() {
    shape_.conditions = {"default"}, shape_.sensors = {"A", "B", "C"};
    for (std::size_t t = 0; t < 80; ++t) shape_.times.push_back(1e-6 * double(t));
    const auto add = [&](const char* name, double low, double high, double nominal) {
      Parameter p{.name = name, .min = low, .max = high};
      p.nominal = nominal;
      shape_.parameters.push_back(p);
    };
    add("density", 11000, 15000, 13500), add("sound_speed", 1200, 1800, 1450), add("damping", 0, 1, 0.7);
  }
  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override {
    ++runs;
    if (fails && fails(theta)) return {.ok = false, .message = "the step collapsed"};
    const double a = theta[0] / 13000, b = theta[1] / 1500, c = theta[2];
    Prediction p;
    for (std::size_t s = 0; s < 3; ++s)
      for (std::size_t t = 0; t < shape_.times.size(); ++t) {
        const double x = double(t) / 80, k = double(s);
        p.mean.push_back(1e-4 * (a * a * std::sin(6 * x) + (1 + 0.3 * k) * b * std::cos(9 * x) + c * c * (1 - 0.2 * k) * std::sin(15 * x)));
      }
    return p;
  }
  std::function<bool(std::span<const double>)> fails;
  mutable std::atomic<int> runs{0};

 private:
  ModelShape shape_;
};

const std::vector<double> truth{12250, 1580, 0.42};

struct Case {
  Mixture model;
  Recordings recordings = recorded(model, truth, 8, 6e-6, 4);
  Problem problem = make_problem(model.shape(), recordings, {});
  Archive archive = archive_of(model, "chebyshev", 120, 1);
};

SpeOptions small() {
  SpeOptions o;
  o.total_degree = {5, 8}, o.tensor_product = {4}, o.lambdas = {0.5, 1, 2};
  o.trials = 12, o.iterations = 40, o.candidates = 5, o.zoom = 0;  // shrinking boxes are tested in spe_zoom_test.cpp
  return o;
}

/// |theta - truth| over the box.
double away(const std::vector<double>& theta) {
  const Mixture model;
  double d = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& p = model.shape().parameters[k];
    d = std::max(d, std::abs(theta[k] - truth[k]) / (p.max - p.min));
  }
  return d;
}

}  // namespace

TEST(Spe, RecoversTheTruth) {
  Case c;
  SpeOptions o = small();
  o.objective = "rrmse";
  const auto s = run_spe(c.problem, c.archive, c.model, o, 1, 2);
  ASSERT_EQ(s.status, CalibrationStatus::done);
  EXPECT_LT(away(s.theta), 0.05);   // candidates closer than 0.03 of the box are the same
  EXPECT_GT(away(s.nominal), 0.2);  // negative control
  EXPECT_LT(*s.best.objective_model, 0.3 * *s.at_nominal.objective_model);
  EXPECT_EQ(s.surrogates.size(), 9u);
  for (const auto& p : s.surrogates) {
    EXPECT_LE(p.gap, 1e-10);
    EXPECT_GT(p.validation.r2, 0.9);
    EXPECT_LT(p.train.rrmse, p.validation.rrmse * 1.2);
  }
  EXPECT_EQ(s.n_train + s.n_validation, 120u);
  EXPECT_EQ(s.n_validation, 24u);
}

TEST(Spe, ThePublishedMisfitLeadsThereToo) {
  Case c;
  const auto s = run_spe(c.problem, c.archive, c.model, small(), 1, 2);
  ASSERT_EQ(s.status, CalibrationStatus::done);
  EXPECT_EQ(s.objective.name, "paper_spe");
  EXPECT_NEAR(*s.best.objective_model, s.best.score.delta1 + 5 * s.best.score.delta2, 1e-12);
  EXPECT_LT(away(s.theta), 0.08);
  EXPECT_LT(*s.best.objective_model, 0.2 * *s.at_nominal.objective_model);
}

TEST(Spe, RefinementLowersTheTrueMisfit) {
  Case c;
  SpeOptions o = small();
  o.total_degree = {6, 9, 12}, o.tensor_product = {5, 7};
  double once = 0, refined = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    c.archive = archive_of(c.model, "chebyshev", 120, seed);
    o.refinements = 0;
    const auto plain = run_spe(c.problem, c.archive, c.model, o, seed, 2);
    o.refinements = 2;
    const auto again = run_spe(c.problem, c.archive, c.model, o, seed, 2);
    EXPECT_EQ(plain.runs_added, 0u);
    EXPECT_GE(again.runs_added, 4u);
    EXPECT_LE(*again.best.objective_model, *plain.best.objective_model) << seed;
    once += *plain.best.objective_model, refined += *again.best.objective_model;
  }
  EXPECT_LT(refined, 0.5 * once);
}

TEST(Spe, OneAndTwoThreadsGiveTheSameAndTheSeedDecides) {
  Case c;
  auto a = run_spe(c.problem, c.archive, c.model, small(), 1, 1), b = run_spe(c.problem, c.archive, c.model, small(), 1, 2);
  for (auto* s : {&a, &b}) s->search_s = s->model_s = s->fit_s = 0;
  EXPECT_EQ(spe_json(a, c.problem, {}, {}).dump(), spe_json(b, c.problem, {}, {}).dump());
  EXPECT_EQ(a.calibrated, b.calibrated);
  EXPECT_NE(run_spe(c.problem, c.archive, c.model, small(), 2, 2).theta, a.theta);
}

TEST(Spe, EveryRunOfTheModelIsCountedOnce) {
  Case c;
  c.model.runs = 0;
  const auto s = run_spe(c.problem, c.archive, c.model, small(), 1, 1);
  EXPECT_EQ(std::size_t(c.model.runs), s.model_runs);
}

TEST(Spe, AUniformDesignIsWeighted) {
  Mixture model;
  const auto problem = make_problem(model.shape(), recorded(model, truth, 8, 6e-6, 4), {});
  SpeOptions o = small();
  o.objective = "rrmse";
  const auto archive = archive_of(model, "latin_hypercube", 120, 3);
  const auto data = discrepancies(problem, archive, objectives().get("rrmse"), o, 1);
  for (Eigen::Index i = 0; i < data.weights.size(); ++i) {
    double density = 1;
    for (const double u : data.units.col(i)) density /= M_PI * std::sqrt(u * (1 - u));
    EXPECT_NEAR(data.weights[i], std::sqrt(density), 1e-9);
  }
  EXPECT_LT(away(run_spe(problem, archive, model, o, 1, 2).theta), 0.05);
  const auto ones = discrepancies(problem, archive_of(model, "chebyshev", 40, 3), objectives().get("rrmse"), o, 1);
  EXPECT_EQ(ones.weights, Eigen::VectorXd::Ones(40));
}

TEST(Spe, FailedRunsAreLeftOutAndFailedCandidatesReplaced) {
  Case c;
  Mixture fragile;
  fragile.fails = [](std::span<const double> theta) { return theta[2] > 0.8; };
  const auto archive = archive_of(fragile, "chebyshev", 150, 1);
  const auto s = run_spe(c.problem, archive, c.model, small(), 1, 2);
  EXPECT_GT(s.runs_excluded, 20u);
  EXPECT_EQ(s.runs_used + s.runs_excluded, 150u);
  EXPECT_LT(away(s.theta), 0.1);
  Mixture broken;
  broken.fails = [](std::span<const double> theta) { return away({theta.begin(), theta.end()}) < 0.02; };
  const auto t = run_spe(c.problem, c.archive, broken, small(), 1, 2);
  EXPECT_EQ(t.status, CalibrationStatus::done);
  EXPECT_GE(away(t.theta), 0.02);
}

TEST(Spe, ReportsThatAllCoefficientsVanish) {
  Case c;
  SpeOptions o = small();
  o.lambda_scale = "absolute", o.lambdas = {1e7, 1e8};
  try {
    (void)run_spe(c.problem, c.archive, c.model, o, 1, 2);
    ADD_FAILURE() << "no error";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("spe.lambdas"));
    EXPECT_THAT(e.what(), HasSubstr("vanishes"));
    EXPECT_THAT(e.what(), HasSubstr("cross_validation"));
  }
  o.lambdas = {1, 1e8};  // one of two surrogates remains
  o.refinements = 0;
  const auto s = run_spe(c.problem, c.archive, c.model, o, 1, 2);
  EXPECT_EQ(s.status, CalibrationStatus::done);
  EXPECT_EQ(std::count_if(s.surrogates.begin(), s.surrogates.end(), [](const auto& p) { return p.ok(); }), 3);
  EXPECT_EQ(s.surrogates.size(), 6u);
  EXPECT_THAT(s.surrogates[0].failure, HasSubstr("lambda_max"));
}

TEST(Spe, LambdaMayBeGivenInFourWays) {
  Case c;
  SpeOptions o = small();
  o.refinements = 0, o.total_degree = {6}, o.tensor_product = {}, o.lambdas = {1};
  const auto lambda = [&](const char* scale, double factor) {
    o.lambda_scale = scale, o.lambdas = {factor};
    const auto s = run_spe(c.problem, c.archive, c.model, o, 1, 2);
    return std::pair(s.surrogates[0].lambda, s.spaces[0]);
  };
  const auto [absolute, space] = lambda("absolute", 3);
  EXPECT_EQ(absolute, 3);
  EXPECT_NEAR(lambda("lambda_max", 0.01).first, 0.01 * space.lambda_max, 1e-9 * space.lambda_max);
  EXPECT_EQ(lambda("validation", 2).first, 2 * space.validation.lambda);
  EXPECT_EQ(lambda("cross_validation", 1).first, space.cross_validation.lambda);
  EXPECT_LT(space.cross_validation.lambda, space.lambda_max);
  EXPECT_GT(space.validation.error, 0);
}

TEST(Spe, TheChosenLambdasComeNearTheBestOfThePathOnFreshPoints) {
  // Noisy values of a function of 7 polynomials in a space of 286; the error is measured at points that were not used. Means over ten data sets.
  const auto function = [](const Eigen::VectorXd& u) {
    const double x = 2 * u[0] - 1, y = 2 * u[1] - 1, z = 2 * u[2] - 1;
    return 60 + 20 * x * x + 12 * x * y + 15 * y + 8 * z * z * z - 6 * x * z + 4 * y * y * z;
  };
  SpeOptions o;
  o.total_degree = {10}, o.tensor_product = {}, o.refit = false;
  const std::vector<double> shares{0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 1e-4};
  double best = 0, strong = 0, weak = 0, validated = 0, crossed = 0;
  for (std::uint64_t set = 0; set < 10; ++set) {
    RandomStream random(7, set);
    const auto points = [&](Eigen::Index n) {
      return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(3, n, [&] { return 0.5 * (1 - std::cos(M_PI * random.uniform())); }));
    };
    ScatteredData data;
    data.units = points(120), data.values.resize(120), data.weights = Eigen::VectorXd::Ones(120);
    for (Eigen::Index i = 0; i < 120; ++i) {
      data.values[i] = function(data.units.col(i)) + 3 * random.normal();
      (i % 5 == 0 ? data.validation : data.train).push_back(std::size_t(i));
    }
    const Eigen::MatrixXd fresh = points(500);
    const auto errors = [&](const char* scale, const std::vector<double>& lambdas) {
      o.lambda_scale = scale, o.lambdas = lambdas;
      std::vector<double> all, values(500);
      for (const auto& fit : fit_sparse_polynomials(data, o, 1, 1).surrogates) {
        fit.expansion.evaluate(fresh, values);
        double squares = 0;
        for (Eigen::Index i = 0; i < 500; ++i) squares += std::pow(values[std::size_t(i)] - function(fresh.col(i)), 2) / 500;
        all.push_back(std::sqrt(squares) / 10);
      }
      return all;
    };
    const auto path = errors("lambda_max", shares);
    best += *std::min_element(path.begin(), path.end()), strong += path.front(), weak += path.back();
    validated += errors("validation", {1})[0], crossed += errors("cross_validation", {1})[0];
  }
  EXPECT_LT(crossed, 1.1 * best);
  EXPECT_LT(validated, 1.3 * best);  // 24 held-out values choose less reliably than five folds of 96
  EXPECT_GT(strong, 1.5 * best);     // so the choice has an effect
  EXPECT_GT(weak, 1.5 * best);
}

TEST(AdaptiveSpace, GrowsWhereTheFunctionVariesAndOnlyThere) {
  // degree 9 in the first coordinate, 1 in the second, none in the third
  const auto function = [](const Eigen::VectorXd& u) { return 5 + 3 * std::exp(2.5 * (2 * u[0] - 1)) + 2 * (2 * u[1] - 1); };
  RandomStream random(11, 0);
  ScatteredData data;
  data.units = Eigen::MatrixXd::NullaryExpr(3, 100, [&] { return 0.5 * (1 - std::cos(M_PI * random.uniform())); });
  data.values.resize(100), data.weights = Eigen::VectorXd::Ones(100);
  for (Eigen::Index i = 0; i < 100; ++i) data.values[i] = function(data.units.col(i)), (i % 5 == 0 ? data.validation : data.train).push_back(std::size_t(i));
  const Eigen::MatrixXi degrees = adaptive_degrees(data, 12, 500, false, 5, 1);
  EXPECT_GE(degrees.row(0).maxCoeff(), 7);
  EXPECT_LE(degrees.row(1).maxCoeff(), 3);
  EXPECT_LE(degrees.row(2).maxCoeff(), 2);
  std::set<std::vector<int>> terms;
  for (Eigen::Index j = 0; j < degrees.cols(); ++j) terms.insert({degrees(0, j), degrees(1, j), degrees(2, j)});
  EXPECT_EQ(terms.size(), std::size_t(degrees.cols()));
  for (auto t : terms)  // downward closed
    for (std::size_t k = 0; k < 3; ++k)
      if (t[k] > 0) {
        auto before = t;
        --before[k];
        EXPECT_TRUE(terms.contains(before));
      }
  SpeOptions o;
  o.tensor_product = {}, o.lambdas = {1};
  const auto error = [&](std::vector<int> adaptive, std::vector<int> total) {
    o.adaptive = std::move(adaptive), o.total_degree = std::move(total);
    return fit_sparse_polynomials(data, o, 1, 1).surrogates.at(0).validation.rrmse;
  };
  const double grown = error({12}, {});
  EXPECT_LT(grown, 2e-3);
  EXPECT_GT(error({1}, {}), 10 * grown);  // the growth of the space makes the difference
  EXPECT_GT(error({}, {4}), 5 * grown);   // 35 terms in every direction
  EXPECT_LT(degrees.cols(), 60);
  o.most_terms = 12;
  EXPECT_LE(fit_sparse_polynomials(data, (o.adaptive = {12}, o.total_degree = {}, o), 1, 1).spaces.at(0).terms, 12u);
}

TEST(Spe, TheHeldOutRunsTakeNoPartInTheFitOfTheirErrors) {
  Case c;
  SpeOptions o = small();
  o.refinements = 0, o.lambda_scale = "lambda_max", o.lambdas = {0.01};
  auto data = discrepancies(c.problem, c.archive, objectives().get(o.objective), o, 1);
  EXPECT_NEAR(double(data.validation.size()), 0.2 * 120, 1);
  const auto before = fit_sparse_polynomials(data, o, 1, 1).surrogates.at(0);
  for (const auto i : data.validation) data.values[Eigen::Index(i)] *= 2;
  const auto after = fit_sparse_polynomials(data, o, 1, 1).surrogates.at(0);
  EXPECT_EQ(before.train.rrmse, after.train.rrmse);
  EXPECT_EQ(before.lambda, after.lambda);
  EXPECT_GT(after.validation.rrmse, 0.3);
}

TEST(Spe, SpacesThatAreTooLargeAreLeftOut) {
  Case c;
  SpeOptions o = small();
  o.refinements = 0, o.most_terms = 60;
  const auto s = run_spe(c.problem, c.archive, c.model, o, 1, 2);
  EXPECT_EQ(s.spaces.size(), 1u);
  EXPECT_THAT(s.too_large, testing::ElementsAre("total_degree 8", "tensor_product 4"));
  EXPECT_EQ(s.most_terms, 60);
  o.most_terms = 20;
  EXPECT_THROW((void)run_spe(c.problem, c.archive, c.model, o, 1, 2), InputError);
  o = small(), o.hyperbolic_cross = {8}, o.total_degree = {}, o.tensor_product = {};
  EXPECT_LT(away(run_spe(c.problem, c.archive, c.model, o, 1, 2).theta), 0.2);
}

TEST(Spe, ASparseGridSpaceRecoversWhatLiesInItAndNothingElse) {
  RandomStream random(11, 0);
  const auto held_out_error = [&](int first, int second, int third) {
    ScatteredData data;
    data.units = Eigen::MatrixXd::NullaryExpr(3, 150, [&] { return 0.5 - 0.5 * std::cos(std::numbers::pi * random.uniform()); });
    data.values.resize(150), data.weights = Eigen::VectorXd::Ones(150);
    const auto t = [](int k, double u) { return std::cos(k * std::acos(2 * u - 1)); };
    for (Eigen::Index i = 0; i < 150; ++i)
      data.values[i] = 5 + 2 * t(first, data.units(0, i)) * t(second, data.units(1, i)) * t(third, data.units(2, i)) - 1.5 * t(4, data.units(2, i));
    for (std::size_t i = 0; i < 150; ++i) (i % 5 == 0 ? data.validation : data.train).push_back(i);
    SpeOptions o;
    o.total_degree = {}, o.tensor_product = {}, o.sparse_grid = {4}, o.lambda_scale = "lambda_max", o.lambdas = {1e-5};
    const auto fitted = fit_sparse_polynomials(data, o, 1, 1);
    EXPECT_EQ(fitted.spaces.at(0).terms, 177u);
    return fitted.surrogates.at(0).validation.rrmse;
  };
  EXPECT_LT(held_out_error(8, 2, 0), 1e-4);   // levels 3, 1, 0
  EXPECT_LT(held_out_error(16, 0, 0), 1e-4);  // beyond every total degree with so few terms
  EXPECT_GT(held_out_error(3, 3, 1), 0.05);   // levels 2, 2, 1: outside, though the total degree is lower
  EXPECT_GT(held_out_error(17, 0, 0), 0.05);
}

TEST(Spe, TheLogarithmIsUndone) {
  Case c;
  SpeOptions o = small();
  o.transform = "log";
  const auto s = run_spe(c.problem, c.archive, c.model, o, 1, 2);
  EXPECT_LT(away(s.theta), 0.1);
  EXPECT_NEAR(s.at_nominal.objective_surrogate / *s.at_nominal.objective_model, 1, 0.2);
  o.objective = "paper_enc";  // may be negative
  EXPECT_THROW((void)run_spe(c.problem, c.archive, c.model, o, 1, 2), InputError);
  o.transform = "none";
  EXPECT_LT(away(run_spe(c.problem, c.archive, c.model, o, 1, 2).theta), 0.1);
}

TEST(Spe, ArtefactsHoldTheContract) {
  Case c;
  const auto dir = scratch("spe");
  const auto s = run_spe(c.problem, c.archive, c.model, small(), 1, 2, [](const std::string&, std::size_t done, std::size_t total) { EXPECT_LE(done, total); });
  write_spe(s, c.problem, {}, {.stage = "spe", .seed = 1}, dir);
  const Json j = read_json(dir / "spe.json");
  for (const char* key : {"theta", "nominal", "objective", "product", "candidates", "sensors", "accuracy", "mae", "nominal_accuracy", "nominal_mae",
                          "surrogates", "modes", "optima", "lambda_choices", "train_rrmse", "validation_rrmse", "warnings", "provenance"})
    EXPECT_TRUE(j.contains(key)) << key;
  EXPECT_EQ(j["product"], "tuned");
  EXPECT_EQ(j["objective"]["sense"], "minimise");
  EXPECT_EQ(j["surrogates"].size(), 9u);
  for (const auto& x : j["surrogates"]) EXPECT_TRUE(x["train"]["rrmse"].is_number() && x["validation"]["r2"].is_number());
  for (const auto& x : j["candidates"]) EXPECT_TRUE(x["objective_model"].is_number() && x["objective_surrogate"].is_number());
  ASSERT_FALSE(j["modes"].empty());
  std::size_t optima = 0;
  for (const auto& m : j["modes"]) optima += m["optima"].get<std::size_t>();
  EXPECT_EQ(optima, j["optima"].size());
  const auto kept = NetcdfReader(dir / "spe.nc").doubles("calibrated"), made = c.model.evaluate(s.theta).mean;
  EXPECT_EQ(std::vector<float>(kept.begin(), kept.end()), std::vector<float>(made.begin(), made.end()));  // added runs are kept in single precision
}

TEST(Spe, OptionsAreReadAndHeldToTheirRanges) {
  CaseFile file = CaseFile::from_text("[spe]\ntotal_degree = [4, 6]\nlambda_scale = 'absolute'\nlambdas = [100, 500]\n[spe.dgs]\nquadrature = 5\n");
  SpeOptions o;
  file.read("spe", o);
  EXPECT_EQ(o.total_degree, (std::vector<int>{4, 6}));
  EXPECT_EQ(o.dgs.quadrature, 5);
  for (const char* text : {"[spe]\nlambda_scale = 'relative'\n", "[spe]\nlambdas = [0]\n", "[spe]\nlambdas = []\n", "[spe]\ntransform = 'sqrt'\n",
                           "[spe]\ntotal_degree = []\ntensor_product = []\n"}) {
    CaseFile bad = CaseFile::from_text(text);
    SpeOptions ignored;
    EXPECT_THROW(bad.read("spe", ignored), InputError) << text;
  }
}

TEST(DensityModes, AreThoseOfAKnownMixture) {
  // 60, 30 and 10 points about three centres, sd 0.02, and a bandwidth that separates them.
  RandomStream random(1, 0);
  const std::vector<Eigen::Vector2d> centres{{0.2, 0.3}, {0.7, 0.7}, {0.25, 0.8}};
  const std::vector<int> sizes{60, 30, 10};
  Eigen::MatrixXd points(2, 100);
  for (Eigen::Index i = 0; i < 100; ++i) {
    const std::size_t c = i < 60 ? 0 : i < 90 ? 1 : 2;
    points.col(i) = centres[c] + 0.02 * Eigen::Vector2d(random.normal(), random.normal());
  }
  const auto modes = density_modes(points, 0.05);
  ASSERT_EQ(modes.size(), 3u);
  for (std::size_t m = 0; m < 3; ++m) {
    EXPECT_LT((modes[m].x - centres[m]).norm(), 4 * 0.02 / std::sqrt(double(sizes[m]))) << m;  // 4 standard errors of a mean
    EXPECT_EQ(modes[m].points, std::size_t(sizes[m]));
    // The smoothed cloud is a Gaussian of variance 0.02^2 + 0.05^2.
    EXPECT_NEAR(modes[m].density, sizes[m] / 100.0 * 0.05 * 0.05 / (0.05 * 0.05 + 0.02 * 0.02), 0.05 * sizes[m] / 100.0) << m;
  }
  EXPECT_EQ(density_modes(points, 1.0).size(), 1u);  // negative control: all points in one cluster
}
