#include "forward/mesh/exodus_fields.hpp"

#include <gmock/gmock.h>
#include <netcdf.h>

#include "base/netcdf_file.hpp"
#include "forward/mesh/hexahedron.hpp"
#include "forward/mesh/make_mesh.hpp"
#include "tests/scratch.hpp"

using namespace calomel;

namespace {
GeometryOptions half_box() {
  GeometryOptions g;
  g.kind = "box";
  g.length = 0.05;
  g.width = 0.04;
  g.height = 0.03;
  g.wall = 0.004;
  g.element_size = 0.006;
  g.half = true;
  return g;
}
/// Returns the rows of a character variable.
std::vector<std::string> names_in(const std::filesystem::path& path, const char* variable) {
  int file = 0, id = 0;
  std::array<int, 2> dims{};
  std::array<std::size_t, 2> n{};
  EXPECT_EQ(nc_open(path.c_str(), NC_NOWRITE, &file), NC_NOERR);
  EXPECT_EQ(nc_inq_varid(file, variable, &id), NC_NOERR);
  nc_inq_vardimid(file, id, dims.data());
  for (std::size_t k = 0; k < 2; ++k) nc_inq_dimlen(file, dims[k], &n[k]);
  std::vector<char> text(n[0] * n[1] + 1, 0);
  nc_get_var_text(file, id, text.data());
  nc_close(file);
  std::vector<std::string> rows;
  for (std::size_t i = 0; i < n[0]; ++i) rows.emplace_back(text.data() + i * n[1]);
  return rows;
}
}  // namespace

TEST(ExodusFieldWriter, WritesWhatAnExodusReaderFinds) {
  const Mesh m = make_mesh(half_box());
  const auto path = scratch_file("fields.exo");
  std::filesystem::remove(path);
  std::vector<Vec3> u, v;
  for (const auto& x : m.nodes) u.push_back({x[0], 2 * x[1], 3 * x[2]}), v.push_back({1, 2, x[0]});
  std::vector<double> p(m.elements.size()), s(m.elements.size());
  for (std::size_t e = 0; e < p.size(); ++e) p[e] = double(e), s[e] = -double(e);
  {
    ExodusFieldWriter w(path, m);
    w.write_step({.time = 0, .displacement = u, .velocity = v, .pressure = p, .effective_stress = s});
    for (auto& x : u) x[0] += 1;
    w.write_step({.time = 2e-5, .displacement = u, .velocity = v, .pressure = p, .effective_stress = s});
    EXPECT_FALSE(std::filesystem::exists(path));
    w.commit();
  }
  const NetcdfReader r(path);
  EXPECT_THAT(r.doubles("time_whole"), ::testing::Pointwise(::testing::DoubleNear(1e-11), {0.0, 2e-5}));
  EXPECT_THAT(names_in(path, "name_nod_var"),
              ::testing::ElementsAre("displacement_x", "displacement_y", "displacement_z", "velocity_x", "velocity_y", "velocity_z"));
  EXPECT_THAT(names_in(path, "name_elem_var"), ::testing::ElementsAre("pressure", "effective_stress"));
  EXPECT_THAT(names_in(path, "eb_names"), ::testing::ElementsAre("steel", "mercury"));
  EXPECT_THAT(names_in(path, "ns_names"), ::testing::ElementsAre("symmetry_y"));
  EXPECT_THAT(names_in(path, "ss_names"), ::testing::ElementsAre("outer", "wetted", "rear"));
  EXPECT_EQ(r.shape("coordx").at(0), m.nodes.size());
  const auto ux = r.doubles("vals_nod_var1"), uz = r.doubles("vals_nod_var3"), vz = r.doubles("vals_nod_var6");
  ASSERT_EQ(ux.size(), 2 * m.nodes.size());
  for (std::size_t n = 0; n < m.nodes.size(); ++n) {
    EXPECT_NEAR(ux[n], m.nodes[n][0], 1e-8);
    EXPECT_NEAR(ux[m.nodes.size() + n], 1 + m.nodes[n][0], 1e-6);
    EXPECT_NEAR(uz[n], 3 * m.nodes[n][2], 1e-8);
    EXPECT_NEAR(vz[n], m.nodes[n][0], 1e-8);
  }
  // Element fields are stored block by block. The corners of an element go round the bottom and then round the top.
  const auto steel = r.doubles("vals_elem_var1eb1"), mercury = r.doubles("vals_elem_var2eb2");
  const auto connect = r.integers("connect1");
  const auto x = r.doubles("coordx"), y = r.doubles("coordy"), z = r.doubles("coordz");
  std::size_t i = 0, j = 0;
  for (std::size_t e = 0; e < m.elements.size(); ++e) {
    if (m.region[e] == Region::mercury) {
      EXPECT_EQ(mercury[j++], -double(e));
      continue;
    }
    hexahedron::Corners c;
    const std::array<std::size_t, 8> ours{0, 1, 3, 2, 4, 5, 7, 6};
    for (std::size_t a = 0; a < 8; ++a) {
      const auto n = std::size_t(connect[8 * i + a] - 1);
      c[ours[a]] = {x[n], y[n], z[n]};
    }
    EXPECT_GT(hexahedron::scaled_jacobian(c), 0.99);
    EXPECT_EQ(steel[i++], double(e));
  }
  EXPECT_EQ(2 * i, steel.size());
  EXPECT_EQ(2 * j, mercury.size());
  // The file has a node set of the symmetry plane and side sets of the outer, wetted and rear faces.
  const auto plane = r.integers("node_ns1");
  EXPECT_EQ(plane.size(), std::size_t(std::count(m.fixed.begin(), m.fixed.end(), 2)));
  for (const int n : plane) EXPECT_EQ(m.nodes[std::size_t(n - 1)][1], 0);
  EXPECT_EQ(r.integers("elem_ss1").size(), m.outer.size());
  EXPECT_EQ(r.integers("elem_ss3").size(), m.rear.size());
  for (const int side : r.integers("side_ss3")) EXPECT_EQ(side, 2);  // +x
}

TEST(ExodusFieldWriter, LeavesNothingBehindWithoutCommit) {
  const Mesh m = make_mesh(half_box());
  const auto path = scratch_file("dropped.exo");
  { const ExodusFieldWriter w(path, m); }
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_FALSE(std::filesystem::exists(path.string() + ".part"));
  EXPECT_THROW(ExodusFieldWriter("/proc/nowhere/fields.exo", m), InputError);
}

// A file that was left at any step, closed or not, is continued. Steps after the agreed one are overwritten.
TEST(ExodusFieldWriter, GoesOnWithAFileThatWasLeft) {
  const Mesh m = make_mesh(half_box());
  const auto path = scratch_file("gone_on_with.exo");
  std::filesystem::remove(path);
  std::vector<double> p(m.elements.size());
  const auto write = [&](ExodusFieldWriter& w, int step, double value) {
    std::fill(p.begin(), p.end(), value);
    w.write_step({.time = 1e-6 * step, .displacement = {}, .velocity = {}, .pressure = p, .effective_stress = {}, .time_at_cutoff = p});
  };
  {
    ExodusFieldWriter first(path, m);
    for (const int step : {1, 2, 3}) write(first, step, step);
    first.flush();
    first.leave();
  }
  {
    ExodusFieldWriter second(path, m, 2);
    write(second, 3, 30);
    write(second, 4, 40);
    second.commit();
  }
  const NetcdfReader r(path);
  EXPECT_THAT(names_in(path, "name_elem_var"), ::testing::ElementsAre("pressure", "time_at_cutoff"));
  ASSERT_EQ(r.doubles("time_whole").size(), 4u);
  const auto values = r.doubles("vals_elem_var2eb2");
  const std::size_t mercury = values.size() / 4;
  for (std::size_t t = 0; t < 4; ++t) EXPECT_EQ(values[t * mercury], (std::array{1.0, 2.0, 30.0, 40.0}[t]));
  EXPECT_FALSE(std::filesystem::exists(path.string() + ".part"));

  { ExodusFieldWriter(path, m).leave(); }
  EXPECT_THROW(ExodusFieldWriter(path, m, 1), InputError);  // the file has fewer steps than agreed
  GeometryOptions other = half_box();
  other.element_size = 0.005;
  const Mesh n = make_mesh(other);
  EXPECT_THROW(ExodusFieldWriter(path, n, 0), InputError);
  std::filesystem::remove(path.string() + ".part");
  EXPECT_THROW(ExodusFieldWriter(path, m, 0), InputError);
}
