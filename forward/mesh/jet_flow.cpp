#include <cmath>
#include <numbers>

#include "forward/mesh/make_mesh.hpp"
#include "forward/mesh/section.hpp"

namespace calomel {
namespace {

using PlanePoint = Eigen::Vector2d;  // (x, z)

// Chosen for the longest stable step of the default target at 1.7 to 4 mm; the angles of the elements grow better with both.
constexpr double core_depth = 0.25;
constexpr double roundness = 0.3;

/// A place on the outer contour: rear end of the bottom -> nose -> rear end of the top.
struct ContourPoint {
  PlanePoint outer;   ///< [m]
  PlanePoint inward;  ///< unit normal
  double wall = 0;    ///< thickness of the wall [m]
  double angle = 0;   ///< about the nose, from where it begins; 0 on the legs, 90 at the front [deg]
  bool upper = false;
  bool behind = false;  ///< on the legs, within the rear wall
};

/// Window at the tip, wall where the nose begins, sin^2 between.
double wall_at(const GeometryOptions& g, bool upper, double angle) {
  const double wall = g.wall_thickness(upper ? "top" : "bottom"), s = std::sin(angle * std::numbers::pi / 180);
  return wall + (*g.window - wall) * s * s;
}

/// The lower half of the contour from the rear end to the tip of the nose (or to the beginning of its flat front).
std::vector<ContourPoint> half_contour(const GeometryOptions& g, const JetFlowPlan& plan, bool upper) {
  const double R = *g.nose_radius, H = *g.height;
  std::vector<ContourPoint> points;
  const auto add = [&](double x, double angle) {
    const double a = angle * std::numbers::pi / 180;
    const double depth = R - R * std::cos(a);
    PlanePoint inward(std::sin(a), std::cos(a));
    if (angle == 90) inward = {1, 0};
    if (upper) inward.y() *= -1;
    points.push_back(
        {.outer = {x - R * std::sin(a), upper ? H - depth : depth}, .inward = inward, .wall = wall_at(g, upper, angle), .angle = angle, .upper = upper});
  };
  for (std::size_t i = 0; i + 1 < plan.leg.size(); ++i)
    for (int k = 0; k < int(plan.leg_counts[i]); ++k) {
      add(plan.leg[i] + (plan.leg[i + 1] - plan.leg[i]) * k / plan.leg_counts[i], 0);
      points.back().behind = g.rear == "wall" && i == 0;
    }
  for (std::size_t i = 0; i + 1 < plan.angles.size(); ++i)
    for (int k = 0; k < int(plan.arc_counts[i]); ++k) add(R, plan.angles[i] + (plan.angles[i + 1] - plan.angles[i]) * k / plan.arc_counts[i]);
  add(R, 90);
  return points;
}

/// Rear of the bottom, round the nose, to the rear of the top.
std::vector<ContourPoint> contour(const GeometryOptions& g, const JetFlowPlan& plan) {
  auto points = half_contour(g, plan, false);
  const auto upper = half_contour(g, plan, true);
  const PlanePoint a = points.back().outer, b = upper.back().outer;
  for (int k = 1; k < int(plan.flat_count); ++k) {
    ContourPoint p = points.back();
    p.outer = a + (b - a) * k / plan.flat_count;
    points.push_back(p);
  }
  // Without a flat front both halves end in the same point, the tip.
  for (std::size_t i = upper.size() - (plan.flat_count > 0 ? 0 : 1); i-- > 0;) points.push_back(upper[i]);
  return points;
}

class SectionBuilder {
 public:
  SectionBuilder(const GeometryOptions& g, const JetFlowPlan& plan) : g_(g), plan_(plan), contour_(contour(g, plan)) {
    plates_ = g.jet.thickness > 0;
    corner_ = 0;
    for (const double n : plan.leg_counts) corner_ += int(n);
    for (std::size_t i = 0; i < plan.corner; ++i) corner_ += int(plan.arc_counts[i]);
    last_ = int(contour_.size()) - 1;
    front_ = last_ - 2 * corner_;
  }

  Section build() {
    place_core_boundary();
    const std::array<int, 4> layers{int(plan_.wall), int(plan_.channel), int(plan_.plate), int(plan_.transition)};
    const int depth = layers[0] + layers[1] + layers[2] + layers[3];
    // Wrap: point (i, j), i along the contour, j inward; j = depth is the boundary of the core.
    for (int i = 0; i <= last_; ++i) {
      const auto& c = contour_[std::size_t(i)];
      const std::array<double, 4> ends{0, c.wall, c.wall + (plates_ ? g_.jet.channel : 0), offset(c)};
      for (int layer = 0; layer < 3; ++layer)
        for (int k = 0; k < layers[std::size_t(layer)]; ++k)
          put(c.outer + c.inward * (ends[std::size_t(layer)] + (ends[std::size_t(layer) + 1] - ends[std::size_t(layer)]) * k / layers[std::size_t(layer)]));
      const PlanePoint start = c.outer + c.inward * ends[3], end = core_boundary_[std::size_t(i)];
      for (int k = 0; k <= layers[3]; ++k) put(start + (end - start) * k / layers[3]);
    }
    const auto wrap = [&](int i, int j) { return NodeId(i * (depth + 1) + j); };
    for (int i = 0; i < last_; ++i)
      for (int j = 0; j < depth; ++j) {
        const bool wall = j < layers[0], plate = j >= layers[0] + layers[1] && j < layers[0] + layers[1] + layers[2] && plate_between(i);
        quad(wrap(i, j), wrap(i + 1, j), wrap(i + 1, j + 1), wrap(i, j + 1), wall || plate || behind(i) ? Region::steel : Region::mercury);
      }
    // Core: (i, j), i from the rear to the front, j from bottom to top; its edges are wrap points.
    const auto edge = [&](int i, int j) { return j == 0 ? i : j == front_ ? last_ - i : corner_ + j; };
    const auto boundary = [&](int i, int j) -> PlanePoint {
      if (j == 0 || j == front_ || i == corner_) return core_boundary_[std::size_t(edge(i, j))];
      // The rear end is plane.
      return core_boundary_[0] + (core_boundary_[std::size_t(last_)] - core_boundary_[0]) * j / front_;
    };
    std::vector<NodeId> core(std::size_t(corner_ + 1) * std::size_t(front_ + 1));
    const auto at = [&](int i, int j) -> NodeId& { return core[std::size_t(i) * std::size_t(front_ + 1) + std::size_t(j)]; };
    for (int i = 0; i <= corner_; ++i)
      for (int j = 0; j <= front_; ++j) {
        if (j == 0 || j == front_ || i == corner_)
          at(i, j) = wrap(edge(i, j), depth);
        else
          at(i, j) = put(i == 0 ? boundary(0, j) : transfinite(boundary, i, j, corner_, front_));
      }
    for (int i = 0; i < corner_; ++i)
      for (int j = 0; j < front_; ++j) quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1), behind(i) ? Region::steel : Region::mercury);
    return std::move(section_);
  }

 private:
  [[nodiscard]] double offset(const ContourPoint& c) const { return c.wall + (plates_ ? g_.jet.channel + g_.jet.thickness : 0); }
  [[nodiscard]] bool behind(int i) const { return contour_[std::size_t(i)].behind || contour_[std::size_t(i) + 1].behind; }
  [[nodiscard]] bool plate_between(int i) const {
    if (!plates_) return false;
    const auto &a = contour_[std::size_t(i)], &b = contour_[std::size_t(i) + 1];
    const double turn = a.upper && b.upper ? g_.jet.upper_turn : g_.jet.lower_turn;
    return a.upper == b.upper && std::max(a.angle, b.angle) <= turn * (1 + 1e-12);
  }

  /// The edges of the core, with points evenly along them. Its corners lie on the normals through the corner angle, `core_depth` of the remaining radius inside
  /// the last layer; between them an edge keeps `roundness` of the way from the straight line to the curve at that depth.
  void place_core_boundary() {
    core_boundary_.resize(contour_.size());
    const double R = *g_.nose_radius;
    const auto round = [&](int i) {
      const auto& c = contour_[std::size_t(i)];
      return PlanePoint(c.outer + c.inward * (offset(c) + core_depth * (R - offset(c))));
    };
    const auto edge = [&](int first, int last, const PlanePoint& a, const PlanePoint& b) {
      std::vector<PlanePoint> curve;
      std::vector<double> way{0};
      for (int i = first; i <= last; ++i) {
        const PlanePoint straight = a + (b - a) * (i - first) / (last - first);
        curve.push_back(straight + roundness * (round(i) - straight));
        if (i > first) way.push_back(way.back() + (curve.back() - curve[curve.size() - 2]).norm());
      }
      std::size_t at = 0;
      for (int i = first; i <= last; ++i) {
        const double wanted = way.back() * (i - first) / (last - first);
        while (at + 2 < way.size() && way[at + 1] < wanted) ++at;
        core_boundary_[std::size_t(i)] = curve[at] + (curve[at + 1] - curve[at]) * (wanted - way[at]) / (way[at + 1] - way[at]);
      }
    };
    const PlanePoint lower = round(corner_), upper = round(last_ - corner_);
    int nose = 0;  // intervals of a leg
    while (contour_[std::size_t(nose) + 1].angle == 0) ++nose;
    for (int i = 0; i <= nose; ++i)
      for (const int k : {i, last_ - i}) {
        const PlanePoint& corner = k == i ? lower : upper;
        core_boundary_[std::size_t(k)] = {contour_[std::size_t(k)].outer.x(), (1 - roundness) * corner.y() + roundness * round(k).y()};
      }
    edge(nose, corner_, {R, lower.y()}, lower);
    edge(corner_, last_ - corner_, lower, upper);
    edge(last_ - corner_, last_ - nose, upper, {R, upper.y()});
  }

  NodeId put(const PlanePoint& p) {
    section_.points.emplace_back(p.y(), p.x());  // (z, x, y) is right-handed
    return NodeId(section_.points.size() - 1);
  }
  void quad(NodeId a, NodeId b, NodeId c, NodeId d, Region region) {
    section_.quads.push_back({a, b, c, d});
    section_.region.push_back(region);
  }

  const GeometryOptions& g_;
  const JetFlowPlan& plan_;
  std::vector<ContourPoint> contour_;
  std::vector<PlanePoint> core_boundary_;
  Section section_;
  bool plates_ = false;
  int corner_ = 0;  ///< intervals from the rear end to the core's corner
  int front_ = 0;   ///< intervals between the two corners
  int last_ = 0;
};

}  // namespace

Mesh make_jet_flow(const GeometryOptions& options) {
  options.validate();
  const GeometryOptions g = options.resolved();
  const JetFlowPlan plan = jet_flow_plan(g);
  const double length = *g.length;

  AssemblyOptions assembly;
  assembly.slip = g.slips();
  if (g.half) assembly.mirrors = {{.axis = 1}};
  assembly.least_wall_elements = std::min(int(plan.wall), g.divisions(g.wall_thickness("side"), true));
  if (plan.plate > 0) assembly.least_wall_elements = std::min(assembly.least_wall_elements, int(plan.plate));
  if (g.rear == "wall") assembly.least_wall_elements = std::min(assembly.least_wall_elements, g.divisions(g.wall_thickness("rear"), true));
  assembly.boundary = [&](const hexahedron::Point& centre, const hexahedron::Point& normal) {
    if (g.half && normal.y() < -0.5 && std::abs(centre.y()) < 1e-9 * length) return BoundaryKind::symmetry_y;
    if (g.rear != "wall" && normal.x() > 0.5 && centre.x() > length * (1 - 1e-9)) return BoundaryKind::rear;
    return BoundaryKind::outer;
  };
  const Section section = SectionBuilder(g, plan).build();
  return assemble_mesh(extrude(section, layers_across(g), [](double z, double x, double y) { return Vec3{x, y, z}; }), assembly);
}

}  // namespace calomel
