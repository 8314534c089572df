#pragma once
/// One Markov chain of a sampler: a state and a transition. sampler.hpp runs several of them, keeps their draws and saves them.
#include <Eigen/Core>
#include <span>

#include "base/frame_file.hpp"
#include "base/random.hpp"
#include "uq/log_density.hpp"

namespace calomel {

/// A chain promises:
///  - a transition draws from the given stream and from nothing else, and depends on nothing but it and the chain's state;
///  - with learns = true (warm-up) it may change its proposal; after freeze() it leaves the density invariant exactly;
///  - restore() of what save() wrote gives a chain that goes on to the same draws.
class MarkovChain {
 public:
  struct Transition {
    double acceptance = 0;  ///< probability with which it moved, [0, 1]
    int evaluations = 0;    ///< of the density
  };

  virtual ~MarkovChain() = default;
  /// Begins at x: (d), where the log density is `log_density`, finite.
  virtual void begin(std::span<const double> x, double log_density) = 0;
  virtual Transition step(RandomStream& random, bool learns) = 0;
  /// Ends the warm-up.
  virtual void freeze() = 0;
  [[nodiscard]] virtual std::span<const double> position() const = 0;
  [[nodiscard]] virtual double log_density() const = 0;
  virtual void save(ByteWriter& out) const = 0;
  virtual void restore(ByteReader& in) = 0;
};

}  // namespace calomel
