#include <fmt/format.h>

#include <cmath>

#include "forward/target/built_in_model.hpp"
#include "forward/mesh/mesh_extent.hpp"
#include "forward/solver/kernel.hpp"

namespace calomel {

namespace {

constexpr double least_pressure = 1e3;  ///< [Pa] below which a pressure was hardly meant

/// Element-steps a second of one thread, from quiet measurements with AVX2 (docs/benchmarks/solver_speed.md): one run at 12 000 elements and at
/// 500 000 or more, between them by the logarithm; groups of eight runs do not depend on the size, and are faster in plane strain.
double measured_rate(bool single, std::size_t elements, bool group, bool plane_strain) {
  if (group) return (single ? 80e6 : 50e6) * (plane_strain ? 2.5 : 1);
  const double small = single ? 30e6 : 18e6, large = single ? 45e6 : 21e6;
  return small + (large - small) * std::clamp(std::log(double(elements) / 12e3) / std::log(500.0 / 12), 0.0, 1.0);
}

/// Of the target along its narrowest side, across a slice left out [m].
double least_extent(const Mesh& mesh) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < 3; ++c) {
    if (mesh.plane_strain && c == 1) continue;
    const auto [low, high] = extent(mesh, c);
    least = std::min(least, high - low);
  }
  return least;
}

}  // namespace

ModelDescription BuiltInModel::describe() const {
  ModelDescription d;
  d.elements = mesh_->elements.size();
  d.nodes = mesh_->nodes.size();
  d.slip_pairs = mesh_->slip.size();
  const RunSetup s = setup(case_, *mesh_, 0, {1.0});
  SolveOptions options = solve_options(case_.solver);
  options.threads = threads_;
  const Stepping stepping = solver_->stepping(s, options);
  d.time_step = case_.time.output_interval / stepping.per_output;
  d.subcycles = stepping.subcycles;
  d.steps = std::int64_t(stepping.per_output) * std::int64_t(shape_.times.size() - 1);
  const bool single = case_.solver.precision == "single";
  d.element_steps = double(d.elements) * double(d.steps) * stepping.work;
  const ThreadChoice choice = solver_->useful_threads(s, options, threads_);
  d.run_threads = choice.threads;
  d.run_gain = choice.gain;
  d.estimated_seconds = d.element_steps / measured_rate(single, d.elements, false, mesh_->plane_strain);
  const double group_seconds = run_lanes * d.element_steps / measured_rate(single, d.elements, true, mesh_->plane_strain);
  for (int left = ensemble_.pulses; left > 0;) {
    const int count = int(runs_at_once(std::size_t(left), mesh_->plane_strain));
    d.estimated_mean_seconds += count == 1 ? d.estimated_seconds : group_seconds;
    left -= count;
  }
  d.estimated_bytes = double(d.elements) * (single ? 300 : 550);
  d.notes = case_.notes;
  d.notes.insert(d.notes.end(), mesh_->notes.begin(), mesh_->notes.end());
  if (std::isfinite(s.liquid.tensile_cutoff) && s.liquid.tensile_cutoff != case_.mercury.tensile_cutoff)
    d.notes.push_back(fmt::format("effective tensile cutoff {} Pa: the case's own and a static pressure together, of which the motion holds the sum alone",
                                  number_text(s.liquid.tensile_cutoff)));
  if (mesh_->plane_strain) {
    const auto [low, high] = extent(*mesh_, 1);
    d.slice_thickness = high - low;
  }
  if (!heating_.element.empty() && heating_.integral > 0 && !s.p0.empty()) {
    double peak = 0;
    for (std::size_t e = 0; e < s.p0.size() && peak == 0; ++e)
      if (heating_.element[e] > 0) peak = s.p0[e] / heating_.element[e];
    d.deposited_energy = peak * heating_.integral * symmetry_factor(*mesh_) / gruneisen(case_.mercury, case_.mercury.sound_speed);
    d.viscosity = regularising_viscosity(case_, *mesh_);  // without what a mechanism adds
    d.mesh_decides_viscosity = d.viscosity > case_.mercury.regularising_viscosity;
    if (d.mesh_decides_viscosity)
      d.warnings.push_back(
          fmt::format("the mesh decides the regularising viscosity: {:.4g} Pa s, above the set {:.4g} Pa s; elements below {:.3g} mm in the mercury avoid that",
                      d.viscosity, case_.mercury.regularising_viscosity,
                      1e3 * case_.mercury.regularising_viscosity / (case_.mercury.least_mesh_viscosity * case_.mercury.density * case_.mercury.sound_speed)));
    if (!mesh_->plane_strain && case_.geometry.kind == "jet_flow" && (d.deposited_energy < 12e3 || d.deposited_energy > 15e3))
      d.warnings.push_back(fmt::format("the pulse deposits {:.3g} kJ; 12 to 15 kJ are usual at 1.4 MW", d.deposited_energy / 1e3));
  }
  const auto usual = [&](const char* key, std::optional<double> pressure) {
    if (pressure && *pressure > 0 && *pressure < least_pressure)
      d.warnings.push_back(fmt::format("{} = {} Pa is next to nothing: pressures are in Pa, 1 MPa is 1e6", key, number_text(*pressure)));
  };
  usual("load.peak_pressure", case_.load.peak_pressure);
  usual("material.mercury.tensile_cutoff", case_.mercury.tensile_cutoff);
  const double least = least_extent(*mesh_);
  if (const auto size = case_.geometry.resolved().element_size; size && *size > least)
    d.warnings.push_back(fmt::format("geometry.element_size = {} m is larger than the target, which is {:.3g} m at its narrowest: lengths are in metres",
                                     number_text(*size), least));
  if (mesh_->quality.least_wall_elements > 0 && mesh_->quality.least_wall_elements < 3)
    d.warnings.push_back(
        fmt::format("a wall has only {} elements through its thickness; 3 or more show the bending strain within 4 %", mesh_->quality.least_wall_elements));
  if (!case_.geometry.slips())
    d.warnings.push_back("steel and mercury share nodes on wetted faces (wetted = \"tied\"): strains err by 9 to 25 %, kept to reproduce published results");
  if (case_.geometry.slips() && !case_.geometry.parts() && std::isfinite(s.liquid.tensile_cutoff))
    d.warnings.push_back(
        "mercury never parts from the walls (wetted = \"no_separation\"): half a layer of its elements moves with a wall beside which it has given way; kept "
        "for comparison");
  if (const double most = 0.5 * greatest_film * mesh_->liquid_element_size; s.wall_film > most && case_.geometry.parts())
    d.warnings.push_back(fmt::format(
        "these elements hold a film of {:.3g} mm on the walls at most, not the {:.3g} mm of material.mercury.wall_film; elements of {:.3g} mm would",
        1e3 * most, 1e3 * s.wall_film, 1e3 * s.wall_film / (0.5 * greatest_film)));
  for (const auto& g : gauges_)
    if (g.distance > 1e-4) d.warnings.push_back(fmt::format("sensor {} was moved by {:.3g} mm onto the outer surface", g.name, 1e3 * g.distance));
  return d;
}

}  // namespace calomel
