#include "uq/sampler/sampler_options.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "base/json.hpp"
#include "tests/unit/uq/sampler/densities.hpp"
#include "tests/unit/uq/sampler/resumed.hpp"
#include "uq/sampler/delayed_acceptance.hpp"
#include "uq/sampler/dram.hpp"
#include "uq/sampler/ensemble.hpp"
#include "uq/sampler/nuts.hpp"
#include "uq/sampler/smc.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

namespace {

/// `[sampler.walk]`: a sampler that the program does not have.
struct WalkOptions {
  double length = 1;
  int tries = 1;

  template <class V>
  void visit(V& v) {
    v("length", length, {.range = between(0.01, 100), .doc = "standard deviation of a step"});
    v("tries", tries, {.range = at_least(1), .doc = "steps of a transition"});
  }
};

/// Metropolis steps of one length.
class WalkChain final : public MarkovChain {
 public:
  WalkChain(const LogDensity& density, const WalkOptions& options) : density_(density), options_(options) {}
  void begin(std::span<const double> x, double log_density) override {
    x_.assign(x.begin(), x.end());
    log_density_ = log_density;
  }
  Transition step(RandomStream& random, bool /*learns*/) override {
    Transition t;
    for (int i = 0; i < options_.tries; ++i) {
      std::vector<double> y = x_;
      for (double& v : y) v += options_.length * random.normal();
      const double value = density_.log_density(y);
      const double a = std::exp(std::min(0.0, value - log_density_));
      ++t.evaluations;
      t.acceptance += a / options_.tries;
      if (random.uniform() < a) begin(y, value);
    }
    return t;
  }
  void freeze() override {}
  [[nodiscard]] std::span<const double> position(std::size_t) const override { return x_; }
  [[nodiscard]] double log_density(std::size_t) const override { return log_density_; }
  void save(ByteWriter& out) const override {
    out.values(std::span<const double>(x_));
    out.value(log_density_);
  }
  void restore(ByteReader& in) override {
    x_ = in.values<double>();
    in.into(log_density_);
  }

 private:
  const LogDensity& density_;
  WalkOptions options_;
  std::vector<double> x_;
  double log_density_ = 0;
};

SamplerEntry walk_sampler() {
  return {.chain = [](const ChainSetting& s) { return std::make_unique<WalkChain>(s.density, s.options.table<WalkOptions>()); },
          .evaluations = [](const SamplerOptions& o, std::size_t) { return double(o.table<WalkOptions>().tries); },
          .lengths = {.warmup = 200, .draws = 4000, .thin = 2},
          .external_lengths = ChainLengths{.warmup = 20, .draws = 30, .thin = 1},
          .options = WalkOptions{},
          .limits = {"tries"}};
}

/// A catalogue of the toy alone, and one of three entries made from it.
const Registry<SamplerEntry>& toys() {
  static const Registry<SamplerEntry> all = [] {
    Registry<SamplerEntry> r("sampler");
    r.add("walk", "steps of one length", walk_sampler());
    return r;
  }();
  return all;
}
const Registry<SamplerEntry>& demanding_toys() {
  static const Registry<SamplerEntry> all = [] {
    Registry<SamplerEntry> r("sampler");
    SamplerEntry along = walk_sampler(), corrected = walk_sampler();
    along.needs_gradient = true;
    along.options = NutsOptions{};
    corrected.first_stage = "walk";
    corrected.options = DramOptions{};
    r.add("walk", "steps of one length", walk_sampler());
    r.add("along", "steps of a sampler that needs a gradient", along);
    r.add("corrected", "steps of a sampler of two densities", corrected);
    return r;
  }();
  return all;
}

SamplerOptions walk() { return default_sampler_options("walk", false, toys()); }

std::string refusal_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

}  // namespace

// The whole program sees a sampler through its entry: nothing but the entry is written for the toy.
TEST(AnEntryOfTheCatalogue, IsAllThatASamplerNeedsToDraw) {
  const Gaussian density(Eigen::VectorXd::Constant(1, 3), Eigen::MatrixXd::Identity(1, 1));
  SamplerOptions options = walk();
  options.table<WalkOptions>().length = 2;
  const SamplerStart start{.mean = Eigen::VectorXd::Zero(1), .covariance = {}, .points = {}};
  const auto r = run_sampler(density, start, options, {.seed = 3, .threads = 2});
  const auto c = assess(r.quantities, sampling_facts(r, options.thin));
  EXPECT_TRUE(c.converged);
  EXPECT_LT(std::abs(c.parameters[0].mean - 3), 4 * c.parameters[0].mcse_mean);
  EXPECT_LT(std::abs(c.parameters[0].sd - 1), 4 * c.parameters[0].mcse_sd);
  EXPECT_GT(std::abs(c.parameters[0].mean - 3.3), 4 * c.parameters[0].mcse_mean);  // control
  EXPECT_EQ(r.summary.kind, "walk");
  EXPECT_EQ(double(r.summary.evaluations), usual_evaluations(options, 1) + 4);  // one evaluation more at each start
  options.draws = 300;
  expect_resumed_to_the_same_draws(density, start, options, 400, 3);
}

TEST(AnEntryOfTheCatalogue, BringsItsTableOfTheCaseFile) {
  CaseFile file = CaseFile::from_text("[sampler]\nkind = \"walk\"\ndraws = 7\n[sampler.walk]\nlength = 0.25\n");
  SamplerOptions options = walk();
  file.read("sampler", options);
  EXPECT_EQ(options.draws, 7);
  EXPECT_EQ(options.warmup, 200);
  EXPECT_EQ(options.table<WalkOptions>().length, 0.25);
  EXPECT_EQ(identity_options(options).dump(), R"({"kind":"walk","chains":4,"warmup":200,"draws":7,"thin":2,"dispersion":2.0,"walk":{"length":0.25}})");
  EXPECT_EQ(default_sampler_options("walk", true, toys()).draws, 30);
  ReferenceVisitor page("sampler.");
  options.visit(page);
  EXPECT_THAT(page.markdown, HasSubstr("| `sampler.walk.length` |  | `0.25` | 0.01 <= x <= 100 | standard deviation of a step |"));
  NumberVisitor number("walk.length");
  options.visit(number);
  ASSERT_NE(number.number, nullptr);
  *number.number = 0.5;
  EXPECT_EQ(options.table<WalkOptions>().length, 0.5);

  CaseFile wrong = CaseFile::from_text("[sampler.walk]\nlength = 1000\n"), misspelt = CaseFile::from_text("[sampler.walk]\nlenght = 1\n"),
           other = CaseFile::from_text("[sampler]\nkind = \"dram\"\n");
  EXPECT_THAT(refusal_of([&] { wrong.read("sampler", options); }), HasSubstr("sampler.walk.length"));
  EXPECT_THAT(refusal_of([&] { misspelt.read("sampler", options); }), HasSubstr("did you mean \"length\"?"));
  EXPECT_THAT(refusal_of([&] { other.read("sampler", options); }), HasSubstr("walk"));
}

TEST(AnEntryOfTheCatalogue, ListsWhatItNeedsOfADensity) {
  const Written density(1, [](std::span<const double> x) { return -x[0] * x[0]; });
  const SamplerStart start{.mean = Eigen::VectorXd::Zero(1), .covariance = {}, .points = {}};
  const auto options_of = [](const char* kind) { return default_sampler_options(kind, false, demanding_toys()); };
  const auto along = refusal_of([&] { (void)run_sampler(density, start, options_of("along"), {}); });
  EXPECT_THAT(along, HasSubstr("take \"walk\", which need none"));
  const auto corrected = refusal_of([&] { (void)run_sampler(density, start, options_of("corrected"), {}); });
  EXPECT_THAT(corrected, HasSubstr("take \"walk\""));
  const auto two = refusal_of([&] { (void)run_sampler(density, density, start, options_of("walk"), {}); });
  EXPECT_THAT(two, HasSubstr("take \"corrected\""));
  EXPECT_EQ(one_density_options(options_of("corrected")).kind, "walk");
  EXPECT_EQ(one_density_options(options_of("along")).kind, "along");
  // The table of the first stage counts, that of a sampler that is not run does not.
  EXPECT_TRUE(identity_options(options_of("corrected")).contains("walk"));
  EXPECT_FALSE(identity_options(options_of("corrected")).contains("along"));
}

TEST(AnEntryOfTheCatalogue, CopiesItsOptionsAndKeepsTheirType) {
  SamplerOptions one = walk();
  SamplerOptions two = one;
  two.table<WalkOptions>().tries = 5;
  EXPECT_EQ(one.table<WalkOptions>().tries, 1);
  one = two;
  EXPECT_EQ(one.table<WalkOptions>().tries, 5);
  EXPECT_THROW((void)one.table<SmcOptions>(), ContractFailure);
}

// The identity of a sampled result, by which finished stages of earlier versions are found again.
TEST(SamplerOptions, TheIdentityHasTheTablesThatTheKindReadsAndNoLimits) {
  const std::map<std::string, std::string> expected{
      {"dram", R"({"kind":"dram","chains":4,"warmup":5000,"draws":10000,"thin":4,"dispersion":2.0,"dram":{"stages":2,"shrink":0.2,"adapt_every":100}})"},
      {"nuts", R"({"kind":"nuts","chains":4,"warmup":1000,"draws":2000,"thin":1,"dispersion":2.0,"nuts":{"target":0.8,"depth":10,"metric":"dense"}})"},
      {"ensemble",
       R"({"kind":"ensemble","chains":4,"warmup":1000,"draws":1500,"thin":10,"dispersion":2.0,"ensemble":{"walkers":0,"stretch":0.5,"scale":2.0}})"},
      {"smc", R"({"kind":"smc","chains":4,"warmup":1000,"draws":2000,"thin":1,"dispersion":2.0,"smc":{"keep":0.9,"correlation":0.6,"sweeps":200}})"},
      {"delayed_acceptance",
       R"({"kind":"delayed_acceptance","chains":4,"warmup":500,"draws":300,"thin":1,"dispersion":2.0,"dram":{"stages":2,"shrink":0.2,"adapt_every":100},)"
       R"("delayed_acceptance":{"first_stage":50,"settle":20}})"}};
  for (const auto& [kind, identity] : expected) EXPECT_EQ(identity_options(default_sampler_options(kind)).dump(), identity);
}

TEST(SamplerOptions, DefaultsAreThoseOfTheFirstSampler) {
  EXPECT_EQ(samplers().names()[0], "dram");
  EXPECT_EQ(echo(SamplerOptions{}), echo(default_sampler_options("dram")));
  const SamplerOptions external = default_sampler_options("dram", true);
  EXPECT_EQ(external.warmup, 4000);
  EXPECT_EQ(external.draws, 4000);
  EXPECT_EQ(external.thin, 4);
  for (const auto& kind : samplers().names()) {
    if (kind == "dram") continue;
    EXPECT_EQ(echo(default_sampler_options(kind, true)), echo(default_sampler_options(kind))) << kind;
  }
}

TEST(SamplerOptions, ForecastsCountTheEvaluationsOfTheSampledDensity) {
  const auto usual = [](const char* kind) { return usual_evaluations(default_sampler_options(kind), 3); };
  EXPECT_DOUBLE_EQ(usual("dram"), 1.7 * 4 * 45000);
  EXPECT_DOUBLE_EQ(usual("nuts"), 7.0 * 4 * 3000);
  EXPECT_DOUBLE_EQ(usual("ensemble"), 12.0 * 4 * 16000);
  EXPECT_DOUBLE_EQ(usual("smc"), 40.0 * 4 * 2000);
  EXPECT_DOUBLE_EQ(usual("delayed_acceptance"), 4 * 320.0);
}
