#pragma once
/// The seam for a liquid that is not Riemer's: with state, with numbers that vary in space, or with another formula. The
/// solver hands it the volumetric strain of many points at once and takes the pressure; everything else (gradients, hourglass
/// control, slip, nodes) remains as it is, and a run without such a law never comes here.
#include <span>
#include <string>

#include "base/errors.hpp"
#include "forward/mesh/mesh.hpp"
#include "forward/solver/liquid_points.hpp"

namespace calomel {

/// A law fails at point `point` of those that it was handed; the run adds where that is, and when.
class LiquidPointError : public NumericsError {
 public:
  LiquidPointError(const std::string& reason, std::size_t point) : NumericsError(reason), point_(point) {}
  [[nodiscard]] std::size_t point() const { return point_; }

 private:
  std::size_t point_;
};

class LiquidLaw {
 public:
  virtual ~LiquidLaw() = default;
  /// State variables of a point.
  [[nodiscard]] virtual std::size_t state_size() const { return 0; }
  /// State before the first step. `centres`: of the points [m]; `state`: variable k of point i at state[k * stride + i], 0 on entry.
  virtual void initialise(std::span<const Vec3> centres, double* state, std::size_t stride) const { (void)centres, (void)state, (void)stride; }
  /// Greatest stiffness -dp/de_v, at constant state and rate, that the law may come to [Pa]; 0: never above the bulk modulus of the run's Riemer parameters.
  /// The time step follows from the greater of the two. A law whose stiffness has no bound of its own takes one from what the run can
  /// reach, its heating pressure for instance, and throws where that is passed.
  [[nodiscard]] virtual double greatest_stiffness() const { return 0; }
  /// Pressure of every point now. Called from several threads on different points. Never stiffer than `greatest_stiffness`;
  /// the regularising viscosity is the law's own to add. Errors: LiquidPointError, or NumericsError with the reason.
  virtual void advance(const LiquidPoints& points) const = 0;
};

}  // namespace calomel
