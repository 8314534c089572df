#include "tests/verification/small_runs.hpp"

#include <iostream>
#include <map>

#include "base/linear_algebra.hpp"

namespace calomel::testing {

void measured(const std::string& what, double value) {
  std::cout << "[ measured ] " << what << " = " << value << '\n';
  ::testing::Test::RecordProperty(what, std::to_string(value));
}

Mesh block(std::array<int, 3> n, const Vec3& low, const Vec3& high, const std::function<Region(const Vec3&)>& region_at) {
  Mesh m;
  const auto node = [&](int i, int j, int k) { return NodeId((k * (n[1] + 1) + j) * (n[0] + 1) + i); };
  for (int k = 0; k <= n[2]; ++k)
    for (int j = 0; j <= n[1]; ++j)
      for (int i = 0; i <= n[0]; ++i)
        m.nodes.push_back({low[0] + (high[0] - low[0]) * i / n[0], low[1] + (high[1] - low[1]) * j / n[1], low[2] + (high[2] - low[2]) * k / n[2]});
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        std::array<NodeId, 8> e;
        for (int a = 0; a < 8; ++a) e[std::size_t(a)] = node(i + (a & 1), j + (a >> 1 & 1), k + (a >> 2));
        m.elements.push_back(e);
        const Vec3 &a = m.nodes[std::size_t(e[0])], &b = m.nodes[std::size_t(e[7])];
        m.region.push_back(region_at({(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2}));
      }
  m.fixed.assign(m.nodes.size(), 0);
  m.liquid_element_size = (high[0] - low[0]) / n[0];
  return m;
}

Mesh block(std::array<int, 3> n, const Vec3& low, const Vec3& high, Region region) {
  return block(n, low, high, [region](const Vec3&) { return region; });
}

void fix(Mesh& mesh, int bits, const std::function<bool(const Vec3&)>& where) {
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (where(mesh.nodes[n])) mesh.fixed[n] |= std::uint8_t(bits);
}

void split(Mesh& mesh, const std::vector<Vec3>& normals) {
  std::vector<std::uint8_t> touches(mesh.nodes.size(), 0);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    for (const NodeId n : mesh.elements[e]) touches[std::size_t(n)] |= mesh.region[e] == Region::steel ? 1 : 2;
  std::map<NodeId, NodeId> own;
  for (std::size_t n = 0; n < touches.size(); ++n)
    if (touches[n] == 3) {
      own[NodeId(n)] = NodeId(mesh.nodes.size());
      SlipPair pair{NodeId(n), NodeId(mesh.nodes.size()), int(normals.size()), {}};
      std::copy(normals.begin(), normals.end(), pair.normals.begin());
      mesh.slip.push_back(pair);
      mesh.nodes.push_back(Vec3(mesh.nodes[n]));
      mesh.fixed.push_back(std::uint8_t(mesh.fixed[n]));
    }
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    if (mesh.region[e] == Region::mercury)
      for (auto& n : mesh.elements[e])
        if (own.contains(n)) n = own[n];
}

std::vector<Face> faces_at(const Mesh& mesh, int axis, double at) {
  std::vector<Face> faces;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    Face f{.nodes = {}, .element = std::int32_t(e)};
    const auto& corners = hexahedron::faces[std::size_t(2 * axis + 1)];
    bool all = true;
    for (std::size_t k = 0; k < 4; ++k) {
      f.nodes[k] = mesh.elements[e][std::size_t(corners[k])];
      all = all && std::abs(mesh.nodes[std::size_t(f.nodes[k])][std::size_t(axis)] - at) < 1e-9;
    }
    if (all) faces.push_back(f);
  }
  return faces;
}

std::vector<Vec3> field(const Mesh& mesh, const std::function<Vec3(const Vec3&)>& f) {
  std::vector<Vec3> out;
  for (const auto& x : mesh.nodes) out.push_back(f(x));
  return out;
}

NodeId nearest(const Mesh& mesh, const Vec3& x) {
  const auto distance = [&](std::size_t n) { return (hexahedron::point(mesh.nodes[n]) - hexahedron::point(x)).squaredNorm(); };
  std::size_t best = 0;
  for (std::size_t n = 1; n < mesh.nodes.size(); ++n)
    if (distance(n) < distance(best) * (1 - 1e-9) - 1e-24) best = n;
  return NodeId(best);
}

ObservationRow component(NodeId node, int axis, double weight) {
  Vec3 w{};
  w[std::size_t(axis)] = weight;
  return {{node}, {w}};
}

std::vector<ObservationRow> all_components(const Mesh& mesh) {
  std::vector<ObservationRow> rows;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    for (int c = 0; c < 3; ++c) rows.push_back(component(NodeId(n), c));
  return rows;
}

RunSetup linear_setup(double end, double output_interval) {
  RunSetup s;
  s.steel_density = steel_density;
  s.liquid_density = mercury_density;
  s.steel = steel();
  s.liquid = {mercury_density * mercury_speed * mercury_speed, std::numeric_limits<double>::infinity(), 0};
  s.end = end;
  s.output_interval = output_interval;
  return s;
}

std::vector<Vec3> final_displacement(const Mesh& mesh, const SolveSummary& s) {
  std::vector<Vec3> u(mesh.nodes.size());
  for (std::size_t n = 0; n < u.size(); ++n)
    for (std::size_t c = 0; c < 3; ++c) u[n][c] = s.observations[(3 * n + c + 1) * s.times.size() - 1];
  return u;
}

Eigen::VectorXd masses(const Mesh& mesh, const RunSetup& setup) {
  Eigen::VectorXd m = Eigen::VectorXd::Zero(Eigen::Index(mesh.nodes.size()));
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    for (const NodeId n : mesh.elements[e])
      m[n] += (mesh.region[e] == Region::steel ? setup.steel_density : setup.liquid_density) * hexahedron::volume(hexahedron::corners(mesh, e)) / 8;
  return m;
}

Eigen::VectorXd accelerations(const ExplicitSolver& solver, RunSetup setup, const std::vector<Vec3>& displacement, const SolveOptions& options) {
  const Mesh& mesh = solver.mesh();
  const double dt = 0.5 * solver.stable_step(setup, options);
  setup.initial_displacement = displacement;
  setup.end = setup.output_interval = dt;
  const auto s = solver.solve(setup, all_components(mesh), options);
  expect(s.steps == 1, "one step is taken");
  Eigen::VectorXd a(Eigen::Index(3 * mesh.nodes.size()));
  for (Eigen::Index i = 0; i < a.size(); ++i) a[i] = (s.observations[std::size_t(2 * i + 1)] - s.observations[std::size_t(2 * i)]) * 2 / (dt * dt);
  return a;
}

Eigen::MatrixXd stiffness(const ExplicitSolver& solver, const RunSetup& setup) {
  const Mesh& mesh = solver.mesh();
  const auto m = masses(mesh, setup);
  const Eigen::Index n = Eigen::Index(3 * mesh.nodes.size());
  Eigen::MatrixXd k(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    std::vector<Vec3> u(mesh.nodes.size());
    u[std::size_t(j / 3)][std::size_t(j % 3)] = 1e-3;
    const auto a = accelerations(solver, setup, u);
    for (Eigen::Index i = 0; i < n; ++i) k(i, j) = -a[i] * m[i / 3] / 1e-3;
  }
  return k;
}

double fitted_frequency(std::span<const double> t, std::span<const double> y, double low, double high) {
  const auto residue = [&](double f) {
    Eigen::MatrixXd a(Eigen::Index(t.size()), 3);
    for (Eigen::Index i = 0; i < a.rows(); ++i) a.row(i) << 1, std::cos(2 * M_PI * f * t[std::size_t(i)]), std::sin(2 * M_PI * f * t[std::size_t(i)]);
    const Eigen::Map<const Eigen::VectorXd> b(y.data(), Eigen::Index(y.size()));
    const Eigen::VectorXd c = solve_symmetric(a.transpose() * a, Eigen::VectorXd(a.transpose() * b));
    return (a * c - b).squaredNorm();
  };
  constexpr int scan = 120;
  int best = 1;
  const auto at = [&](int i) { return low + (high - low) * i / scan; };
  for (int i = 2; i < scan; ++i)
    if (residue(at(i)) < residue(at(best))) best = i;
  double a = at(best - 1), b = at(best + 1);
  constexpr double golden = 0.6180339887498949;
  for (int i = 0; i < 40; ++i) {
    const double p = b - golden * (b - a), q = a + golden * (b - a);
    residue(p) < residue(q) ? b = q : a = p;
  }
  return (a + b) / 2;
}

}  // namespace calomel::testing
