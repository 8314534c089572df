#pragma once
/// Terms that represent physics without a name: the additional action of a part of the mercury or of a stretch of a wall. A diagnosis that ends
/// at "unknown" estimates the size of each, and so describes what is missing. No mechanism of a case file: mechanisms() does not list it.
#include "forward/material/riemer.hpp"
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

/// A part of the mercury, a box [m].
struct MercuryZone {
  double x_begin, x_end, z_begin, z_end;
  [[nodiscard]] bool holds(const Vec3& x) const { return x[0] >= x_begin && x[0] < x_end && x[2] >= z_begin && x[2] < z_end; }
};

/// Terms of the mercury in a zone.
struct MercuryTerms {
  double stiffness = 0;            ///< of the bulk modulus [-]
  double cutoff = 0;               ///< of the tensile cutoff [-]
  double viscosity = 0;            ///< a of a de_v/dt [Pa s]
  double quadratic_viscosity = 0;  ///< b of b |de_v/dt| de_v/dt [Pa s^2]
  double lag = 0;                  ///< share of the elastic pressure that follows by `CorrectedLiquid::lag_time` late [-]
  double void_lag = 0;             ///< time constant of voids that close [s]
  bool operator==(const MercuryTerms&) const = default;
};

/// Terms and where they act.
struct CorrectedPart {
  MercuryTerms terms;
  MercuryZone zone;
};

/// Riemer's law with the sums of such terms. With the elastic pressure p_e = p0 - K (1 + stiffness) e_v and the same late, p_l,
///   p = max(p_e + lag (p_l - p_e) - (eta + viscosity + quadratic |de_v/dt|) de_v/dt, -sigma_c (1 + cutoff)),
/// where a void that closes follows the stretch beyond the cutoff with the time constant void_lag, the longest where parts overlap. All terms 0: Riemer's.
class CorrectedLiquid : public LiquidLaw {
 public:
  static constexpr double lag_time = 5e-6;  ///< [s]

  CorrectedLiquid(const Riemer& liquid, std::vector<CorrectedPart> parts) : liquid_(liquid), parts_(std::move(parts)) {}
  [[nodiscard]] const std::vector<CorrectedPart>& parts() const { return parts_; }
  [[nodiscard]] std::size_t state_size() const override { return 2 + parts_.size(); }
  void initialise(std::span<const Vec3> centres, double* state, std::size_t stride) const override;
  [[nodiscard]] double greatest_stiffness() const override;
  void advance(const LiquidPoints& points) const override;

 private:
  Riemer liquid_;
  std::vector<CorrectedPart> parts_;
};

/// Several may act in one run, by the names correction_1, correction_2 and so on. Keys: the terms of the mercury, those of a wall (mass, damping, slip), and
/// where they act (`wall`, `begin`, `end`; `x_begin` to `z_end`).
const MechanismEntry& correction();

inline constexpr double anywhere = 1e3;  ///< an edge of a part that has none [m]

}  // namespace calomel
