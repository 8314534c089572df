// What a run shows and keeps: observations, pictures, checks and checkpoints.
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <istream>
#include <ostream>

#include "base/errors.hpp"
#include "forward/solver/run.hpp"

namespace calomel {

namespace {

template <class T>
void put(std::ostream& out, const T* data, std::size_t count) {
  out.write(reinterpret_cast<const char*>(data), std::streamsize(count * sizeof(T)));
}
template <class T>
void get(std::istream& in, T* data, std::size_t count) {
  in.read(reinterpret_cast<char*>(data), std::streamsize(count * sizeof(T)));
}

}  // namespace

template <class R>
double Run<R>::observe(const ObservationRow& row, std::size_t lane) const {
  double value = 0;
  for (std::size_t i = 0; i < row.nodes.size(); ++i) {
    const R* at = u_.data() + std::size_t(packed_.layout.to_solver[std::size_t(row.nodes[i])]) * packed_.width() + lane;
    for (std::size_t c = 0; c < 3; ++c) value += row.weights[i][c] * double(at[c * packed_.stride()]);
  }
  return value;
}

template <class R>
FieldSnapshot Run<R>::snapshot(std::int64_t n, bool motion_alone) const {
  FieldSnapshot f;
  f.time = double(n) * dt_;
  const std::size_t nodes = mesh_.nodes.size(), width = packed_.width(), stride = packed_.stride();
  f.displacement.resize(nodes);
  f.velocity.resize(nodes);
  for (std::size_t i = 0; i < nodes; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t at = std::size_t(packed_.layout.to_solver[i]) * width + c * stride;
      f.displacement[i][c] = double(u_[at]);
      f.velocity[i][c] = double(v_[at]);
    }
  if (!motion_alone) fill_elements(f, ramp(f.time) * setup_.energies[0]);
  return f;
}

template <class R>
void Run<R>::fill_elements(FieldSnapshot& f, double share) const {
  const bool finite = std::find(packed_.form.begin(), packed_.form.end(), Form::finite) != packed_.form.end();
  const std::size_t count = mesh_.elements.size(), copies = packed_.runs ? run_lanes : 1;
  f.pressure.resize(count);
  f.effective_stress.resize(count);
  f.time_at_cutoff.assign(count, 0);
  for (std::size_t b = 0; b < blocks_.size(); ++b)
    for (std::size_t slot = 0; slot < packed_.elements[b].size(); ++slot) {
      if (packed_.elements[b][slot] < 0) continue;
      const auto e = std::size_t(packed_.elements[b][slot]);
      const HexGeometry g = hex_geometry(corners_of(mesh_, e));
      Eigen::Matrix3d grad = Eigen::Matrix3d::Zero();
      double rate = 0;
      for (int k = 0; k < 8; ++k) {
        const auto n = std::size_t(mesh_.elements[e][std::size_t(k)]);
        grad += Eigen::Map<const Eigen::Vector3d>(f.displacement[n].data()) * g.gradient.col(k).transpose();
        rate += Eigen::Map<const Eigen::Vector3d>(f.velocity[n].data()).dot(g.gradient.col(k));
      }
      if (blocks_[b].liquid) {
        const double strain = finite ? (grad + Eigen::Matrix3d::Identity()).determinant() - 1 : grad.trace();
        f.pressure[e] = blocks_[b].law.advance ? memory_[b][blocks_[b].law.points + slot * copies]
                                               : setup_.liquid.pressure((setup_.p0.empty() ? 0 : setup_.p0[e] * share) + initial_pressure(e), strain, rate);
        if (keep_ == Keep::energies) f.time_at_cutoff[e] = time_at_cutoff(b, slot);
      } else {
        Eigen::Matrix3d strain = 0.5 * (grad + grad.transpose());
        if (finite) strain += 0.5 * grad.transpose() * grad;
        if (!setup_.thermal_strain.empty()) strain -= share * setup_.thermal_strain[e] * Eigen::Matrix3d::Identity();
        Eigen::Matrix3d stress = setup_.steel.lambda * strain.trace() * Eigen::Matrix3d::Identity() + 2 * setup_.steel.mu * strain;
        if (!setup_.initial_stress.empty()) {
          const auto& s = setup_.initial_stress[e];
          stress += Eigen::Matrix3d{{s[0], s[3], s[5]}, {s[3], s[1], s[4]}, {s[5], s[4], s[2]}};
        }
        f.pressure[e] = -stress.trace() / 3;
        f.effective_stress[e] = std::sqrt(1.5) * (stress - stress.trace() / 3 * Eigen::Matrix3d::Identity()).norm();
      }
    }
}

template <class R>
Eigen::Matrix3d Run<R>::steel_strain(std::size_t e) const {
  const bool finite = std::find(packed_.form.begin(), packed_.form.end(), Form::finite) != packed_.form.end();
  const HexGeometry g = hex_geometry(corners_of(mesh_, e));
  Eigen::Matrix3d grad = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 8; ++k) {
    const std::size_t row = std::size_t(packed_.layout.to_solver[std::size_t(mesh_.elements[e][std::size_t(k)])]) * packed_.width();
    for (int c = 0; c < 3; ++c) grad.row(c) += double(u_[row + std::size_t(c) * packed_.stride()]) * g.gradient.col(k).transpose();
  }
  Eigen::Matrix3d strain = 0.5 * (grad + grad.transpose());
  if (finite) strain += 0.5 * grad.transpose() * grad;
  return strain;
}

template <class R>
void Run<R>::check_finite(std::int64_t n) const {
  for (std::size_t i = 0; i < u_.size(); ++i) {
    if (std::isfinite(u_[i]) && std::abs(u_[i]) <= R(1)) continue;
    const auto solver_node = std::int32_t(i / packed_.width());
    std::size_t node = 0;
    while (packed_.layout.to_solver[node] != solver_node) ++node;
    const auto& x = mesh_.nodes[node];
    std::size_t element = 0;
    for (std::size_t e = 0; e < mesh_.elements.size() && element == 0; ++e)
      for (const NodeId m : mesh_.elements[e])
        if (std::size_t(m) == node) element = e;
    throw NumericsError(
        fmt::format("the displacements leave all bounds at step {} ({:.4g} s), node {} at ({:.4g}, {:.4g}, {:.4g}) m of {} element {}; step {:.3g} s, K {:.4g} "
                    "Pa, density {:.5g} kg/m^3",
                    n, double(n) * dt_, node, x[0], x[1], x[2], mesh_.region[element] == Region::mercury ? "mercury" : "steel", element, dt_,
                    setup_.liquid.bulk_modulus, setup_.liquid_density));
  }
}

template <class R>
std::pair<double, std::int32_t> Run<R>::greatest_stress() const {
  std::pair<double, std::int32_t> greatest{0, -1};
  if (keep_ != Keep::energies) return greatest;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    if (blocks_[b].liquid) continue;
    for (std::size_t slot = 0; slot < packed_.elements[b].size(); ++slot)
      if (packed_.elements[b][slot] >= 0 && double(state_[b][slot]) > greatest.first) greatest = {double(state_[b][slot]), packed_.elements[b][slot]};
  }
  return {std::sqrt(greatest.first), greatest.second};
}

template <class R>
double Run<R>::time_at_cutoff(std::size_t block, std::size_t slot) const {
  const std::size_t lanes = packed_.lanes();
  return double(state_[block][(slot / lanes * energy_state + state_time_at_cutoff) * lanes + slot % lanes]);
}

template <class R>
double Run<R>::time_at_cutoff() const {
  if (keep_ != Keep::energies) return 0;
  double volume = 0, sum = 0;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    if (!blocks_[b].liquid) continue;
    for (std::size_t slot = 0; slot < packed_.elements[b].size(); ++slot) {
      if (packed_.elements[b][slot] < 0) continue;
      const double own = hex_geometry(corners_of(mesh_, std::size_t(packed_.elements[b][slot]))).volume;
      volume += own;
      sum += own * time_at_cutoff(b, slot);
    }
  }
  return volume > 0 ? sum / volume : 0;
}

template <class R>
void Run<R>::save(std::ostream& out) const {
  put(out, u_.data(), u_.size());
  put(out, v_.data(), v_.size());
  for (const auto& s : state_) put(out, s.data(), s.size());
  for (const auto& m : memory_) put(out, m.data(), m.size());
  for (const auto& t : trace_) put(out, t.data(), t.size());
  put(out, open_.data(), open_.size());
  for (const auto& x : branch_) put(out, x.data(), x.size());
}

template <class R>
void Run<R>::restore(std::istream& in) {
  get(in, u_.data(), u_.size());
  get(in, v_.data(), v_.size());
  for (auto& s : state_) get(in, s.data(), s.size());
  for (auto& m : memory_) get(in, m.data(), m.size());
  for (auto& t : trace_) get(in, t.data(), t.size());
  get(in, open_.data(), open_.size());
  for (auto& x : branch_) get(in, x.data(), x.size());
  if (!branches_.empty()) sum_branches(0, mass_.size());
}

template double Run<float>::observe(const ObservationRow&, std::size_t) const;
template void Run<float>::fill_elements(FieldSnapshot&, double) const;
template FieldSnapshot Run<float>::snapshot(std::int64_t, bool) const;
template Eigen::Matrix3d Run<float>::steel_strain(std::size_t) const;
template void Run<float>::check_finite(std::int64_t) const;
template std::pair<double, std::int32_t> Run<float>::greatest_stress() const;
template double Run<float>::time_at_cutoff(std::size_t, std::size_t) const;
template double Run<float>::time_at_cutoff() const;
template void Run<float>::save(std::ostream&) const;
template void Run<float>::restore(std::istream&);
template double Run<double>::observe(const ObservationRow&, std::size_t) const;
template void Run<double>::fill_elements(FieldSnapshot&, double) const;
template FieldSnapshot Run<double>::snapshot(std::int64_t, bool) const;
template Eigen::Matrix3d Run<double>::steel_strain(std::size_t) const;
template void Run<double>::check_finite(std::int64_t) const;
template std::pair<double, std::int32_t> Run<double>::greatest_stress() const;
template double Run<double>::time_at_cutoff(std::size_t, std::size_t) const;
template double Run<double>::time_at_cutoff() const;
template void Run<double>::save(std::ostream&) const;
template void Run<double>::restore(std::istream&);

}  // namespace calomel
