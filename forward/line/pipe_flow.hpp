#pragma once
/// Water hammer: one-dimensional waves in a liquid-filled pipe between a reservoir and a closing valve, by the method of characteristics at Courant number 1.
#include <limits>
#include <span>
#include <vector>

namespace calomel {

/// Numbers of a run; the defaults of the second block are those of an elastic line.
struct PipeSetup {
  double length = 0;              ///< from the reservoir to the valve [m]
  double diameter = 0;            ///< inner [m]
  double wave_speed = 0;          ///< a [m/s]
  double density = 0;             ///< rho [kg/m^3]
  double viscosity = 0;           ///< mu [Pa s]
  double friction_factor = 0;     ///< Darcy's f of turbulent flow [-]
  double velocity = 0;            ///< V0 of the steady flow towards the valve [m/s]
  double reservoir_pressure = 0;  ///< gauge [Pa]
  double rise = 0;                ///< height of the valve over the reservoir's end [m]
  double outlet_pressure = 0;     ///< gauge, behind the valve [Pa]
  double closure_begin = 0;       ///< [s]
  double closure_time = 0;        ///< [s]
  double closure_exponent = 1;    ///< opening = (1 - (t - begin)/time)^exponent
  int cells = 64;

  double vapour_pressure = -std::numeric_limits<double>::infinity();  ///< gauge; no pressure falls below it [Pa]
  double gas_fraction = 0;                                            ///< of the volume at the steady pressure, isothermal [-]
  double unsteady_friction = 0;                                       ///< share of Vardy and Brown's [-]
  double retarded_compliance = 0;                                     ///< of the wall, over the line's elastic one [-]
  double retardation_time = 0;                                        ///< of the wall [s]
};

/// Darcy's friction factor of turbulent flow, Haaland 1983: f^-1/2 = -1.8 log10((roughness/3.7)^1.11 + 6.9/Re). roughness: over the diameter [-].
double haaland(double reynolds, double roughness);

/// P_t + rho a^2 V_x + q_t = 0, rho V_t + P_x + rho f V|V| / 2D + F = 0, with P = p + rho g z the piezometric pressure, f = max(64/Re, friction_factor) at each
/// instant (quasi-steady), and
///   q  retarded strain of a Kelvin-Voigt wall, times rho a^2: tau q_t + q = chi (P - P_steady)
///   F  unsteady friction, (16 mu / D^2) int V_t(s) W(4 nu (t - s) / D^2) ds, W(t) = exp(-B t) / (2 sqrt(pi t)), B = Re^k / 12.86, k = log10(15.29 Re^-0.0567);
///   210.08
///      for laminar flow (Vardy and Brown 2003), by a sum of exponentials.
/// Along dx/dt = +-a this is dP +- rho a dV +- (friction) dx + q_t dt = 0; all terms by the trapezoidal rule. Vapour: at a node whose pressure would fall below
/// the vapour pressure a cavity opens, d(volume)/dt = area (V_downstream - V_upstream), and (p - p_v) volume = gas constant; with no gas p >= p_v, volume >= 0
/// and one of the two an equality, which is solved exactly in every step (discrete vapour and gas cavities: Wylie 1984; Bergant, Simpson and Tijsseling 2006).
/// That is Riemer's cutoff of mercury: p = max(p_elastic, p_v), reversible. Valve: V|V| = V0^2 opening^2 (p - p_out) / (p_steady - p_out).
class PipeFlow {
 public:
  /// The steady state. `longest`: how long it will run [s], which the exponentials of unsteady friction must span.
  /// Errors: NumericsError where a number is outside its law, or the steady flow is not one: pressure below the vapour's or behind the valve above that before
  /// it.
  PipeFlow(const PipeSetup& setup, double longest);

  void step();

  [[nodiscard]] double time_step() const { return dt_; }
  [[nodiscard]] double time() const { return dt_ * double(steps_); }
  [[nodiscard]] std::size_t nodes() const { return pressure_.size(); }
  /// Gauge pressure at a distance from the reservoir, linear between nodes [Pa].
  [[nodiscard]] double pressure_at(double distance) const;
  /// Gauge pressure of a node [Pa].
  [[nodiscard]] double pressure(std::size_t node) const { return pressure_[node] - height_[node]; }
  /// Velocity on the reservoir's side and on the valve's side of each node [m/s]; equal where there is no cavity.
  [[nodiscard]] std::span<const double> upstream() const { return upstream_; }
  [[nodiscard]] std::span<const double> downstream() const { return downstream_; }
  /// Volume of each node's cavity [m^3].
  [[nodiscard]] std::span<const double> cavity() const { return cavity_; }
  [[nodiscard]] double area() const { return area_; }

 private:
  /// One side's characteristic at a node, stiffness P +- impedance V = constant.
  struct Characteristic {
    double impedance = 0, constant = 0;
  };
  [[nodiscard]] double resistance(double velocity) const;
  [[nodiscard]] double opening(double time) const;
  /// The line that arrives at `to` from its neighbour `from`, with sign +1 from the reservoir's side (of velocities `there` and, at the node, `here`).
  [[nodiscard]] Characteristic arriving(std::size_t from, std::size_t to, double sign, const std::vector<double>& there, const std::vector<double>& here,
                                        std::span<const double> past_there, std::span<const double> past_here) const;
  void cavity_node(std::size_t i, const Characteristic& plus, double outflow_constant, double outflow_slope);
  void remember(std::vector<double>& past, const std::vector<double>& before, const std::vector<double>& now) const;
  [[nodiscard]] double friction_now(std::span<const double> past, std::size_t node) const;

  PipeSetup s_;
  double dt_, dx_, area_, impedance_;
  double stiffness_ = 1, wall_decay_ = 0, wall_old_ = 0, wall_new_ = 0;  ///< of a step of the retarded wall
  bool cavities_ = false, wall_ = false, unsteady_ = false;
  std::size_t steps_ = 0;
  double valve_drop_ = 0;
  std::vector<double> height_;             ///< rho g z of the nodes [Pa]
  std::vector<double> pressure_, steady_;  ///< piezometric [Pa]
  std::vector<double> upstream_, downstream_;
  std::vector<double> cavity_, gas_;         ///< [m^3], [Pa m^3]
  std::vector<double> retarded_, rate_;      ///< q [Pa], dq/dt [Pa/s]
  std::vector<double> weight_, decay_;       ///< of the exponentials, of a step
  std::vector<double> past_up_, past_down_;  ///< (node, exponential) of unsteady friction, by side [Pa/m]
  double fresh_ = 0;                         ///< F of a step's own change of velocity, over it [Pa s/m^2]
};

}  // namespace calomel
