// How a run comes to be: masses, blocks with their state and law, rules of boundary nodes, initial state.
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/errors.hpp"
#include "forward/solver/run.hpp"

namespace calomel {

namespace {

constexpr double roundings = 1e3;  ///< of the motion that a pair shares: what lies within is no gap

Vec3 centre_of(const Mesh& mesh, std::size_t e) {
  Vec3 x{};
  for (const NodeId n : mesh.elements[e])
    for (std::size_t c = 0; c < 3; ++c) x[c] += mesh.nodes[std::size_t(n)][c] / 8;
  return x;
}

}  // namespace

template <class R>
Run<R>::Run(const PackedMesh<R>& packed, const Mesh& mesh, const NodalVolumes& volumes, const RunSetup& setup, const SolveOptions& options, double time_step,
            int subcycles)
    : packed_(packed),
      mesh_(mesh),
      setup_(setup),
      kernel_(kernels<R>()),
      dt_(time_step),
      subcycles_(subcycles),
      keep_(options.energy_balance                                                              ? Keep::energies
            : setup.quadratic_viscosity > 0 || setup.collapse_resistance() > 0 || is_stressed() ? Keep::rate
                                                                                                : Keep::nothing) {
  expect(setup.initial_stress.empty() || setup.initial_stress.size() == mesh.elements.size(), "a stress before the run is given for every element");
  expect(setup.thermal_strain.empty() || setup.thermal_strain.size() == mesh.elements.size(), "a thermal strain is given for every element");
  expect(setup.slip_strength.empty() || setup.slip_strength.size() == mesh.slip.size(), "a strength is given for every slip pair");
  for (const auto* by_node : {&setup.node_mass, &setup.node_damping})
    expect(by_node->empty() || by_node->size() == mesh.nodes.size(), "what nodes carry and lose is given for every node");
  expect(setup.slip_drag.empty() || setup.slip_drag.size() == mesh.slip.size(), "a drag is given for every slip pair");
  expect(setup.slip_hold.empty() || setup.slip_hold.size() == setup.slip_strength.size(),
         "what is held apart is given for every slip pair, where strengths are");
  const std::size_t nodes = std::size_t(packed.layout.nodes), width = packed.width();
  make_masses(volumes);
  u_ = AlignedArray<R>(nodes * width);
  v_ = AlignedArray<R>(nodes * width);
  outbox_ = AlignedArray<R>(packed.layout.outbox_size * width);
  start_from(setup.initial_displacement, u_);
  start_from(setup.initial_velocity, v_);
  make_blocks();
  if (!setup.initial_displacement.empty() || !setup.initial_velocity.empty()) remember_strain();
  make_rules(options.heated_rear);
  make_extras();
  plain_chunks_ = node_chunks(packed.layout.first_slow_plain);
  rule_chunks_ = node_chunks(rules_.size());
  slow_chunks_ = node_chunks(packed.layout.plain.size() - packed.layout.first_slow_plain);
  for (auto& e : energies_) e.resize(blocks_.size() + chunk_count(true));

  const double k = setup.liquid.bulk_modulus, h = mesh.liquid_element_size, r = setup.rear_coefficient;
  base_.u = u_.data();
  base_.v = v_.data();
  base_.inverse_mass = inverse_mass_.data();
  base_.outbox = outbox_.data();
  base_.outbox_end = packed.layout.outbox_begin.data() + 1;
  base_.outbox_scale = 1;
  base_.dt = R(dt_);
  base_.kick = R(dt_);
  base_.bulk_modulus = R(k);
  base_.cutoff = R(std::min(setup.liquid.tensile_cutoff, unlimited_cutoff));
  base_.hourglass = R(setup.hourglass * k);
  base_.beta = R(k > 0 ? setup.liquid.viscosity / k : 0);
  base_.collapse = R(setup.collapse_resistance());
  base_.quadratic = R(setup.liquid_density * setup.quadratic_viscosity * setup.quadratic_viscosity * h * h);
  base_.rear_give = R(1 - r);
  base_.rear_push = R((1 + r) * std::sqrt(k * setup.liquid_density));
  const double late = 0.5 + 0.5 * std::max(r, 0.0);
  base_.extras = {strength_.data(), hold_.data(), open_.data(), rear_initial_.data(), resistance_.size() ? resistance_.data() : nullptr, setup.wall_film != 0};
  base_.rear_late = R(late);
  base_.rear_early = R((1 - late) / late);
  base_.lambda = R(setup.steel.lambda);
  base_.mu = R(setup.steel.mu);
  base_.steel_beta = R(setup.steel_stiffness_damping);
  make_branches();
}

template <class R>
void Run<R>::make_masses(const NodalVolumes& volumes) {
  const Layout& layout = packed_.layout;
  mass_.resize(std::size_t(layout.nodes));
  parted_mass_.resize(mass_.size());
  inverse_mass_ = AlignedArray<R>(mass_.size());
  const auto by_node = [&](const std::vector<double>& values, std::size_t n) { return values.empty() ? 0 : values[n]; };
  const bool damped = setup_.steel_mass_damping != 0 || !setup_.node_damping.empty();
  if (damped) motion_factor_.resize(mass_.size()), damped_.resize(node_chunks(mass_.size()));
  std::vector<double> drag(mass_.size(), 0);  // [kg/s]
  for (std::size_t n = 0; n < mesh_.nodes.size(); ++n) {
    const auto s = std::size_t(layout.to_solver[n]);
    const double of_steel = setup_.steel_density * volumes.steel[n];
    drag[s] += setup_.steel_mass_damping * of_steel + by_node(setup_.node_damping, n);
    mass_[s] += of_steel + setup_.liquid_density * volumes.liquid[n] + by_node(setup_.node_mass, n);
  }
  for (std::size_t s = 0; s < mass_.size(); ++s) {
    parted_mass_[s] = mass_[s];
    inverse_mass_[s] = R(1 / mass_[s]);
    if (damped) motion_factor_[s] = std::exp(-dt_ * drag[s] / mass_[s]);
  }
}

template <class R>
void Run<R>::make_blocks() {
  const std::size_t count = packed_.layout.blocks.size(), lanes = packed_.lanes();
  initial_.resize(count);
  thermal_.resize(count);
  trace_.resize(count);
  p0_.resize(count);
  state_.resize(count);
  memory_.resize(count);
  blocks_.resize(count);
  if (setup_.liquid_law) laws_.resize(count);
  for (std::size_t b = 0; b < count; ++b) {
    const Block& block = packed_.layout.blocks[b];
    const auto& elements = packed_.elements[b];
    const std::size_t slots = elements.size();
    if (block.liquid) {
      p0_[b] = AlignedArray<R>(slots);
      for (std::size_t i = 0; i < slots; ++i)
        if (elements[i] >= 0 && !setup_.p0.empty()) p0_[b][i] = R(setup_.p0[std::size_t(elements[i])]);
    }
    if (block.liquid) state_[b] = AlignedArray<R>(slots * std::size_t(liquid_state(keep_)) * (packed_.runs ? run_lanes : 1));
    if (!block.liquid && keep_ == Keep::energies) state_[b] = AlignedArray<R>(slots * steel_state);
    blocks_[b] = {block.liquid,
                  packed_.form[b],
                  std::int32_t(slots / lanes),
                  packed_.geometry[b].data(),
                  packed_.connectivity[b].data(),
                  p0_[b].data(),
                  state_[b].data(),
                  block.first_node,
                  block.interior,
                  block.ranges.data(),
                  std::int32_t(block.ranges.size()),
                  block.shared.data(),
                  std::int32_t(block.shared.size()),
                  block.outbox,
                  {}};
    if (keep_ != Keep::nothing) blocks_[b].size = packed_.size[b].data();
    if (block.liquid && setup_.liquid_law) make_law(b);
    if (is_stressed()) make_stress(b);
    scratch_rows_ = std::max(scratch_rows_, std::size_t(block.interior) + block.shared.size());
  }
}

template <class R>
void Run<R>::make_rules(bool heated_rear) {
  const Layout& layout = packed_.layout;
  for (const auto& s : layout.special) {
    SpecialData<R> r{};
    r.node = s.node;
    r.partner = s.partner;
    r.normals = s.normals;
    r.fixed_node = layout.fixed[std::size_t(s.node)];
    r.mass_node = R(mass_[std::size_t(s.node)]);
    if (s.partner >= 0) {
      r.fixed_partner = layout.fixed[std::size_t(s.partner)];
      r.mass_partner = R(mass_[std::size_t(s.partner)]);
    }
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t c = 0; c < 3; ++c) r.normal[k][c] = R(s.normal[k][c]);
    if (s.rear >= 0) {
      const BoundaryNode& n = layout.rear[std::size_t(s.rear)];
      std::array<double, 3> free{};  // a node that is held in a direction gives nothing in it
      for (std::size_t c = 0; c < 3; ++c) free[c] = (layout.fixed[std::size_t(s.node)] >> c & 1) ? 0 : n.area[c];
      const double area = std::sqrt(free[0] * free[0] + free[1] * free[1] + free[2] * free[2]);
      r.rear_area = R(area);
      for (std::size_t c = 0; c < 3 && area > 0; ++c) r.rear_normal[c] = R(free[c] / area);
      if (heated_rear && setup_.p0_at) r.rear_p0 = R(setup_.p0_at(mesh_.nodes[std::size_t(n.node)]));
    }
    if (s.loaded >= 0)
      for (std::size_t c = 0; c < 3; ++c) r.load_area[c] = R(layout.loaded[std::size_t(s.loaded)].area[c]);
    rules_.push_back(r);
  }
}

template <class R>
void Run<R>::make_branches() {
  if (setup_.steel_branches.empty()) return;
  relaxing_ = AlignedArray<R>(u_.size());
  for (const auto& b : setup_.steel_branches) {
    branch_.emplace_back(u_.size());
    branches_.push_back({branch_.back().data(), b.share, b.time});
  }
  base_.relaxing = relaxing_.data();
  base_.branches = branches_.data();
  base_.branch_count = int(branches_.size());
}

template <class R>
double Run<R>::initial_pressure(std::size_t e) const {
  if (setup_.initial_stress.empty()) return 0;
  const auto& s = setup_.initial_stress[e];
  return -(s[0] + s[1] + s[2]) / 3;
}

template <class R>
void Run<R>::make_stress(std::size_t b) {
  const auto& elements = packed_.elements[b];
  const std::size_t slots = elements.size(), lanes = packed_.lanes();
  if (blocks_[b].liquid) {
    if (setup_.initial_stress.empty()) return;
    initial_[b] = AlignedArray<R>(slots);
    for (std::size_t i = 0; i < slots; ++i)
      if (elements[i] >= 0) initial_[b][i] = R(initial_pressure(std::size_t(elements[i])));
    blocks_[b].initial = initial_[b].data();
    return;
  }
  const double lambda = setup_.steel.lambda, mu = setup_.steel.mu, three_k = 3 * lambda + 2 * mu;
  const bool balanced = keep_ == Keep::energies;
  initial_[b] = AlignedArray<R>(slots * 6);
  thermal_[b] = AlignedArray<R>(slots);
  if (balanced) trace_[b] = AlignedArray<R>(slots);
  for (std::size_t i = 0; i < slots; ++i) {
    if (elements[i] < 0) continue;
    const auto e = std::size_t(elements[i]);
    if (!setup_.thermal_strain.empty()) thermal_[b][i] = R(setup_.thermal_strain[e]);
    if (!setup_.initial_stress.empty()) {
      const auto& s = setup_.initial_stress[e];
      const double trace = s[0] + s[1] + s[2];
      for (std::size_t k = 0; k < 6; ++k) initial_[b][(i / lanes * 6 + k) * lanes + i % lanes] = R((s[k] - (k < 3 ? lambda / three_k * trace : 0)) / (2 * mu));
    }
    if (balanced) trace_[b][i] = R(-3 * initial_pressure(e) + three_k * steel_strain(e).trace());
  }
  blocks_[b].initial = initial_[b].data();
  blocks_[b].thermal = thermal_[b].data();
  blocks_[b].trace = trace_[b].data();
}

template <class R>
void Run<R>::make_extras() {
  const bool parting = !setup_.slip_strength.empty() || setup_.wetted_cutoff < unlimited_cutoff;
  if (!parting && setup_.initial_stress.empty()) return;
  const std::size_t copies = packed_.runs ? run_lanes : 1;
  strength_ = AlignedArray<R>(rules_.size());
  hold_ = AlignedArray<R>(rules_.size());
  open_ = AlignedArray<R>(rules_.size() * copies);
  rear_initial_ = AlignedArray<R>(rules_.size());
  const bool resisting = setup_.parting_time > 0 || setup_.meeting_time > 0;
  if (resisting) resistance_ = AlignedArray<R>(2 * rules_.size());
  std::map<std::int32_t, std::size_t> pair_of, rule_of;  // by solver node
  for (std::size_t i = 0; i < mesh_.slip.size(); ++i) pair_of[packed_.layout.to_solver[std::size_t(mesh_.slip[i].mercury)]] = i;
  for (std::size_t i = 0; i < rules_.size(); ++i) rule_of[rules_[i].node] = i, strength_[i] = R(unlimited_cutoff);
  if (parting)
    for (const BoundaryNode& n : boundary_nodes(mesh_, mesh_.wetted, packed_.layout.pairs)) {
      const auto pair = pair_of.find(packed_.layout.to_solver[std::size_t(n.node)]);
      if (pair == pair_of.end()) continue;
      const std::size_t rule = rule_of.at(pair->first);
      SpecialData<R>& r = rules_[rule];
      const Vec3& normal = mesh_.slip[pair->second].normals[0];
      const double area = n.area[0] * normal[0] + n.area[1] * normal[1] + n.area[2] * normal[2];
      if (area < 0)  // from here on it points out of the mercury
        for (auto& c : r.normal[0]) c = -c;
      const double thickness = r.mass_node / (setup_.liquid_density * std::abs(area));
      r.film = R(std::clamp(setup_.wall_film / thickness * r.mass_node, -greatest_film * r.mass_partner, greatest_film * r.mass_node));
      parted_mass_[std::size_t(setup_.wall_film > 0 ? r.node : r.partner)] -= std::abs(double(r.film));
      const double own = setup_.slip_strength.empty() ? std::numeric_limits<double>::infinity() : setup_.slip_strength[pair->second];
      const double strength = std::min(own, setup_.wetted_cutoff);
      strength_[rule] = R(std::min(strength * std::abs(area), unlimited_cutoff));
      const bool weak = setup_.wetted_cutoff > own;
      if (!weak && strength < unlimited_cutoff) hold_[rule] = strength_[rule];
      if (weak && !setup_.slip_hold.empty()) hold_[rule] = R(setup_.slip_hold[pair->second] * std::abs(area));
      if (resisting && !weak) {
        const double stiffness = setup_.liquid.bulk_modulus * std::abs(area) / thickness;
        resistance_[2 * rule] = R(stiffness * setup_.parting_time);
        resistance_[2 * rule + 1] = R(stiffness * setup_.meeting_time);
      }
      for (std::size_t l = 0; l < copies; ++l) {  // what starts apart is apart
        double gap = 0, moved = 0;
        for (std::size_t c = 0; c < 3; ++c) {
          const std::size_t at = c * packed_.stride() + l;
          const double partner = double(u_[std::size_t(r.partner) * packed_.width() + at]), node = double(u_[std::size_t(r.node) * packed_.width() + at]);
          gap += double(r.normal[0][c]) * (partner - node);
          moved = std::max({moved, std::abs(partner), std::abs(node)});
        }
        open_[rule * copies + l] = R(r.normals == 1 && gap > roundings * std::numeric_limits<R>::epsilon() * moved ? 1 : 0);
      }
    }
  std::map<std::size_t, int> faces;  // at a rule's node
  for (const Face& f : mesh_.rear)
    for (const NodeId n : f.nodes) {
      const std::size_t rule = rule_of.at(packed_.layout.to_solver[std::size_t(n)]);
      rear_initial_[rule] += R(initial_pressure(std::size_t(f.element)));
      ++faces[rule];
    }
  for (const auto& [rule, count] : faces) rear_initial_[rule] /= R(count);
}

template <class R>
void Run<R>::start_from(const std::vector<Vec3>& field, AlignedArray<R>& to) {
  const std::size_t stride = packed_.stride();
  for (std::size_t n = 0; n < field.size(); ++n)
    for (std::size_t c = 0; c < 3; ++c)
      if (!(mesh_.fixed[n] & (1 << c)))
        for (std::size_t l = 0; l < stride; ++l) to[std::size_t(packed_.layout.to_solver[n]) * packed_.width() + c * stride + l] = R(field[n][c]);
}

/// The liquid's strain one step before the start, had it moved with the initial velocity: what rates are taken from.
template <class R>
void Run<R>::remember_strain() {
  const bool finite = std::find(packed_.form.begin(), packed_.form.end(), Form::finite) != packed_.form.end();
  const std::size_t lanes = packed_.lanes(), copies = packed_.runs ? run_lanes : 1;
  for (std::size_t b = 0; b < blocks_.size(); ++b)
    for (std::size_t slot = 0; slot < packed_.elements[b].size(); ++slot) {
      if (!blocks_[b].liquid || packed_.elements[b][slot] < 0) continue;
      const auto e = std::size_t(packed_.elements[b][slot]);
      const double dt = is_slow(b) ? subcycles_ * dt_ : dt_;
      const HexGeometry g = hex_geometry(corners_of(mesh_, e));
      Eigen::Matrix3d grad = Eigen::Matrix3d::Zero();
      for (int k = 0; k < 8; ++k) {
        const std::size_t row = std::size_t(packed_.layout.to_solver[std::size_t(mesh_.elements[e][std::size_t(k)])]) * packed_.width();
        for (int c = 0; c < 3; ++c) {
          const std::size_t at = row + std::size_t(c) * packed_.stride();
          grad.row(c) += (double(u_[at]) - dt * double(v_[at])) * g.gradient.col(k).transpose();
        }
      }
      const double strain = finite ? (Eigen::Matrix3d::Identity() + grad).determinant() - 1 : grad.trace();
      for (std::size_t l = 0; l < copies; ++l) {
        if (setup_.liquid_law) memory_[b][slot * copies + l] = strain;
        if (keep_ != Keep::nothing)
          state_[b][slot / lanes * std::size_t(liquid_state(keep_)) * (packed_.runs ? run_lanes : lanes) + (packed_.runs ? l : slot % lanes)] = R(strain);
      }
    }
}

template <class R>
void Run<R>::make_law(std::size_t b) {
  const LiquidLaw& law = *setup_.liquid_law;
  const auto& elements = packed_.elements[b];
  const std::size_t copies = packed_.runs ? run_lanes : 1, points = elements.size() * copies;
  std::vector<Vec3> centres;
  for (const std::int32_t e : elements)  // padding repeats the block's first element
    centres.insert(centres.end(), copies, centre_of(mesh_, std::size_t(e >= 0 ? e : elements[0])));
  memory_[b] = AlignedArray<double>(points * (2 + law.state_size()));
  law.initialise(centres, memory_[b].data() + 2 * points, points);
  laws_[b] = {&law, this, b};
  blocks_[b].law = {advance_law, &laws_[b], memory_[b].data(), points};
}

template <class R>
void Run<R>::advance_law(const void* law_of_block, const LiquidPoints& p) {
  const auto& [law, run, block] = *static_cast<const LawOfBlock*>(law_of_block);
  try {
    law->advance(p);
  } catch (const LiquidPointError& e) {
    const LawHook& hook = run->blocks_[block].law;
    throw run->located(e, block, std::size_t(p.pressure - (hook.memory + hook.points)) + e.point());
  }
}

template <class R>
NumericsError Run<R>::located(const NumericsError& error, std::size_t block, std::size_t point) const {
  const auto& elements = packed_.elements[block];
  const std::int32_t slot = elements[point / (packed_.runs ? run_lanes : 1)], e = slot >= 0 ? slot : elements[0];
  const Vec3 x = centre_of(mesh_, std::size_t(e));
  return NumericsError(fmt::format("{}, in mercury element {} at ({:.4g}, {:.4g}, {:.4g}) m", error.what(), e, x[0], x[1], x[2]));
}

template Run<float>::Run(const PackedMesh<float>&, const Mesh&, const NodalVolumes&, const RunSetup&, const SolveOptions&, double, int);
template void Run<float>::make_masses(const NodalVolumes&);
template void Run<float>::make_blocks();
template void Run<float>::make_rules(bool);
template void Run<float>::make_branches();
template double Run<float>::initial_pressure(std::size_t) const;
template void Run<float>::make_stress(std::size_t);
template void Run<float>::make_extras();
template void Run<float>::start_from(const std::vector<Vec3>&, AlignedArray<float>&);
template void Run<float>::remember_strain();
template void Run<float>::make_law(std::size_t);
template void Run<float>::advance_law(const void*, const LiquidPoints&);
template NumericsError Run<float>::located(const NumericsError&, std::size_t, std::size_t) const;
template Run<double>::Run(const PackedMesh<double>&, const Mesh&, const NodalVolumes&, const RunSetup&, const SolveOptions&, double, int);
template void Run<double>::make_masses(const NodalVolumes&);
template void Run<double>::make_blocks();
template void Run<double>::make_rules(bool);
template void Run<double>::make_branches();
template double Run<double>::initial_pressure(std::size_t) const;
template void Run<double>::make_stress(std::size_t);
template void Run<double>::make_extras();
template void Run<double>::start_from(const std::vector<Vec3>&, AlignedArray<double>&);
template void Run<double>::remember_strain();
template void Run<double>::make_law(std::size_t);
template void Run<double>::advance_law(const void*, const LiquidPoints&);
template NumericsError Run<double>::located(const NumericsError&, std::size_t, std::size_t) const;

}  // namespace calomel
