#include "forward/solver/plane_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace calomel {

namespace {

constexpr double straight = 1e-9;
constexpr std::uint8_t fixed_y = 2;

/// Whether two nodes lie straight across y from each other and are held alike, y held.
bool across(const Mesh& mesh, NodeId a, NodeId b) {
  const Vec3& x = mesh.nodes[std::size_t(a)];
  const Vec3& y = mesh.nodes[std::size_t(b)];
  const auto fixed = mesh.fixed[std::size_t(a)];
  const double distance = std::abs(x[1] - y[1]);
  return fixed == mesh.fixed[std::size_t(b)] && (fixed & fixed_y) && distance > 0 && std::abs(x[0] - y[0]) <= straight * distance &&
         std::abs(x[2] - y[2]) <= straight * distance;
}

/// The axis of an element that runs across, if one does.
std::optional<std::uint8_t> axis_across(const Mesh& mesh, const std::array<NodeId, 8>& element) {
  for (std::uint8_t axis = 0; axis < 3; ++axis) {
    const auto corners = plane_corners(axis);
    if (std::all_of(corners.begin(), corners.end(), [&](auto k) { return across(mesh, element[k], element[std::size_t(k | (1 << axis))]); })) return axis;
  }
  return {};
}

}  // namespace

std::array<std::uint8_t, 4> plane_corners(std::uint8_t across) {
  std::array<std::uint8_t, 4> corners{};
  std::size_t n = 0;
  for (std::uint8_t k = 0; k < 8; ++k)
    if (!(k & (1 << across))) corners[n++] = k;
  return corners;
}

PlanePairs plane_pairs(const Mesh& mesh) {
  if (!mesh.plane_strain) return {};
  constexpr NodeId alone = -1;
  std::vector<NodeId> partner(mesh.nodes.size(), alone);
  PlanePairs pairs;
  const auto join = [&](NodeId a, NodeId b) {
    auto& known = partner[std::size_t(a)];
    if (known != alone && known != b) return false;
    known = b;
    return true;
  };
  for (const auto& element : mesh.elements) {
    const auto axis = axis_across(mesh, element);
    if (!axis) return {};
    pairs.across.push_back(*axis);
    for (const auto k : plane_corners(*axis)) {
      const NodeId a = element[k], b = element[std::size_t(k | (1 << *axis))];
      if (!join(a, b) || !join(b, a)) return {};
    }
  }
  for (std::size_t n = 0; n < partner.size(); ++n) {
    if (partner[n] == alone) return {};
    const bool near = mesh.nodes[n][1] < mesh.nodes[std::size_t(partner[n])][1];
    pairs.leader.push_back(near ? NodeId(n) : partner[n]);
  }
  return pairs;
}

}  // namespace calomel
