#pragma once
/// One Markov chain of a sampler: a state and a transition. sampler.hpp runs several chains, keeps their draws and saves their states.
#include <Eigen/Core>
#include <optional>
#include <span>

#include "base/frame_file.hpp"
#include "base/random.hpp"
#include "uq/log_density.hpp"

namespace calomel {

/// What a transition along a trajectory reports in addition.
struct Trajectory {
  double energy = 0;       ///< -ln p + kinetic energy at its beginning [-]
  bool divergent = false;  ///< it ended because the energy's error passed its bound, or because the density is zero there
  int depth = 0;           ///< number of doublings
  bool cut = false;        ///< it ended at the greatest number of doublings, before it turned
};

/// A chain promises:
///  - A transition draws from the given stream alone. It depends on that stream and on the chain's state alone.
///  - With learns = true (warm-up) a transition may change the proposal. After freeze() each transition leaves the density invariant exactly, or it returns the
///    next point of a population that was made for the density.
///  - A chain that restore() reads from what save() wrote continues to the same draws.
class MarkovChain {
 public:
  struct Transition {
    double acceptance = 0;      ///< probability with which it moved, [0, 1]
    int evaluations = 0;        ///< evaluations of the density that is sampled
    int cheap_evaluations = 0;  ///< evaluations of the cheap density of a sampler of two densities
    std::optional<Trajectory> trajectory = std::nullopt;
  };

  virtual ~MarkovChain() = default;
  /// Begins at x: (d), where the log density is `log_density`, finite. A sampler of two densities takes that of the cheap one.
  virtual void begin(std::span<const double> x, double log_density) = 0;
  virtual Transition step(RandomStream& random, bool learns) = 0;
  /// Ends the warm-up.
  virtual void freeze() = 0;
  /// The number of points that move together. Each becomes a chain of the result.
  [[nodiscard]] virtual std::size_t walkers() const { return 1; }
  [[nodiscard]] virtual std::span<const double> position(std::size_t walker) const = 0;
  [[nodiscard]] virtual double log_density(std::size_t walker) const = 0;
  /// Whether a move between two transitions, which leaves the density invariant, may set its points elsewhere.
  [[nodiscard]] virtual bool jumps() const { return false; }
  /// Sets a walker to x: (d), where the log density is `log_density`. centre: (d), the mode there; a shape that the chain adapts is taken about it.
  virtual void jump(std::size_t /*walker*/, std::span<const double> /*x*/, double /*log_density*/, const Eigen::VectorXd& /*centre*/) {
    expect(false, "jump() is called on chains that jump");
  }
  /// An estimate of ln of the integral of the density, if the sampler makes one.
  [[nodiscard]] virtual std::optional<double> log_evidence() const { return std::nullopt; }
  virtual void save(ByteWriter& out) const = 0;
  virtual void restore(ByteReader& in) = 0;
};

}  // namespace calomel
