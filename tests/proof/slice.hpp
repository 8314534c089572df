#pragma once
/// An independent solver of a box slice in plane strain: velocities and stresses on staggered grids of one spacing (Virieux 1986, Geophysics 51, 889), leapfrog
/// in time.
///
/// Cell (i, j) holds normal stresses or the pressure, its faces the normal velocities, its corners the shear stress. Where solid and mercury meet, the face
/// carries a velocity of each with the mass of half a cell of each. Nothing here is shared with the library: neither mesh, step nor code. Laws and measured
/// errors: docs/proof/generator.md.
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#ifndef GENERATOR_REAL
#define GENERATOR_REAL float
#endif

namespace calomel::proof {

using Real = GENERATOR_REAL;

enum class Cell : std::uint8_t {
  vacuum,
  solid,
  mercury,
  rigid,      ///< holds the velocity normal to it at 0, carries no shear
  continuing  ///< the medium in front of it goes on: non-reflecting at normal incidence
};

/// Cells of side h, row by row, x fastest; place of cell (i, j) is (x0 + i h, z0 + j h) to one h more. The outermost cells are never solid or mercury.
struct Grid {
  int nx = 0, nz = 0;
  double h = 0, x0 = 0, z0 = 0;
  std::vector<Cell> cells;
  Grid(int nx_, int nz_, double h_, double x0_, double z0_)
      : nx(nx_), nz(nz_), h(h_), x0(x0_), z0(z0_), cells(std::size_t(nx_) * std::size_t(nz_), Cell::vacuum) {}
  [[nodiscard]] int index(int i, int j) const { return j * nx + i; }
  [[nodiscard]] Cell at(int i, int j) const { return cells[std::size_t(index(i, j))]; }
  [[nodiscard]] double x(double i) const { return x0 + i * h; }
  [[nodiscard]] double z(double j) const { return z0 + j * h; }
  /// Sets the cells whose middle lies in the box.
  void fill(Cell kind, double x_begin, double x_end, double z_begin, double z_end);
};

/// Isotropic solid; lambda and mu in Pa.
struct Solid {
  double density = 0, lambda = 0, mu = 0;
  static Solid from_young(double density, double young, double poisson);
  [[nodiscard]] double p_modulus() const { return lambda + 2 * mu; }
  [[nodiscard]] double bending_modulus() const { return p_modulus() - lambda * lambda / p_modulus(); }  ///< plane strain, no normal stress across
};

struct Mercury {
  double density = 0, sound_speed = 0, cutoff = 0, viscosity = 0;  ///< cutoff: sigma_c [Pa]
  double collapse = 0.75;                                          ///< viscosity of a front that closes a cavity, in rho c h
  double speed_gradient = 0;                                       ///< relative change of the sound speed per metre of z, about z = gradient_middle
  double gradient_middle = 0;
  [[nodiscard]] double modulus() const { return density * sound_speed * sound_speed; }
};

/// Laws of the mercury other than Riemer's; at most one of them.
struct Nucleation {     ///< void grows from nuclei of two strengths at Rayleigh's rate
  double number = 0;    ///< nuclei per volume [1/m^3]; 0: off
  double radius = 0;    ///< of a nucleus [m]
  double stronger = 0;  ///< share of those that open at a greater tension than the cutoff
  double strength = 0;  ///< by which it is greater [Pa]
};
struct Relaxing {  ///< a viscous pressure that relaxes (Maxwell) on top of the viscosity
  double viscosity = 0, time = 0;
};
struct Bubbles {  ///< two sizes after Rayleigh and Plesset
  double fraction[2] = {0, 0}, radius[2] = {0, 0};
  double ambient = 1e5, tension = 0.47, viscosity = 0.1;
};
struct Tait {
  double exponent = 0;  ///< 0: off
};
struct Zener {  ///< standard linear solid: relative strength and relaxation time
  double strength = 0, time = 0;
};
struct Yielding {
  double stress = 0, hardening = 0;  ///< [Pa]; stress 0: off
};
struct Behind {            ///< channels of mercury behind the faces that continue, each of which ends at another impedance
  double coefficient = 0;  ///< of the pressure that comes back
  double delay = 0;        ///< there and back [s]
};

/// What one gauge reads: weights of face velocities of the solid, integrated over time.
struct Gauge {
  std::vector<int> x_faces, z_faces;
  std::vector<double> x_weights, z_weights;
};

/// A face between mercury and solid, or between a medium and what bounds it.
struct Contact {
  int face = 0, cell = 0;  ///< the mercury's (or the bounded medium's) cell
  bool across_z = false;
  int sign = 1;          ///< of the normal out of the mercury
  double strength = 0;   ///< the face parts at this tension [Pa]
  double suction = 0;    ///< pull on both sides while it is apart [Pa]
  double gas_gap = 0;    ///< > 0: gas of this thickness in between at rest [m]
  bool brittle = false;  ///< once parted it holds and pulls no more
  double gap = 0;
  bool apart = false;
};

struct State;

/// A slice with everything that a run needs; runs do not change it.
class Slice {
 public:
  Slice(const Grid& grid, const Solid& steel, const Mercury& mercury);

  // What may differ from the base model; to be set before the first run.
  Nucleation nucleation;
  Relaxing relaxing;
  Bubbles bubbles;
  Tait tait;
  Zener zener;
  Yielding yielding;
  Behind behind;
  void set_solid(const std::function<bool(double x, double z)>& where, const Solid& solid);  ///< another solid there
  void set_pressure(const std::function<double(double x, double z)>& p0);                    ///< heating pressure at energy 1 [Pa]
  void set_heated_solid(const std::function<double(double x, double z)>& stress);            ///< sigma = C:eps - stress * I there, rising with the pulse [Pa]
  void add_mass(double x_begin, double x_end, double z, double mass_per_area);               ///< on the free z faces at z
  void set_contacts(const std::function<void(Contact&, double x, double z)>& change);
  double pulse_length = 0.7e-6;
  double step_share = 0.9;  ///< of the stable step

  [[nodiscard]] Gauge gauge(double x, double z, bool along_x, double length) const;  ///< on the outer face, at the nearest solid from outside
  [[nodiscard]] double stable_step() const;
  [[nodiscard]] const Grid& grid() const { return grid_; }
  [[nodiscard]] const std::vector<Contact>& contacts() const { return contacts_; }

  /// Strains at 0, interval, 2 interval ... end, (gauge, time); `initial` scaled by `initial_scale` is there at t = 0. `last`, if given, receives the state at
  /// the end.
  [[nodiscard]] std::vector<double> run(double energy, double end, double interval, std::span<const Gauge> gauges, const State* initial = nullptr,
                                        double initial_scale = 0, State* last = nullptr) const;

  // Step by step, for tests.
  [[nodiscard]] State rest() const;
  void advance_velocity(State& s, double dt) const;                                 ///< velocities half a step before the stresses' time to half a step after
  void advance_stress(State& s, double dt, double ramp_before, double ramp) const;  ///< ramp: energy times the risen share of the pulse
  [[nodiscard]] double stored_energy(const State& s) const;                         ///< per metre of width [J/m]; elastic solid and linear mercury
  [[nodiscard]] double kinetic_energy(const State& before, const State& after) const;  ///< mixed product of the velocities

 private:
  struct Run {
    int begin, end;  ///< cells, faces or corners with consecutive indices
    int row;
  };
  void build();
  void mercury_pressure(State& s, double dt, double ramp) const;
  void solid_stress(State& s, double dt, double ramp_step) const;
  void yield(State& s) const;

  Grid grid_;
  Solid steel_;
  Mercury mercury_;
  bool built_ = false;
  std::vector<double> density_, lambda_, mu_;  ///< of solid cells
  std::vector<double> extra_mass_;             ///< per area, by z face
  std::vector<Real> p0_, heat_;
  double greatest_speed_ = 0, greatest_bending_ = 1;
  std::vector<Run> mercury_cells_, solid_cells_, mercury_x_, mercury_z_, solid_x_, solid_z_, corners_;
  std::vector<Real> inverse_mass_x_, inverse_mass_z_;  ///< of the solid at its faces, 1/(rho h) where both cells are solid
  std::vector<Real> p_modulus_, lame_, bending_, corner_mu_;
  std::vector<Real> pair_x_, pair_z_;     ///< weights of pairs of cells in bending, with the cell before
  std::vector<Real> modulus_;             ///< of the mercury, by row
  std::vector<Contact> contacts_, rear_;  ///< wetted faces; faces behind which the medium continues
  std::vector<Contact> free_;             ///< free surfaces of the mercury
};

/// Fields of one run, over all cells (or faces, or corners) of the grid.
struct State {
  std::vector<Real> vx, vz, p, e, opened;        ///< mercury
  std::vector<Real> ux, uz, sxx, szz, sxz, syy;  ///< solid: velocities ux, uz
  std::vector<Real> exx, ezz;                    ///< scratch: strain increments
  std::vector<Real> a, b, c, d;                  ///< of the law of the mercury
  std::vector<Real> mxx, mzz, mxz;               ///< of the standard linear solid
  std::vector<Real> plastic, factor;
  std::vector<Real> sent;  ///< by the faces that continue, over the delay of what is behind: a ring of times, all faces of one time together
  std::size_t time_of_ring = 0;
  std::vector<Real> total_xx, total_zz;  ///< strains, kept when `keep_strain`
  std::vector<Contact> contacts;
  bool keep_strain = false;
  double ramp = 0;
};

}  // namespace calomel::proof
