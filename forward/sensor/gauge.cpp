#include "forward/sensor/gauge.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

namespace calomel {
namespace {

using Eigen::Matrix3d;
using hexahedron::Point;

/// Collects weights by node, so that a node that several faces share is in the row once.
class RowBuilder {
 public:
  void add(NodeId node, const Point& weight) {
    const auto [at, fresh] = sum_.try_emplace(node, Point::Zero());
    at->second += weight;
  }
  [[nodiscard]] GaugeRow row(double scale = 1) const {
    GaugeRow r;
    for (const auto& [node, w] : sum_)
      if (w.squaredNorm() > 0) r.nodes.push_back(node), r.weights.push_back(hexahedron::vec3(scale * w));
    return r;
  }
  void subtract(const RowBuilder& other) {
    for (const auto& [node, w] : other.sum_) add(node, -w);
  }

 private:
  std::map<NodeId, Point> sum_;
};

/// A point of the whole model in the part that is kept, and the signs of its displacement components there.
struct Mirrored {
  Point position;
  Point sign{1, 1, 1};
  Point shift{0, 0, 0};
  /// The place in the whole model whose image this is.
  [[nodiscard]] Point back(const Point& image) const { return (image - shift).cwiseProduct(sign); }
};

Mirrored mirror(const Mesh& mesh, const Point& p) {
  Mirrored m{p};
  if (mesh.plane_strain) m.position.y() = 0;
  for (const auto& plane : mesh.mirrors)
    if (const int k = plane.axis; (p[k] < plane.at) == plane.above && p[k] != plane.at) {
      m.position[k] = 2 * plane.at - p[k];
      m.sign[k] = -1;
      m.shift[k] = 2 * plane.at;
    }
  return m;
}

std::string text(const std::array<double, 3>& v) { return fmt::format("[{}, {}, {}]", number_text(v[0]), number_text(v[1]), number_text(v[2])); }

/// What the rows of one gauge are made from.
struct Site {
  const Mesh& mesh;
  const SurfaceTree& tree;
  const SensorOptions& sensor;
  SurfacePoint at;

  /// d.[u(b) - u(a)]/l between the places nearest to x -+ l d/2.
  [[nodiscard]] RowBuilder difference(const Point& d) const {
    const double l = sensor.gauge_length;
    std::array<SurfacePoint, 2> end;
    std::array<Mirrored, 2> image;
    std::array<Point, 2> place;
    for (std::size_t k = 0; k < 2; ++k) {
      const Point wanted = at.position + (k == 0 ? -0.5 : 0.5) * l * d;
      image[k] = mirror(mesh, wanted);
      end[k] = tree.nearest(image[k].position, d.cwiseProduct(image[k].sign));
      place[k] = image[k].back(end[k].position);
      if (mesh.plane_strain) place[k].y() = wanted.y();  // nothing varies along y
    }
    const Point chord = place[1] - place[0];
    if (std::abs(chord.norm() - l) > 0.1 * l || chord.normalized().dot(d) < 0.9)
      throw InputError({.problem = fmt::format("the gauge of sensor \"{}\" reaches over an edge of the outer surface (its ends lie {:.4g} m apart)",
                                               sensor.name, chord.norm()),
                        .key = "gauge_length",
                        .value = number_text(l),
                        .suggestion = "move the gauge away from the edge, or shorten it"});
    RowBuilder row;
    const Point e = chord / chord.squaredNorm();
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t i = 0; i < 4; ++i) row.add(tree.face(end[k].face).nodes[i], (k == 0 ? -1 : 1) * end[k].weights[i] * e.cwiseProduct(image[k].sign));
    return row;
  }

  /// d.grad(u).d of one face at its centre, d turned into its plane; zero weight rows when d is along its normal.
  void face_gradient(std::int32_t f, const Point& direction, double weight, RowBuilder& row) const {
    const auto& nodes = tree.face(f).nodes;
    const auto b = bilinear_derivatives(0, 0);
    Point t1 = Point::Zero(), t2 = Point::Zero();
    for (std::size_t i = 0; i < 4; ++i) {
      const Point x = hexahedron::point(mesh.nodes[std::size_t(nodes[i])]);
      t1 += b.xi[i] * x;
      t2 += b.eta[i] * x;
    }
    const Point n = t1.cross(t2).normalized();
    const Point d = (direction - n * n.dot(direction)).normalized();
    // d = a t1 + c t2, so d/ds = a d/dxi + c d/deta.
    const double g11 = t1.squaredNorm(), g12 = t1.dot(t2), g22 = t2.squaredNorm(), det = g11 * g22 - g12 * g12;
    const double a = (g22 * d.dot(t1) - g12 * d.dot(t2)) / det, c = (g11 * d.dot(t2) - g12 * d.dot(t1)) / det;
    for (std::size_t i = 0; i < 4; ++i) row.add(nodes[i], weight * (a * b.xi[i] + c * b.eta[i]) * d);
  }

  /// d.grad(u).d, the mean at each node of the faces around it that lie within 30 degrees, interpolated. On a symmetry
  /// plane the faces' mirror images count too: (Md).grad(u).(Md), M the reflection.
  [[nodiscard]] RowBuilder gradient(const Point& d) const {
    RowBuilder row;
    const auto& nodes = tree.face(at.face).nodes;
    for (std::size_t i = 0; i < 4; ++i) {
      std::vector<std::int32_t> around;
      for (const auto f : tree.faces_at(nodes[i]))
        if (hexahedron::area_vector(mesh, tree.face(f)).normalized().dot(at.normal) > std::cos(M_PI / 6)) around.push_back(f);
      if (around.empty()) around.push_back(at.face);
      std::vector<Point> images{d};
      for (int k = 0; k < 3; ++k)
        if (mesh.fixed[std::size_t(nodes[i])] >> k & 1)
          for (std::size_t m = images.size(); m-- > 0;) images.push_back(images[m]), images.back()[k] *= -1;
      for (const auto f : around)
        for (const auto& image : images) face_gradient(f, image, at.weights[i] / double(around.size() * images.size()), row);
    }
    return row;
  }

  /// d.grad(u).d at the centre of the element below the face.
  [[nodiscard]] RowBuilder element_gradient(const Point& d) const {
    const auto element = std::size_t(tree.face(at.face).element);
    const auto x = hexahedron::corners(mesh, element);
    const auto sign = [](std::size_t a, int k) { return (a >> k & 1) ? 1.0 : -1.0; };
    Matrix3d J = Matrix3d::Zero();  // J(k, i) = dx_i / dxi_k
    for (std::size_t a = 0; a < 8; ++a)
      for (int k = 0; k < 3; ++k) J.row(k) += sign(a, k) / 8 * x[a].transpose();
    const Matrix3d inverse = J.inverse();
    RowBuilder row;
    for (std::size_t a = 0; a < 8; ++a) {
      const Point grad = inverse * Point(sign(a, 0) / 8, sign(a, 1) / 8, sign(a, 2) / 8);
      row.add(mesh.elements[element][a], d * d.dot(grad));
    }
    return row;
  }

  [[nodiscard]] RowBuilder at_point(const Point& d) const { return sensor.placement == "element_centre" ? element_gradient(d) : gradient(d); }
  [[nodiscard]] RowBuilder along(const Point& d) const { return sensor.placement == "surface" && sensor.gauge_length > 0 ? difference(d) : at_point(d); }
};

}  // namespace

double GaugeRow::operator()(std::span<const Vec3> displacement) const {
  double sum = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto& u = displacement[std::size_t(nodes[i])];
    sum += weights[i][0] * u[0] + weights[i][1] * u[1] + weights[i][2] * u[2];
  }
  return sum;
}

GaugeLocator::GaugeLocator(const Mesh& mesh) : mesh_(mesh), tree_(mesh, mesh.outer) {}

LocatedGauge GaugeLocator::locate(const SensorOptions& sensor) const {
  sensor.validate();
  const Mirrored image = mirror(mesh_, hexahedron::point(sensor.position));
  const Point wanted = hexahedron::point(sensor.direction).normalized().cwiseProduct(image.sign);
  const Site site{mesh_, tree_, sensor, tree_.nearest(image.position, wanted)};
  const SurfacePoint& at = site.at;
  if (at.distance > sensor.max_distance) {
    const Point there = image.back(at.position);
    throw InputError({.problem = fmt::format("sensor \"{}\" lies {:.4g} m from the outer surface", sensor.name, at.distance),
                      .key = "position",
                      .value = text(sensor.position),
                      .range = fmt::format("within max_distance = {} m", number_text(sensor.max_distance)),
                      .suggestion = fmt::format("the nearest place is [{:.6g}, {:.6g}, {:.6g}]", there.x(), there.y(), there.z())});
  }
  Point d = wanted - at.normal * at.normal.dot(wanted);
  if (d.norm() < 0.2)
    throw InputError({.problem = fmt::format("the direction of sensor \"{}\" is nearly normal to the surface, whose normal is [{:.3g}, {:.3g}, {:.3g}] there",
                                             sensor.name, at.normal.x() * image.sign.x(), at.normal.y() * image.sign.y(), at.normal.z() * image.sign.z()),
                      .key = "direction",
                      .value = text(sensor.direction),
                      .suggestion = "give a direction along the surface"});
  d.normalize();
  const Point t = at.normal.cross(d);

  LocatedGauge gauge;
  gauge.name = sensor.name;
  gauge.placed = hexahedron::vec3(at.position);
  gauge.normal = hexahedron::vec3(at.normal);
  gauge.direction = hexahedron::vec3(d);
  gauge.distance = at.distance;
  gauge.mirrored = image.sign.minCoeff() < 0;
  gauge.axial = site.along(d).row();
  gauge.transverse = site.at_point(t).row();
  // strain(45 deg) - strain(-45 deg) = gamma; a mirrored gauge has its t reversed.
  RowBuilder shear = site.at_point((d + t) / std::sqrt(2.0));
  shear.subtract(site.at_point((d - t) / std::sqrt(2.0)));
  gauge.shear = shear.row(image.sign.prod() < 0 ? -1 : 1);
  return gauge;
}

LocatedGauge locate_gauge(const Mesh& mesh, const SensorOptions& sensor) { return GaugeLocator(mesh).locate(sensor); }

}  // namespace calomel
