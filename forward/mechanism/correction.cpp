#include "forward/mechanism/correction.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/not_finite.hpp"
#include "forward/mechanism/wall_stretch.hpp"
#include "forward/solver/layout.hpp"

namespace calomel {

void CorrectedLiquid::initialise(std::span<const Vec3> centres, double* state, std::size_t stride) const {
  for (std::size_t k = 0; k < parts_.size(); ++k)
    for (std::size_t i = 0; i < centres.size(); ++i) state[(2 + k) * stride + i] = parts_[k].zone.holds(centres[i]) ? 1 : 0;
}

double CorrectedLiquid::greatest_stiffness() const {
  double factor = 1;
  for (const auto& part : parts_) factor *= (1 + std::max(0.0, part.terms.stiffness)) * (1 + std::max(0.0, -part.terms.lag));
  return factor * liquid_.bulk_modulus;
}

void CorrectedLiquid::advance(const LiquidPoints& points) const {
  const double dt = points.dt, follows = dt > 0 ? -std::expm1(-dt / lag_time) : 0;
  const double cutoff = std::min(liquid_.tensile_cutoff, 1e30);  // finite, so that mercury which never gives way needs no case of its own
  std::vector<double> stay(parts_.size(), 0);                    // of a void beyond what it would be, after the step
  for (std::size_t k = 0; k < parts_.size(); ++k)
    if (const double time = parts_[k].terms.void_lag; time > 0 && dt > 0) stay[k] = std::exp(-dt / time);
  for (std::size_t i = 0; i < points.count; ++i) {
    MercuryTerms sum;
    double stays = 0;
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      if (points.state[(2 + k) * points.stride + i] == 0) continue;
      const MercuryTerms& t = parts_[k].terms;
      sum.stiffness += t.stiffness;
      sum.cutoff += t.cutoff;
      sum.viscosity += t.viscosity;
      sum.quadratic_viscosity += t.quadratic_viscosity;
      sum.lag += t.lag;
      stays = std::max(stays, stay[k]);
    }
    double &late = points.state[i], &alpha = points.state[points.stride + i];
    const double k = liquid_.bulk_modulus * (1 + sum.stiffness), sigma = cutoff * (1 + sum.cutoff),
                 rate = dt > 0 ? (points.strain[i] - points.strain_before[i]) / dt : 0;
    const double elastic = points.heating[i] - k * points.strain[i];
    late += follows * (elastic - late);
    const double p = elastic + sum.lag * (late - elastic) - (liquid_.viscosity + sum.viscosity + sum.quadratic_viscosity * std::abs(rate)) * rate,
                 x = (-p - sigma) / k;  // x: the stretch beyond the cutoff
    alpha = std::max(0.0, x < alpha ? x + stays * (alpha - x) : x);
    points.pressure[i] = alpha > std::max(0.0, x) ? -sigma + k * (alpha - x) : std::max(p, -sigma);
  }
}

namespace {

std::shared_ptr<const LiquidLaw> corrected_liquid(const MechanismValues& v, const RunSetup& s) {
  const MercuryTerms terms{v["stiffness"], v["cutoff"], v["viscosity"], v["quadratic_viscosity"], v["lag"], v["void_lag"]};
  if (terms == MercuryTerms{}) return s.liquid_law;  // a wall's term alone
  std::vector<CorrectedPart> parts;
  if (s.liquid_law) {
    const auto* other = dynamic_cast<const CorrectedLiquid*>(s.liquid_law.get());
    if (!other) throw InputError({.problem = "the mercury has a law of its own, to which no terms can be added"});
    parts = other->parts();
  }
  parts.push_back({terms, {v["x_begin"], v["x_end"], v["z_begin"], v["z_end"]}});
  return std::make_shared<CorrectedLiquid>(s.liquid, std::move(parts));
}

/// What acts on the nodes of a stretch of a wall.
void act_on_wall(const MechanismValues& v, const Mesh& mesh, const LoadOptions&, RunSetup& s) {
  const double mass = v["mass"], damping = v["damping"], slip = v["slip"];
  if (mass == 0 && damping == 0 && slip == 0) return;
  const auto add = [](std::vector<double>& values, std::size_t size, std::size_t at, double value) {
    if (value == 0) return;  // a run without any has no such phase
    values.resize(size, 0);
    values[at] += value;
  };
  std::map<NodeId, Vec3> areas;
  for (const BoundaryNode& n : boundary_nodes(mesh, mesh.wetted)) areas[n.node] = n.area;
  for (const PairAtWall& p : pairs_at_wall(mesh, wall_stretch(v, wall_names()))) {
    const SlipPair& pair = mesh.slip[p.pair];
    const Vec3 &a = areas[pair.mercury], &n = pair.normals[0];
    const double area = p.share * std::abs(a[0] * n[0] + a[1] * n[1] + a[2] * n[2]);
    add(s.node_mass, mesh.nodes.size(), std::size_t(pair.steel), mass * area);
    add(s.node_damping, mesh.nodes.size(), std::size_t(pair.steel), damping * area);
    add(s.slip_drag, mesh.slip.size(), p.pair, slip * area);
  }
}

MechanismKey term(const char* name, const char* unit, double range, double least, const char* doc) {
  return {.name = name, .unit = unit, .off = 0, .low = -range, .high = range, .least = least, .doc = doc};
}

MechanismKey edge(const char* name, double off) {
  return {.name = name, .unit = "m", .off = off, .low = -anywhere, .high = anywhere, .decides = false, .doc = "edge of the part of the mercury"};
}

}  // namespace

const MechanismEntry& correction() {
  static const MechanismEntry entry = [] {
    std::vector<MechanismKey> keys{term("stiffness", "", 0.2, -0.9, "of the bulk modulus, more"),
                                   term("cutoff", "", 1, -1, "of the tensile cutoff, more"),
                                   term("viscosity", "Pa s", 2e4, -infinity, "a pressure against the rate of its strain"),
                                   term("quadratic_viscosity", "Pa s^2", 20, -infinity, "a pressure against the square of the rate of its strain"),
                                   term("lag", "", 0.4, -infinity, "a share of the pressure that comes 5 us late"),
                                   term("void_lag", "s", 1e-4, 0, "time constant of voids that close"),
                                   term("mass", "kg/m^2", 40, -infinity, "mass on a wall"),
                                   term("damping", "Pa s/m", 2e6, -infinity, "a force on a wall against its velocity"),
                                   term("slip", "Pa s/m", 2e6, -infinity, "a drag between a wall and the mercury along it"),
                                   edge("x_begin", -anywhere),
                                   edge("x_end", anywhere),
                                   edge("z_begin", -anywhere),
                                   edge("z_end", anywhere)};
    for (auto& k : stretch_keys(wall_names())) keys.push_back(std::move(k));
    return MechanismEntry{.law = "terms of a part of the mercury or of a stretch of a wall",
                          .plain = "physics without a name",
                          .keys = std::move(keys),
                          .fields = act_on_wall,
                          .liquid = corrected_liquid};
  }();
  return entry;
}

}  // namespace calomel
