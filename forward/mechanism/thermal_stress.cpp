#include "forward/mechanism/thermal_stress.hpp"

#include <cmath>

namespace calomel {

namespace {

void heat_steel(const MechanismValues& v, const Mesh& mesh, const LoadOptions& load, RunSetup& s) {
  const double front = load.profile.greatest();  // 1 / shape on the axis at the front face
  s.thermal_strain.resize(mesh.elements.size(), 0);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    if (mesh.region[e] != Region::steel) continue;
    Vec3 x{};
    for (const NodeId n : mesh.elements[e])
      for (std::size_t c = 0; c < 3; ++c) x[c] += mesh.nodes[std::size_t(n)][c] / 8;
    const double across = front * load.profile.shape({load.profile.front, x[1], x[2]}, mesh.plane_strain);
    s.thermal_strain[e] += steel_expansion * load.factor * v["delta_t"] * across * std::exp(-(x[0] - load.profile.front) / v["decay"]);
  }
}

}  // namespace

MechanismEntry thermal_stress() {
  return {.law = "sigma = C : (e - a dT) in the steel, dT = delta_t S(y, z) exp(-x / decay), rising with the pulse",
          .plain = "heat that the pulse leaves in the steel",
          .check = "compare the rise of temperature with the heat that was calculated for the wall, or with thermocouples on it",
          .keys = {{.name = "delta_t",
                    .unit = "K",
                    .off = 0,
                    .low = 0,
                    .high = 2,
                    .least = 0,
                    .greatest = 1000,
                    .doc = "rise of temperature that a pulse of [load] brings on the axis of the beam at the outer front face"},
                   {.name = "decay",
                    .unit = "m",
                    .off = 0.05,
                    .low = 0.02,
                    .high = 0.1,
                    .decides = false,
                    .shapes = true,
                    .least = 1e-3,
                    .doc = "length along the beam over which the heat of the steel falls to 1/e"}},
          .fields = heat_steel};
}

}  // namespace calomel
