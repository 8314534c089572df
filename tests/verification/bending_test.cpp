// A free plate of 100 x 5 mm in plane strain, against Timoshenko's beam with E' = E/(1 - nu^2) (physics.md section 4).
#include "base/linear_algebra.hpp"
#include "tests/verification/rows.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

constexpr double length = 0.1, thickness = 0.005;

/// First symmetric mode of a free Timoshenko beam about its middle: w = a cosh(p x) + b cos(q x), slope psi.
struct FreeBeam {
  double frequency = 0;
  double p = 0, q = 0, a = 0, b = 0, slope_p = 0, slope_q = 0;

  explicit FreeBeam(double shear_factor) {
    const double e = young / (1 - poisson * poisson), g = shear_factor * steel().mu;
    const double inertia = thickness * thickness / 12;  // I / A
    // w'''' + omega^2 rho (1/e + 1/g) w'' - omega^2 rho / (e inertia) (1 - omega^2 rho inertia / g) w = 0 (Timoshenko 1921)
    const auto solve = [&](double f) {
      const double w2 = std::pow(2 * M_PI * f, 2) * steel_density, s = w2 * (1 / e + 1 / g), r = w2 / (e * inertia) * (1 - w2 * inertia / g);
      p = std::sqrt(-s / 2 + std::sqrt(s * s / 4 + r));
      q = std::sqrt(s / 2 + std::sqrt(s * s / 4 + r));
      // shear force: g (w' - psi)' = -w2 w, so psi = slope_p sinh, slope_q sin
      // psi = a slope_p sinh(p x) - b slope_q sin(q x)
      slope_p = (p * p + w2 / g) / p;
      slope_q = (q * q - w2 / g) / q;
      const double l = length / 2;
      // psi' = 0 at the end fixes a : b, w' - psi = 0 is the condition.
      a = slope_q * q * std::cos(q * l);
      b = slope_p * p * std::cosh(p * l);
      return a * (p - slope_p) * std::sinh(p * l) - b * (q - slope_q) * std::sin(q * l);
    };
    double low = 1000, high = 4000;
    const bool sign = solve(low) > 0;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      (solve(middle) > 0) == sign ? low = middle : high = middle;
    }
    frequency = low;
    solve(low);
  }
  [[nodiscard]] double w(double x) const { return a * std::cosh(p * x) + b * std::cos(q * x); }
  [[nodiscard]] double psi(double x) const { return a * slope_p * std::sinh(p * x) - b * slope_q * std::sin(q * x); }
  [[nodiscard]] double curvature(double x) const { return a * slope_p * p * std::cosh(p * x) - b * slope_q * q * std::cos(q * x); }
};

struct Vibration {
  double frequency, surface_strain, centre_strain;  ///< strains over the theory's surface strain at the middle
};

Vibration vibrate(int through, int along, const LinearElastic& moduli) {
  const FreeBeam beam(5.0 / 6);
  Mesh mesh = block({along, 1, through}, {-length / 2, 0, 0}, {length / 2, length / along, thickness}, Region::steel);
  fix(mesh, 2, everywhere());
  const ExplicitSolver solver(mesh, moduli);
  RunSetup s = linear_setup(2.4e-3, 4e-6);
  s.steel = moduli;
  const double size = 1e-6 / beam.w(0);
  s.initial_displacement = field(mesh, [&](const Vec3& x) { return Vec3{-size * (x[2] - thickness / 2) * beam.psi(x[0]), 0, size * beam.w(x[0])}; });
  const double h = length / along, layer = thickness / through;
  const auto strain_row = [&](double z) {
    // over the two elements beside the middle
    ObservationRow r{{nearest(mesh, {h, 0, z}), nearest(mesh, {-h, 0, z})}, {{1 / (2 * h), 0, 0}, {-1 / (2 * h), 0, 0}}};
    return r;
  };
  ObservationRow centre = strain_row(thickness);
  const ObservationRow below = strain_row(thickness - layer);
  for (std::size_t i = 0; i < 2; ++i) centre.nodes.push_back(below.nodes[i]), centre.weights.push_back(below.weights[i]);
  for (auto& w : centre.weights) w[0] /= 2;
  const std::vector<ObservationRow> rows{component(nearest(mesh, {0, 0, thickness}), 2), strain_row(thickness), centre};
  const auto out = solver.solve(s, rows, {});
  Vibration v{};
  v.frequency = fitted_frequency(out.times, row_of(out, 0), 1500, 4000);
  // Amplitudes of the three rows at that frequency, with strain relative to deflection as in the theory.
  const auto amplitude = [&](std::span<const double> y) {
    Eigen::MatrixXd a(Eigen::Index(y.size()), 3);
    for (Eigen::Index i = 0; i < a.rows(); ++i)
      a.row(i) << 1, std::cos(2 * M_PI * v.frequency * out.times[std::size_t(i)]), std::sin(2 * M_PI * v.frequency * out.times[std::size_t(i)]);
    const Eigen::Vector3d c = solve_symmetric(a.transpose() * a, Eigen::VectorXd(a.transpose() * Eigen::Map<const Eigen::VectorXd>(y.data(), a.rows())));
    return std::hypot(c[1], c[2]);
  };
  const double mean_curvature = (beam.psi(h) - beam.psi(-h)) / (2 * h);
  const double theory = std::abs(thickness / 2 * mean_curvature / beam.w(0)) * amplitude(row_of(out, 0));
  v.surface_strain = amplitude(row_of(out, 1)) / theory;
  v.centre_strain = amplitude(row_of(out, 2)) / theory;
  return v;
}

constexpr double reference_frequency = 2619.7;  // Hz, physics.md section 4

}  // namespace

TEST(Bending, TheBeamTheoryHereGivesTheReferenceFrequency) {
  measured("timoshenko_frequency", FreeBeam(5.0 / 6).frequency);
  EXPECT_NEAR(FreeBeam(5.0 / 6).frequency, reference_frequency, 0.5);
}

TEST(Bending, FreePlateSwingsAtTheReferenceFrequencyWithTheRightSurfaceStrain) {
  std::vector<double> errors;
  for (const int through : {1, 2, 3}) {
    const auto v = vibrate(through, 20 * through, steel());
    errors.push_back(v.frequency / reference_frequency - 1);
    if (through == 2) {
      const auto spoiled = vibrate(2, 40, LinearElastic::from_young(1.03 * young, poisson));
      verify({.item = "Bending",
              .quantity = "free plate 100 x 5 mm, f1, 2 elements",
              .unit = "Hz",
              .reference = reference_frequency,
              .source = "Timoshenko",
              .measured = v.frequency,
              .tolerance = 0.01 * reference_frequency,
              .order = observed_order({1, 0.5}, errors),
              .control = "modulus +3 %",
              .control_value = spoiled.frequency});
      verify({.item = "Bending",
              .quantity = "its surface strain, 2 elements",
              .reference = 1,
              .source = "beam theory",
              .measured = v.surface_strain,
              .tolerance = 0.02,
              .control = "strain at the element's centre",
              .control_value = v.centre_strain});
    }
    // One element has (1 + 2) times the rotary inertia of its layer, lumped at the faces. The effect of 1.5 % in frequency is recorded without a bound.
    EXPECT_NEAR(v.frequency, reference_frequency, (through == 1 ? 0.02 : 0.01) * reference_frequency) << through;
    EXPECT_NEAR(v.surface_strain, 1, 0.02) << through;
    // Control: the strain at the centre of the element contains (n - 1)/n of the bending.
    EXPECT_NEAR(v.centre_strain, double(through - 1) / through, 0.02) << through;
  }
}

TEST(Bending, AWrongModulusIsDetected) {
  const auto v = vibrate(2, 40, LinearElastic::from_young(1.03 * young, poisson));
  EXPECT_GT(v.frequency, 1.01 * reference_frequency);
}
