// The results do not depend on the number of threads, the use of the SIMD lanes, the precision and the instruction set, within stated bounds.
#include <cstdlib>
#include <iostream>

#include "forward/mesh/make_mesh.hpp"
#include "forward/solver/load.hpp"
#include "tests/verification/rows.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

/// A plane-strain or solid box of mercury with an open rear end, observed at its outer nodes.
struct Box {
  explicit Box(bool plane_strain, double size) {
    GeometryOptions g;
    g.kind = "box";
    g.length = 0.08;
    g.width = 0.05;
    g.height = 0.04;
    g.wall = 0.004;
    g.plane_strain = plane_strain;
    g.half = !plane_strain;
    g.element_size = size;
    mesh = make_mesh(g);
    ProfileOptions profile;
    profile.center = {0, 0.02};
    profile.widths = {0.03, 0.015};
    setup = linear_setup(6e-5, 2e-6);
    setup.liquid.viscosity = 2000;
    for (const double v : heating_shape(mesh, profile).element) setup.p0.push_back(25e6 * v);
    setup.p0_at = [profile, plane_strain](const Vec3& x) { return 25e6 * profile.shape(x, plane_strain); };
    setup.pulse_length = 0.7e-6;
    for (std::size_t n = 0; n < mesh.nodes.size(); n += 97)
      for (int c = 0; c < 3; ++c)
        if (!(mesh.fixed[n] >> c & 1)) rows.push_back(component(NodeId(n), c));
  }
  [[nodiscard]] std::vector<double> run(int threads = 1, const std::string& precision = "double") const {
    SolveOptions o;
    o.threads = threads;
    o.precision = precision;
    return ExplicitSolver(mesh, steel(), threads).solve(setup, rows, o).observations;
  }
  Mesh mesh;
  RunSetup setup;
  std::vector<ObservationRow> rows;
};

/// || a - b || / || b ||
double difference(const std::vector<double>& a, const std::vector<double>& b) {
  const Eigen::Map<const Eigen::VectorXd> x(a.data(), Eigen::Index(a.size())), y(b.data(), Eigen::Index(b.size()));
  return (x - y).norm() / y.norm();
}

/// Sets CALOMEL_ISA for its lifetime.
class InstructionSet {
 public:
  explicit InstructionSet(const char* name) {
    if (const char* before = std::getenv("CALOMEL_ISA")) before_ = before;
    ::setenv("CALOMEL_ISA", name, 1);
  }
  ~InstructionSet() { before_ ? ::setenv("CALOMEL_ISA", before_->c_str(), 1) : ::unsetenv("CALOMEL_ISA"); }

 private:
  std::optional<std::string> before_;
};

}  // namespace

TEST(Reproducibility, AnyNumberOfThreadsGivesTheSameBits) {
  Box box(false, 0.0025);  // 16 x 32 x 10 layers: several blocks
  ASSERT_GT(box.mesh.elements.size(), 5000u);
  box.setup.liquid.tensile_cutoff = 1.5e5;
  for (const char* precision : {"double", "single"}) {
    const auto one = box.run(1, precision);
    EXPECT_EQ(box.run(2, precision), one) << precision;
    EXPECT_EQ(box.run(3, precision), one) << precision;
    // Control: the comparison detects a relative change of 1e-9 in the pulse (1e-6 in single precision).
    Box other = box;
    for (auto& p : other.setup.p0) p *= std::string(precision) == "double" ? 1 + 1e-9 : 1 + 1e-6;
    EXPECT_NE(other.run(1, precision), one) << precision;
  }
}

TEST(Reproducibility, EnsemblesOnAnyNumberOfThreadsGiveTheSameBits) {
  Box box(true, 0.002);
  box.setup.liquid.tensile_cutoff = 1.5e5;
  box.setup.energies = {0.98, 0.99, 1.0, 1.01, 1.02};
  const auto one = box.run(1);
  EXPECT_EQ(box.run(2), one);
  EXPECT_EQ(box.run(3), one);
}

TEST(Reproducibility, EightLanesAreEightSingleRuns) {
  for (const bool plane_strain : {true, false}) {
    Box box(plane_strain, plane_strain ? 0.002 : 0.004);
    const std::vector<double> energies{0.97, 0.98, 0.99, 1.0, 1.01, 1.02, 1.03, 1.05};
    box.setup.energies = energies;
    const auto group = box.run();
    const std::size_t each = group.size() / energies.size();
    for (std::size_t r = 0; r < energies.size(); ++r) {
      box.setup.energies = {energies[r]};
      const auto single = box.run();
      ASSERT_EQ(single.size(), each);
      const std::vector<double> lane(group.begin() + std::ptrdiff_t(r * each), group.begin() + std::ptrdiff_t((r + 1) * each));
      EXPECT_LT(difference(lane, single), 1e-9) << r;
      const std::vector<double> first(group.begin(), group.begin() + std::ptrdiff_t(each));
      EXPECT_EQ(difference(lane, first) < 1e-3, r == 0) << r;  // control: lanes differ
    }
  }
}

TEST(Reproducibility, SinglePrecisionIsCloseInTheLinearCase) {
  const Box box(true, 0.002);
  const double d = difference(box.run(1, "single"), box.run(1, "double"));
  Box lighter(true, 0.002);
  lighter.setup.liquid_density *= 1 - 1e-3;
  verify({.item = "Reproducibility",
          .quantity = "single against double precision, linear",
          .reference = 0,
          .source = "the same",
          .measured = d,
          .tolerance = 2e-5,
          .control = "density of the liquid -0.1 %",
          .control_value = difference(lighter.run(1, "double"), box.run(1, "double"))});
  EXPECT_GT(d, 1e-9);  // and it is single precision
}

TEST(Reproducibility, InstructionSetsAgreeToRounding) {
  for (const bool plane_strain : {true, false}) {
    const Box box(plane_strain, plane_strain ? 0.002 : 0.004);
    std::vector<std::vector<double>> runs, single;
    std::string used;
    for (const char* isa : {"baseline", "avx2", "avx512"}) {
      const InstructionSet set(isa);
      SolveOptions o;
      const auto s = ExplicitSolver(box.mesh, steel()).solve(box.setup, box.rows, o);
      used += s.kernel + ' ';
      runs.push_back(s.observations);
      single.push_back(box.run(1, "single"));
    }
    std::cout << "[ measured ] kernels = " << used << '\n';
    for (std::size_t i = 1; i < 3; ++i) {
      EXPECT_LT(difference(runs[i], runs[0]), 1e-10) << i;
      EXPECT_LT(difference(single[i], single[0]), 1e-4) << i;
    }
  }
}

TEST(Reproducibility, AnUnknownInstructionSetIsRefused) {
  const Box box(true, 0.004);
  const InstructionSet set("sse9");
  EXPECT_THROW((void)box.run(), InputError);
}
