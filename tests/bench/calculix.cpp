// The same meshes and loads in an independent finite-element program: CalculiX, explicit dynamics (Dhondt, CalculiX CrunchiX
// User's Manual, version 2.20). Strain histories compared, speeds beside each other, pictures written.
//
//   bench_calculix [FOLDER [CASE]]      pictures and decks go to FOLDER (default: the present one), CASE: steel, liquid or box
//
// `ccx` must be in the path (Debian: calculix-ccx); nothing is compared without it.
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "base/artefact.hpp"
#include "base/errors.hpp"
#include "forward/mesh/assemble_mesh.hpp"
#include "forward/mesh/file_order.hpp"
#include "forward/mesh/make_mesh.hpp"
#include "forward/mesh/topology.hpp"
#include "forward/mesh/write_mesh.hpp"
#include "forward/solver/explicit_solver.hpp"
#include "tests/bench/line_plot.hpp"

using namespace calomel;

namespace {

constexpr double steel_density = 7960, young = 193e9, poisson = 0.29, mercury_density = 13500, mercury_speed = 1450;
constexpr double bulk_modulus = mercury_density * mercury_speed * mercury_speed;
constexpr double shear_share = 1e-5;  ///< G / K of the elastic body that represents the liquid

/// Relative strain over a pair of nodes.
struct Gauge {
  std::string name;
  NodeId from, to;
};

struct Case {
  std::string name, what;
  Mesh mesh;
  std::string steel_type = "C3D8", mercury_type = "C3D8R";  ///< elements of CalculiX
  History load;                                             ///< of the loaded faces [Pa], tension positive; empty: none
  double heating = 0;                                       ///< pressure that the heat would cause in the mercury [Pa]
  double ramp = 0;                                          ///< rise time of the heating [s]
  double end = 0, output_interval = 0, ccx_step = 0;
  std::vector<Gauge> gauges;
};

struct Result {
  std::vector<double> time;
  std::vector<std::vector<double>> strain;  ///< (gauge, time)
  double speed = 0;                         ///< [element-steps/s] of processor time, one thread
  double steps = 0;
};

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Processor time of all finished children [s].
double children_seconds() {
  rusage use{};
  ::getrusage(RUSAGE_CHILDREN, &use);
  return double(use.ru_utime.tv_sec + use.ru_stime.tv_sec) + 1e-6 * double(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
}

NodeId nearest(const Mesh& mesh, const Vec3& x) {
  NodeId best = 0;
  const auto distance = [&](NodeId n) { return (hexahedron::point(mesh.nodes[std::size_t(n)]) - hexahedron::point(x)).norm(); };
  for (NodeId n = 1; n < NodeId(mesh.nodes.size()); ++n)
    if (distance(n) < distance(best) * (1 - 1e-9)) best = n;
  return best;
}

Gauge gauge(const Mesh& mesh, const std::string& name, const Vec3& at, int axis, double length) {
  Vec3 a = at, b = at;
  a[std::size_t(axis)] -= length / 2;
  b[std::size_t(axis)] += length / 2;
  return {name, nearest(mesh, a), nearest(mesh, b)};
}

ObservationRow row_of(const Mesh& mesh, const Gauge& g) {
  const hexahedron::Point d = hexahedron::point(mesh.nodes[std::size_t(g.to)]) - hexahedron::point(mesh.nodes[std::size_t(g.from)]);
  const hexahedron::Point w = d / d.squaredNorm();
  return {{g.from, g.to}, {hexahedron::vec3(-w), hexahedron::vec3(w)}};
}

/// A block of one material from x = 0; the part z < loaded_height of its face x = 0 is loaded.
Mesh block(const Vec3& size, double h, Region region, bool confined, double loaded_height) {
  BareGrid grid;
  std::array<int, 3> n{};
  for (std::size_t k = 0; k < 3; ++k) n[k] = int(std::lround(size[k] / h));
  const auto node = [&](int i, int j, int k) { return NodeId((k * (n[1] + 1) + j) * (n[0] + 1) + i); };
  for (int k = 0; k <= n[2]; ++k)
    for (int j = 0; j <= n[1]; ++j)
      for (int i = 0; i <= n[0]; ++i) {
        grid.nodes.push_back({h * i, h * j, h * k});
        if (i == n[0] || j == n[1] || k == n[2]) continue;
        grid.elements.push_back({node(i, j, k), node(i + 1, j, k), node(i, j + 1, k), node(i + 1, j + 1, k), node(i, j, k + 1), node(i + 1, j, k + 1),
                                 node(i, j + 1, k + 1), node(i + 1, j + 1, k + 1)});
        grid.region.push_back(region);
      }
  AssemblyOptions options;
  options.boundary = [&](const hexahedron::Point&, const hexahedron::Point& normal) {
    if (confined && std::abs(normal.y()) > 0.5) return BoundaryKind::symmetry_y;
    if (confined && std::abs(normal.z()) > 0.5) return BoundaryKind::symmetry_z;
    return BoundaryKind::free_end;
  };
  Mesh mesh = assemble_mesh(std::move(grid), options);
  for (FaceId f = 0; f < FaceId(6 * mesh.elements.size()); ++f) {
    const Face face{.nodes = face_nodes(mesh.elements, f), .element = element_of(f)};
    const auto c = hexahedron::centre(mesh, face);
    if (c.x() < 1e-9 && c.z() < loaded_height) mesh.loaded.push_back(face);
  }
  return mesh;
}

/// -pressure with a smooth rise (sin^2) over `rise`, or at once.
History pressure(double size, double rise, double end) {
  History h;
  constexpr int pieces = 40;
  for (int i = 0; i <= pieces && rise > 0; ++i) h.time.push_back(rise * i / pieces), h.value.push_back(-size * std::pow(std::sin(M_PI / 2 * i / pieces), 2));
  if (rise == 0) h.time = {0}, h.value = {-size};
  h.time.push_back(2 * end);
  h.value.push_back(-size);
  return h;
}

Result run_own(const Case& c) {
  RunSetup s;
  s.steel_density = steel_density;
  s.liquid_density = mercury_density;
  s.steel = LinearElastic::from_young(young, poisson);
  s.liquid = {bulk_modulus, std::numeric_limits<double>::infinity(), 0};
  s.hourglass = 0.02;  // as in docs/benchmarks/calculix.md
  s.end_stress = c.load;
  s.end = c.end;
  s.output_interval = c.output_interval;
  if (c.heating > 0) {
    s.p0.assign(c.mesh.elements.size(), 0);
    for (std::size_t e = 0; e < s.p0.size(); ++e)
      if (c.mesh.region[e] == Region::mercury) s.p0[e] = c.heating;
    s.pulse_length = c.ramp;
  }
  std::vector<ObservationRow> rows;
  for (const auto& g : c.gauges) rows.push_back(row_of(c.mesh, g));
  const ExplicitSolver solver(c.mesh, s.steel, 1, 0);  // elements at inner corners as they are
  const auto summary = solver.solve(s, rows, {});
  Result r{.time = summary.times, .strain = {}, .speed = 0, .steps = double(summary.steps)};
  for (const double begin = now(); now() < begin + 1;)
    r.speed = std::max(r.speed, double(c.mesh.elements.size()) * r.steps / solver.solve(s, rows, {}).processor_seconds);
  for (std::size_t g = 0; g < rows.size(); ++g) {
    const auto first = summary.observations.begin() + std::ptrdiff_t(g * r.time.size());
    r.strain.emplace_back(first, first + std::ptrdiff_t(r.time.size()));
  }
  return r;
}

std::string amplitude(const std::string& name, const std::vector<double>& time, const std::vector<double>& value) {
  std::string s = "*AMPLITUDE, NAME=" + name + '\n';
  for (std::size_t i = 0; i < time.size(); ++i) s += fmt::format("{:.12g}, {:.12g}\n", time[i], value[i]);
  return s;
}

/// The deck: our own mesh file with materials, load and step added. `mesh` shares the nodes of wetted faces, so that the
/// numbers in the file are those of the mesh, counted from 1.
void write_deck(const Case& c, const std::filesystem::path& path, double end) {
  expect(c.mesh.slip.empty(), "the mesh has no split nodes");
  write_abaqus_mesh(c.mesh, path);
  std::string s = read_text(path);
  for (const auto& [set, type] : {std::pair{"steel", c.steel_type}, {"mercury", c.mercury_type}})
    if (const auto at = s.find(fmt::format("TYPE=C3D8, ELSET={}", set)); at != std::string::npos) s.replace(at, 9, "TYPE=" + type);
  s += "*NSET, NSET=gauges\n";
  for (const auto& g : c.gauges) s += fmt::format("{},\n{},\n", g.from + 1, g.to + 1);
  s += fmt::format("*NSET, NSET=everything, GENERATE\n1, {}\n", c.mesh.nodes.size());
  const double G = shear_share * bulk_modulus, E = 9 * bulk_modulus * G / (3 * bulk_modulus + G),
               nu = (3 * bulk_modulus - 2 * G) / (2 * (3 * bulk_modulus + G));
  const bool steel = c.mesh.quality.steel_volume > 0, mercury = c.mesh.quality.mercury_volume > 0;
  if (steel)
    s += fmt::format("*MATERIAL, NAME=STEEL\n*ELASTIC\n{}, {}\n*DENSITY\n{}\n*EXPANSION\n0.\n*SOLID SECTION, ELSET=steel, MATERIAL=STEEL\n", young, poisson,
                     steel_density);
  if (mercury)
    s += fmt::format("*MATERIAL, NAME=MERCURY\n*ELASTIC\n{:.14g}, {:.14g}\n*DENSITY\n{}\n*EXPANSION\n1e-5\n*SOLID SECTION, ELSET=mercury, MATERIAL=MERCURY\n",
                     E, nu, mercury_density);
  const char* axes[] = {"symmetry_x", "symmetry_y", "symmetry_z"};
  for (int k = 0; k < 3; ++k)
    if (s.find(fmt::format("NSET={}", axes[k])) != std::string::npos) s += fmt::format("*BOUNDARY\n{}, {}, {}\n", axes[k], k + 1, k + 1);
  if (c.heating > 0) s += amplitude("heat", {0, c.ramp, 2 * c.end}, {0, 1, 1}) + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\neverything, 0.\n";
  if (!c.load.time.empty()) s += amplitude("rise", c.load.time, c.load.value);
  const auto steps = std::int64_t(std::lround(end / c.ccx_step));
  s += fmt::format("*STEP, INC={}\n*DYNAMIC, DIRECT, EXPLICIT, ALPHA=0\n{:.12g}, {:.12g}, 1e-15, {:.12g}\n", 2 * steps + 10, c.ccx_step, end, c.ccx_step);
  if (!c.load.time.empty()) {
    s += "*DLOAD, AMPLITUDE=rise\n";
    for (const auto& f : c.mesh.loaded)
      s += fmt::format("{}, P{}, -1.\n", f.element + 1, file_order::abaqus_side[std::size_t(side_of(face_id(c.mesh.elements, f)))]);
  }
  // p0 = 3 K alpha dT.
  if (c.heating > 0) s += fmt::format("*TEMPERATURE, AMPLITUDE=heat\neverything, {:.14g}\n", c.heating / (3 * bulk_modulus * 1e-5));
  s += fmt::format("*NODE PRINT, NSET=gauges, FREQUENCY={}\nU\n*END STEP\n", std::lround(c.output_interval / c.ccx_step));
  std::ofstream(path) << s;
}

/// Displacements by time and node from a .dat file.
std::map<long, std::map<NodeId, Vec3>> read_displacements(const std::filesystem::path& path, double output_interval) {
  std::ifstream in(path);
  std::map<long, std::map<NodeId, Vec3>> all;
  long at = -1;
  for (std::string line; std::getline(in, line);) {
    if (const auto found = line.find("and time"); found != std::string::npos) {
      at = std::lround(std::stod(line.substr(found + 8)) / output_interval);
      continue;
    }
    std::istringstream words(line);
    NodeId n = 0;
    Vec3 u{};
    if (words >> n >> u[0] >> u[1] >> u[2]) all[at][n - 1] = u;
  }
  return all;
}

/// Processor seconds of one call.
double call_ccx(const std::filesystem::path& folder) {
  std::filesystem::remove(folder / "deck.dat");
  const double begin = children_seconds();
  const int status = std::system(("cd '" + folder.string() + "' && OMP_NUM_THREADS=1 CCX_NPROC_RESULTS=1 ccx deck > deck.log 2>&1").c_str());
  const double seconds = children_seconds() - begin;
  if (status != 0 || read_text(folder / "deck.log").find("*ERROR") != std::string::npos)
    throw NumericsError("ccx failed: " + read_text(folder / "deck.log").substr(0, 2000));
  return seconds;
}

Result run_ccx(const Case& c, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  // The time loop alone: the whole run less a run of half the time.
  write_deck(c, folder / "deck.inp", c.end / 2);
  const double half = call_ccx(folder);
  write_deck(c, folder / "deck.inp", c.end);
  const double whole = call_ccx(folder);
  const auto u = read_displacements(folder / "deck.dat", c.output_interval);
  Result r;
  r.steps = std::round(c.end / c.ccx_step);
  r.speed = double(c.mesh.elements.size()) * r.steps / 2 / std::max(whole - half, 1e-3);
  r.strain.assign(c.gauges.size(), {});
  for (long k = 0; k <= std::lround(c.end / c.output_interval); ++k) {
    r.time.push_back(double(k) * c.output_interval);
    for (std::size_t g = 0; g < c.gauges.size(); ++g) {
      const auto row = row_of(c.mesh, c.gauges[g]);
      double strain = 0;
      if (k > 0)
        for (std::size_t i = 0; i < 2; ++i) strain += hexahedron::point(row.weights[i]).dot(hexahedron::point(u.at(k).at(row.nodes[i])));
      r.strain[g].push_back(strain);
    }
  }
  return r;
}

double relative_l2(const std::vector<double>& a, const std::vector<double>& b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference += std::pow(a[i] - b[i], 2), size += b[i] * b[i];
  return std::sqrt(difference / size);
}

std::string types_of(const Case& c) {
  return (c.mesh.quality.steel_volume > 0 ? c.steel_type : "") + (c.mesh.quality.steel_volume > 0 && c.mesh.quality.mercury_volume > 0 ? ", " : "") +
         (c.mesh.quality.mercury_volume > 0 ? c.mercury_type : "");
}

void compare(const Case& c, const std::filesystem::path& pictures, bool picture) {
  const Result own = run_own(c), other = run_ccx(c, pictures / ("calculix_" + c.name));
  std::string errors;
  std::vector<PlotPanel> panels;
  for (std::size_t g = 0; g < c.gauges.size(); ++g) {
    errors += fmt::format("{}{:.2f}", g ? " / " : "", 100 * relative_l2(own.strain[g], other.strain[g]));
    PlotPanel panel{.title = c.gauges[g].name, .time = {}, .solid = own.strain[g], .dashed = other.strain[g]};
    for (const double t : own.time) panel.time.push_back(1e6 * t);
    for (auto* v : {&panel.solid, &panel.dashed})
      for (double& x : *v) x *= 1e6;
    panels.push_back(std::move(panel));
  }
  fmt::print("| {} | {} | {} | {} | {:.1f} | {:.3f} | {:.0f} |\n", c.what, types_of(c), c.mesh.elements.size(), errors, own.speed / 1e6, other.speed / 1e6,
             own.speed / other.speed);
  std::fflush(stdout);
  if (picture) write_atomically(pictures / fmt::format("calculix_{}.svg", c.name), line_plot("Calomel", "CalculiX", "1e-6", panels));
}

/// Steel 60 x 20 x 20 mm, pressed at one end.
Case steel_block(double h, double rise, const std::string& type) {
  Case c{.name = "steel",
         .what = fmt::format("steel block, {:g} mm, {}", 1e3 * h, rise > 0 ? fmt::format("rise {:g} µs", 1e6 * rise) : "step"),
         .mesh = {},
         .steel_type = type};
  c.mesh = block({0.06, 0.02, 0.02}, h, Region::steel, false, 1);
  c.end = 40e-6;
  c.output_interval = 0.5e-6;
  c.ccx_step = 25e-9 * h / 0.001;
  c.load = pressure(10e6, rise, c.end);
  c.gauges = {gauge(c.mesh, "x = 20 mm, along x", {0.02, 0.012, 0.02}, 0, 0.008), gauge(c.mesh, "x = 40 mm, along x", {0.04, 0.012, 0.02}, 0, 0.008),
              gauge(c.mesh, "x = 28 mm, along y", {0.028, 0.008, 0.02}, 1, 0.008)};
  return c;
}

/// Liquid between rigid smooth walls, pressed over half of its end: waves in two dimensions.
Case liquid_block(double h, double rise, const std::string& type) {
  Case c{.name = "liquid", .what = fmt::format("liquid block, {:g} mm, rise {:g} µs", 1e3 * h, 1e6 * rise), .mesh = {}, .mercury_type = type};
  c.mesh = block({0.06, 0.008, 0.024}, h, Region::mercury, true, 0.012);
  c.end = 80e-6;
  c.output_interval = 1e-6;
  c.ccx_step = 0.05e-6 * h / 0.001;
  c.load = pressure(1e6, rise, c.end);
  c.gauges = {gauge(c.mesh, "x = 20 mm, z = 0, along x", {0.02, 0, 0}, 0, 0.008), gauge(c.mesh, "x = 40 mm, z = 24 mm, along x", {0.04, 0, 0.024}, 0, 0.008),
              gauge(c.mesh, "x = 20 mm, z = 8 mm, along z", {0.02, 0, 0.008}, 2, 0.008)};
  return c;
}

/// A closed half box of 4 mm walls, shared nodes, its mercury heated evenly.
Case heated_box(double h, const std::string& type) {
  Case c{.name = "box", .what = fmt::format("steel box of mercury, {:g} mm, heated", 1e3 * h), .mesh = {}, .steel_type = type};
  GeometryOptions g;
  g.kind = "box";
  g.length = 0.06;
  g.width = 0.048;
  g.height = 0.04;
  g.wall = 0.004;
  g.element_size = h;
  g.rear = "wall";
  g.half = true;
  g.wetted = "tied";
  c.mesh = make_mesh(g);
  c.heating = 10e6;
  c.ramp = 4e-6;
  c.end = 50e-6;
  c.output_interval = 1e-6;
  c.ccx_step = type == "C3D8I" ? 25e-9 : 0.1e-6;
  c.gauges = {gauge(c.mesh, "top, middle, along x", {0.03, 0, 0.04}, 0, 0.008), gauge(c.mesh, "top, x = 16 mm, along x", {0.016, 0.008, 0.04}, 0, 0.008),
              gauge(c.mesh, "front, middle, along z", {0, 0, 0.02}, 2, 0.008)};
  return c;
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path folder = argc > 1 ? argv[1] : ".";
  const std::string only = argc > 2 ? argv[2] : "";
  const auto wanted = [&](const char* name) { return only.empty() || only == name; };
  if (std::system("command -v ccx > /dev/null") != 0) {
    fmt::print("ccx is not in the path: nothing is compared (Debian: calculix-ccx)\n");
    return 0;
  }
  make_directory(folder);
  fmt::print(
      "| case | elements of CalculiX | elements | relative L2 of the strain, gauge by gauge [%] | Calomel [M element-steps/s] | CalculiX | ratio "
      "|\n|---|---|---|---|---|---|---|\n");
  if (wanted("steel")) {
    for (const double h : {0.004, 0.002, 0.00125}) compare(steel_block(h, 4e-6, "C3D8"), folder, h == 0.002);
    compare(steel_block(0.002, 4e-6, "C3D8R"), folder, false);
    compare(steel_block(0.002, 0, "C3D8"), folder, false);
  }
  if (wanted("liquid")) {
    for (const double h : {0.004, 0.002, 0.001}) compare(liquid_block(h, 10e-6, "C3D8R"), folder, h == 0.002);
    compare(liquid_block(0.002, 10e-6, "C3D8"), folder, false);
  }
  if (wanted("box")) {
    for (const double h : {0.004, 0.002}) compare(heated_box(h, "C3D8"), folder, false);
    for (const double h : {0.004, 0.002}) compare(heated_box(h, "C3D8I"), folder, h == 0.002);
  }
  return 0;
}
