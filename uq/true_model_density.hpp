#pragma once
/// A case's posterior by runs of the true model, on the coordinates of the one on its emulator.
#include <atomic>
#include <mutex>

#include "inverse/posterior/posterior_fit.hpp"
#include "uq/log_density.hpp"

namespace calomel {

/// The density of `fit.posterior` with a run of the finest mesh in place of the emulator:
///
///   ln p(q) = ln p(q | emulator) - ln L(emulator) + ln L(run(theta) + B [phi(u, k) - phi(u, finest)]; v),
///
/// B phi the emulator's mean, of which only the way from the finest mesh to the records' place beyond it, k, is left; v = the numerical noise of one run, 1
/// where the model carries any, and the emulator's variance of that way. Zero where a run fails. Runs are made one at a time, whatever the number of chains,
/// each on all threads; those that were made are kept by `in.run`. Both arguments outlive the object.
class TrueModelDensity final : public LogDensity {
 public:
  TrueModelDensity(const PosteriorInputs& in, const PosteriorFit& fit) : in_(in), fit_(fit), names_(fit.posterior->names()) {}

  [[nodiscard]] const std::vector<std::string>& coordinates() const override { return names_; }
  [[nodiscard]] double log_density(std::span<const double> x) const override;
  void constrain(std::span<const double> x, std::span<double> values) const override;
  /// Runs that failed so far.
  [[nodiscard]] std::size_t failed() const { return failed_; }

 private:
  const PosteriorInputs& in_;
  const PosteriorFit& fit_;
  std::vector<std::string> names_;
  mutable std::mutex running_;
  mutable std::atomic<std::size_t> failed_ = 0;
};

}  // namespace calomel
