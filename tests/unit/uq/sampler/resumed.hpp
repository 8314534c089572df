#pragma once
/// Runs of a sampler that are stopped again and again.
#include <gtest/gtest.h>

#include <atomic>

#include "base/json.hpp"
#include "base/provenance.hpp"
#include "tests/scratch.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel::testing {

/// Raises a flag after so many evaluations; otherwise the density inside.
class Stopping : public LogDensity {
 public:
  Stopping(const LogDensity& inner, std::size_t limit, std::atomic<bool>& stop) : inner_(inner), limit_(limit), stop_(stop) {}
  [[nodiscard]] const std::vector<std::string>& coordinates() const override { return inner_.coordinates(); }
  [[nodiscard]] double log_density(std::span<const double> x) const override {
    count();
    return inner_.log_density(x);
  }
  [[nodiscard]] bool has_gradient() const override { return inner_.has_gradient(); }
  double log_density_and_gradient(std::span<const double> x, std::span<double> g) const override {
    count();
    return inner_.log_density_and_gradient(x, g);
  }

 private:
  void count() const {
    if (++calls_ > limit_) stop_ = true;
  }
  const LogDensity& inner_;
  std::size_t limit_;
  std::atomic<bool>& stop_;
  mutable std::atomic<std::size_t> calls_{0};
};

inline Provenance provenance_of(const SamplerOptions& options) { return {.stage = "sample", .options = {{"sampler", options.kind}}, .seed = 2}; }

/// A run with seed 2 on two threads that is stopped after each `limit` evaluations is the run in one piece on one thread, to the last bit. At least `least`
/// stops.
inline void expect_resumed_to_the_same_draws(const LogDensity& density, const SamplerStart& start, const SamplerOptions& options, std::size_t limit, int least,
                                             const LogDensity* cheap = nullptr) {
  const auto sample = [&](const LogDensity& of, const SamplerRun& run) {
    return cheap ? run_sampler(*cheap, of, start, options, run) : run_sampler(of, start, options, run);
  };
  const auto whole = sample(density, {.seed = 2});
  const auto journal = scratch("resumed_" + options.kind) / "posterior.journal";
  int stops = 0;
  for (;; ++stops) {
    std::atomic<bool> stop = false;
    const Stopping stopping(density, limit, stop);
    try {
      const auto r = sample(stopping, {.seed = 2, .threads = 2, .journal = journal, .provenance = provenance_of(options), .stop = &stop});
      EXPECT_EQ(r.coordinates.values, whole.coordinates.values);
      EXPECT_EQ(r.log_density, whole.log_density);
      EXPECT_EQ(r.acceptance, whole.acceptance);
      EXPECT_EQ(r.energy, whole.energy);
      EXPECT_EQ(r.depth, whole.depth);
      EXPECT_EQ(r.summary.e_bfmi, whole.summary.e_bfmi);
      EXPECT_EQ(r.summary.log_evidence, whole.summary.log_evidence);
      EXPECT_EQ(r.summary.evaluations, whole.summary.evaluations);
      break;
    } catch (const Interrupted&) {
      ASSERT_LT(stops, 300);
    }
  }
  EXPECT_GE(stops, least);
}

}  // namespace calomel::testing
