#include "forward/mesh/surface_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/errors.hpp"

namespace calomel {

using hexahedron::Point;

std::array<double, 4> bilinear_weights(double xi, double eta) {
  return {(1 - xi) * (1 - eta) / 4, (1 + xi) * (1 - eta) / 4, (1 + xi) * (1 + eta) / 4, (1 - xi) * (1 + eta) / 4};
}

BilinearDerivatives bilinear_derivatives(double xi, double eta) {
  return {.xi = {-(1 - eta) / 4, (1 - eta) / 4, (1 + eta) / 4, -(1 + eta) / 4}, .eta = {-(1 - xi) / 4, -(1 + xi) / 4, (1 + xi) / 4, (1 - xi) / 4}};
}

SurfaceTree::SurfaceTree(const Mesh& mesh, std::span<const Face> faces) : mesh_(mesh), faces_(faces) {
  expect(!faces.empty(), "a surface tree needs faces");
  centres_.reserve(faces.size());
  for (const auto& f : faces) centres_.push_back(hexahedron::centre(mesh, f));
  order_.resize(faces.size());
  std::iota(order_.begin(), order_.end(), 0);
  boxes_.reserve(faces.size() / 2 + 2);
  build(0, std::int32_t(faces.size()));

  std::vector<std::pair<NodeId, std::int32_t>> at;
  at.reserve(4 * faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const NodeId n : faces[f].nodes) at.emplace_back(n, std::int32_t(f));
  std::sort(at.begin(), at.end());
  for (const auto& [n, f] : at) {
    if (node_.empty() || node_.back() != n) node_.push_back(n), node_begin_.push_back(std::int32_t(node_faces_.size()));
    node_faces_.push_back(f);
  }
  node_begin_.push_back(std::int32_t(node_faces_.size()));
}

std::int32_t SurfaceTree::build(std::int32_t begin, std::int32_t end) {
  const auto self = std::int32_t(boxes_.size());
  Box box{.low = Point::Constant(1e300), .high = Point::Constant(-1e300), .begin = begin, .end = end};
  for (auto i = begin; i < end; ++i)
    for (const NodeId n : faces_[std::size_t(order_[std::size_t(i)])].nodes) {
      const Point p = hexahedron::point(mesh_.nodes[std::size_t(n)]);
      box.low = box.low.cwiseMin(p);
      box.high = box.high.cwiseMax(p);
    }
  boxes_.push_back(box);
  if (end - begin <= 4) return self;
  int axis = 0;
  (box.high - box.low).maxCoeff(&axis);
  const auto middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](std::int32_t a, std::int32_t b) {
    const double ca = centres_[std::size_t(a)][axis], cb = centres_[std::size_t(b)][axis];
    return ca != cb ? ca < cb : a < b;
  });
  const auto left = build(begin, middle), right = build(middle, end);
  boxes_[std::size_t(self)].left = left;
  boxes_[std::size_t(self)].right = right;
  return self;
}

SurfacePoint SurfaceTree::project(std::int32_t f, const Point& p) const {
  std::array<Point, 4> x;
  for (std::size_t i = 0; i < 4; ++i) x[i] = hexahedron::point(mesh_.nodes[std::size_t(faces_[std::size_t(f)].nodes[i])]);
  const auto at = [&](const std::array<double, 4>& w) { return Point(w[0] * x[0] + w[1] * x[1] + w[2] * x[2] + w[3] * x[3]); };
  // Gauss-Newton on |X(xi, eta) - p|^2, each coordinate kept within [-1, 1] (a bound that is active is left out of the step).
  double xi = 0, eta = 0;
  Point t1, t2;
  for (int step = 0; step < 30; ++step) {
    const auto d = bilinear_derivatives(xi, eta);
    t1 = at(d.xi);
    t2 = at(d.eta);
    const Point r = p - at(bilinear_weights(xi, eta));
    double g1 = t1.dot(r), g2 = t2.dot(r);
    const double a = t1.squaredNorm(), b = t1.dot(t2), c = t2.squaredNorm();
    const bool held1 = std::abs(xi) >= 1 && xi * g1 > 0, held2 = std::abs(eta) >= 1 && eta * g2 > 0;
    double s1 = 0, s2 = 0;
    if (!held1 && !held2) {
      const double det = a * c - b * b;
      s1 = (c * g1 - b * g2) / det;
      s2 = (a * g2 - b * g1) / det;
    } else if (!held1) {
      s1 = g1 / a;
    } else if (!held2) {
      s2 = g2 / c;
    }
    const double xi1 = std::clamp(xi + s1, -1.0, 1.0), eta1 = std::clamp(eta + s2, -1.0, 1.0);
    const double moved = std::abs(xi1 - xi) + std::abs(eta1 - eta);
    xi = xi1;
    eta = eta1;
    if (moved < 1e-14) break;
  }
  SurfacePoint s{.face = f, .xi = xi, .eta = eta, .weights = bilinear_weights(xi, eta), .position = {}, .normal = {}, .distance = 0};
  const auto d = bilinear_derivatives(xi, eta);
  s.position = at(s.weights);
  s.normal = at(d.xi).cross(at(d.eta)).normalized();
  s.distance = (p - s.position).norm();
  return s;
}

SurfacePoint SurfaceTree::nearest(const Point& p, const Point& tangent) const {
  const auto gap = [&](const Box& b) { return (b.low - p).cwiseMax(p - b.high).cwiseMax(0.0).norm(); };
  const double tie = 1e-7 * (boxes_[0].high - boxes_[0].low).norm();
  SurfacePoint best;
  best.distance = 1e300;
  std::vector<std::int32_t> stack{0};
  while (!stack.empty()) {
    const Box& box = boxes_[std::size_t(stack.back())];
    stack.pop_back();
    if (gap(box) > best.distance + tie) continue;
    if (box.left < 0) {
      for (auto i = box.begin; i < box.end; ++i) {
        const SurfacePoint s = project(order_[std::size_t(i)], p);
        const bool nearer = s.distance < best.distance - tie;
        const bool tied = !nearer && s.distance < best.distance + tie;
        const double along = std::abs(s.normal.dot(tangent)), best_along = best.face < 0 ? 2 : std::abs(best.normal.dot(tangent));
        if (nearer || (tied && (along < best_along - 1e-6 || (along < best_along + 1e-6 && s.face < best.face)))) best = s;
      }
      continue;
    }
    const bool left_first = gap(boxes_[std::size_t(box.left)]) <= gap(boxes_[std::size_t(box.right)]);
    const auto near = left_first ? box.left : box.right, far = left_first ? box.right : box.left;
    stack.push_back(far);
    stack.push_back(near);
  }
  return best;
}

std::span<const std::int32_t> SurfaceTree::faces_at(NodeId node) const {
  const auto i = std::size_t(std::lower_bound(node_.begin(), node_.end(), node) - node_.begin());
  expect(i < node_.size() && node_[i] == node, "the node lies on the surface");
  return std::span(node_faces_).subspan(std::size_t(node_begin_[i]), std::size_t(node_begin_[i + 1] - node_begin_[i]));
}

}  // namespace calomel
