#pragma once
/// One Markov chain of a sampler: a state and a transition. sampler.hpp runs several of them, keeps their draws and saves them.
#include <Eigen/Core>
#include <optional>
#include <span>

#include "base/frame_file.hpp"
#include "base/random.hpp"
#include "uq/log_density.hpp"

namespace calomel {

/// What a transition along a trajectory tells beside.
struct Trajectory {
  double energy = 0;       ///< -ln p + kinetic energy where it began [-]
  bool divergent = false;  ///< given up: the energy's error passed all bounds, or the density is zero there
  int depth = 0;           ///< doublings
  bool cut = false;        ///< ended by the greatest number of doublings alone
};

/// A chain promises:
///  - a transition draws from the given stream and from nothing else, and depends on nothing but it and the chain's state;
///  - with learns = true (warm-up) it may change its proposal; after freeze() it leaves the density invariant exactly, or tells the points of a population that
///  was made for
///    the density, one a transition (smc);
///  - restore() of what save() wrote gives a chain that goes on to the same draws.
class MarkovChain {
 public:
  struct Transition {
    double acceptance = 0;      ///< probability with which it moved, [0, 1]
    int evaluations = 0;        ///< of the density that is sampled
    int cheap_evaluations = 0;  ///< of its cheap stand-in, where there is one
    std::optional<Trajectory> trajectory = std::nullopt;
  };

  virtual ~MarkovChain() = default;
  /// Begins at x: (d), where the log density is `log_density`, finite; the cheap one's where there are two.
  virtual void begin(std::span<const double> x, double log_density) = 0;
  virtual Transition step(RandomStream& random, bool learns) = 0;
  /// Ends the warm-up.
  virtual void freeze() = 0;
  /// Points that move together; each is told as a chain.
  [[nodiscard]] virtual std::size_t walkers() const { return 1; }
  [[nodiscard]] virtual std::span<const double> position(std::size_t walker) const = 0;
  [[nodiscard]] virtual double log_density(std::size_t walker) const = 0;
  /// Whether its points may be set elsewhere between two transitions, by a move that leaves the density invariant.
  [[nodiscard]] virtual bool jumps() const { return false; }
  /// Sets one to x: (d), where the log density is `log_density`. centre: (d), of the mode there; what is learnt of the shape counts from it.
  virtual void jump(std::size_t /*walker*/, std::span<const double> /*x*/, double /*log_density*/, const Eigen::VectorXd& /*centre*/) {
    expect(false, "only points of a chain that jumps are set elsewhere");
  }
  /// An estimate of ln of the integral of the density, where the sampler makes one.
  [[nodiscard]] virtual std::optional<double> log_evidence() const { return std::nullopt; }
  virtual void save(ByteWriter& out) const = 0;
  virtual void restore(ByteReader& in) = 0;
};

}  // namespace calomel
