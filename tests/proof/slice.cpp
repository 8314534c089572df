#include "tests/proof/slice.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/proof/slice_kernels.hpp"

namespace calomel::proof {

// ------------------------------------------------------------------------------------------------------------------------------------------------ set-up
void Grid::fill(Cell kind, double x_begin, double x_end, double z_begin, double z_end) {
  for (int j = 0; j < nz; ++j)
    for (int i = 0; i < nx; ++i)
      if (x(i + 0.5) > x_begin && x(i + 0.5) < x_end && z(j + 0.5) > z_begin && z(j + 0.5) < z_end) cells[std::size_t(index(i, j))] = kind;
}

Solid Solid::from_young(double density, double young, double poisson) {
  return {density, young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))};
}

Slice::Slice(const Grid& grid, const Solid& steel, const Mercury& mercury) : grid_(grid), steel_(steel), mercury_(mercury) {
  const std::size_t n = grid_.cells.size();
  density_.assign(n, 0);
  lambda_.assign(n, 0);
  mu_.assign(n, 0);
  extra_mass_.assign(n, 0);
  p0_.assign(n, 0);
  heat_.assign(n, 0);
  for (std::size_t c = 0; c < n; ++c)
    if (grid_.cells[c] == Cell::solid) density_[c] = steel.density, lambda_[c] = steel.lambda, mu_[c] = steel.mu;
  build();
}

void Slice::set_solid(const std::function<bool(double, double)>& where, const Solid& solid) {
  for (int j = 0; j < grid_.nz; ++j)
    for (int i = 0; i < grid_.nx; ++i)
      if (grid_.at(i, j) == Cell::solid && where(grid_.x(i + 0.5), grid_.z(j + 0.5))) {
        const auto c = std::size_t(grid_.index(i, j));
        density_[c] = solid.density;
        lambda_[c] = solid.lambda;
        mu_[c] = solid.mu;
      }
  build();
}

void Slice::set_pressure(const std::function<double(double, double)>& p0) {
  for (int j = 0; j < grid_.nz; ++j)
    for (int i = 0; i < grid_.nx; ++i)
      if (grid_.at(i, j) == Cell::mercury) p0_[std::size_t(grid_.index(i, j))] = Real(p0(grid_.x(i + 0.5), grid_.z(j + 0.5)));
}

void Slice::set_heated_solid(const std::function<double(double, double)>& stress) {
  for (int j = 0; j < grid_.nz; ++j)
    for (int i = 0; i < grid_.nx; ++i)
      if (grid_.at(i, j) == Cell::solid) heat_[std::size_t(grid_.index(i, j))] = Real(stress(grid_.x(i + 0.5), grid_.z(j + 0.5)));
}

void Slice::add_mass(double x_begin, double x_end, double z, double mass_per_area) {
  const int j = int(std::lround((z - grid_.z0) / grid_.h));
  for (int i = 0; i < grid_.nx; ++i)
    if (grid_.x(i + 0.5) > x_begin && grid_.x(i + 0.5) < x_end) extra_mass_[std::size_t(grid_.index(i, j))] = mass_per_area;
  build();
}

void Slice::set_contacts(const std::function<void(Contact&, double, double)>& change) {
  for (auto& c : contacts_) {
    const int i = c.face % grid_.nx, j = c.face / grid_.nx;
    c.across_z ? change(c, grid_.x(i + 0.5), grid_.z(j)) : change(c, grid_.x(i), grid_.z(j + 0.5));
  }
}

void Slice::build() {
  const Grid& g = grid_;
  const auto n = g.cells.size();
  const auto solid = [&](int i, int j) { return g.at(i, j) == Cell::solid; };
  const auto liquid = [&](int i, int j) { return g.at(i, j) == Cell::mercury; };
  mercury_cells_.clear();
  solid_cells_.clear();
  mercury_x_.clear();
  mercury_z_.clear();
  solid_x_.clear();
  solid_z_.clear();
  corners_.clear();
  contacts_.clear();
  rear_.clear();
  free_.clear();
  for (auto* field : {&inverse_mass_x_, &inverse_mass_z_, &p_modulus_, &lame_, &corner_mu_, &pair_x_, &pair_z_}) field->assign(n, 0);
  modulus_.assign(std::size_t(g.nz), 0);
  greatest_speed_ = 0;
  greatest_bending_ = 1;

  const auto runs = [&](std::vector<Run>& to, const auto& holds) {
    for (int j = 1; j < g.nz; ++j)
      for (int i = 1; i < g.nx; ++i) {
        if (!holds(i, j)) continue;
        int end = i + 1;
        while (end < g.nx && holds(end, j)) ++end;
        to.push_back({g.index(i, j), g.index(end, j), j});
        i = end;
      }
  };
  runs(mercury_cells_, liquid);
  runs(solid_cells_, solid);
  runs(mercury_x_, [&](int i, int j) { return liquid(i, j) && liquid(i - 1, j); });
  runs(mercury_z_, [&](int i, int j) { return liquid(i, j) && liquid(i, j - 1); });

  for (int j = 0; j < g.nz; ++j) {
    const double speed = 1 + mercury_.speed_gradient * (g.z(j + 0.5) - mercury_.gradient_middle);
    modulus_[std::size_t(j)] = Real(mercury_.modulus() * speed * speed);
  }
  std::vector<double> bending(n, 0);
  for (std::size_t c = 0; c < n; ++c)
    if (g.cells[c] == Cell::solid) {
      const Solid s{density_[c], lambda_[c], mu_[c]};
      p_modulus_[c] = Real(s.p_modulus());
      lame_[c] = Real(s.lambda);
      bending[c] = s.bending_modulus();
      greatest_speed_ = std::max(greatest_speed_, std::sqrt(s.p_modulus() / s.density));
      greatest_bending_ = std::max(greatest_bending_, 1 + 0.4 * s.bending_modulus() / s.p_modulus());
    }

  // Faces. A face holds half the mass of the cell on either side.
  for (int j = 1; j < g.nz; ++j)
    for (int i = 1; i < g.nx; ++i) {
      const int c = g.index(i, j);
      for (const bool across_z : {false, true}) {
        const int i0 = across_z ? i : i - 1, j0 = across_z ? j - 1 : j, c0 = g.index(i0, j0);
        const Cell before = g.at(i0, j0), after = g.at(i, j);
        const bool held = before == Cell::rigid || after == Cell::rigid;
        if (before == Cell::solid || after == Cell::solid) {
          const double mass = 0.5 * g.h * (density_[std::size_t(c0)] + density_[std::size_t(c)]) + (across_z ? extra_mass_[std::size_t(c)] : 0);
          (across_z ? inverse_mass_z_ : inverse_mass_x_)[std::size_t(c)] = held ? Real(0) : Real(1 / mass);
        }
        for (const int sign : {1, -1}) {
          const Cell inside = sign > 0 ? before : after, outside = sign > 0 ? after : before;
          Contact contact{.face = c, .cell = sign > 0 ? c0 : c, .across_z = across_z, .sign = sign, .strength = mercury_.cutoff, .suction = mercury_.cutoff};
          if (inside == Cell::mercury && outside == Cell::solid) contacts_.push_back(contact);
          if (inside == Cell::mercury && outside == Cell::vacuum) free_.push_back(contact);
          if ((inside == Cell::mercury || inside == Cell::solid) && outside == Cell::continuing) rear_.push_back(contact);
        }
        // Pairs of solid cells: a cell with a solid neighbour on one side only gives its whole share to that pair.
        if (before == Cell::solid && after == Cell::solid) {
          const int di = across_z ? 0 : 1, dj = across_z ? 1 : 0;
          const double share = (solid(i0 - di, j0 - dj) ? 0.5 : 1.0) + (solid(i + di, j + dj) ? 0.5 : 1.0);
          (across_z ? pair_z_ : pair_x_)[std::size_t(c)] = Real(share / 12 * std::min(bending[std::size_t(c0)], bending[std::size_t(c)]));
        }
      }
      // Corners: in the solid the harmonic mean of its cells; three quarters at an inner corner; none at a surface.
      int count = 0;
      double compliance = 0;
      for (const int cell : {c, c - 1, c - g.nx, c - g.nx - 1})
        if (g.cells[std::size_t(cell)] == Cell::solid && mu_[std::size_t(cell)] > 0) ++count, compliance += 1 / mu_[std::size_t(cell)];
      if (count >= 3) corner_mu_[std::size_t(c)] = Real(count * count / 4.0 / compliance);
    }
  runs(solid_x_, [&](int i, int j) { return solid(i, j) || solid(i - 1, j); });
  runs(solid_z_, [&](int i, int j) { return solid(i, j) || solid(i, j - 1); });
  runs(corners_, [&](int i, int j) { return corner_mu_[std::size_t(g.index(i, j))] > 0; });
}

Gauge Slice::gauge(double x, double z, bool along_x, double length) const {
  const Grid& g = grid_;
  Gauge gauge;
  // The outermost two solid cells below the gauge, from the nearer side.
  for (const int side : {-1, 1}) {
    const double along = (along_x ? x : z) + side * length / 2;
    const double place = (along - (along_x ? g.x0 : g.z0)) / g.h;
    const int k = int(std::floor(place));
    const double share = place - k;
    const double middle = along_x ? g.z(g.nz / 2.0) : g.x(g.nx / 2.0);
    const bool from_high = along_x ? z > middle : x > middle;
    const int across = along_x ? g.nz : g.nx;
    const auto at = [&](int a, int depth) { return along_x ? g.index(a, depth) : g.index(depth, a); };
    int depth = from_high ? across - 1 : 0;
    const int inward = from_high ? -1 : 1;
    while (depth >= 0 && depth < across && g.cells[std::size_t(at(k, depth))] != Cell::solid) depth += inward;
    if (depth < 0 || depth >= across) throw std::runtime_error("a gauge has no wall below it");
    for (const int cell : {0, 1})
      for (const int next : {0, 1}) {
        const double weight = side / length * (cell == 0 ? 1.5 : -0.5) * (next == 1 ? share : 1 - share);
        (along_x ? gauge.x_faces : gauge.z_faces).push_back(at(k + next, depth + cell * inward));
        (along_x ? gauge.x_weights : gauge.z_weights).push_back(weight);
      }
  }
  return gauge;
}

double Slice::stable_step() const {
  const double h = grid_.h;
  double step = 1;
  if (greatest_speed_ > 0) step = h / (greatest_speed_ * std::sqrt(2 * greatest_bending_ * (1 + zener.strength)));
  if (!mercury_cells_.empty()) {  // dt (dt + 2 lag) < 4 / omega^2, omega = sqrt(8) c / h
    const double c = std::sqrt(double(*std::max_element(modulus_.begin(), modulus_.end())) / mercury_.density);
    const double lag = (mercury_.viscosity + relaxing.viscosity) / mercury_.modulus() + mercury_.collapse * h / c;
    step = std::min(step, std::sqrt(lag * lag + h * h / (2 * c * c)) - lag);
  }
  return step_share * step;
}

// ------------------------------------------------------------------------------------------------------------------------------------------------- steps
State Slice::rest() const {
  State s;
  const auto n = grid_.cells.size();
  for (auto* field : {&s.vx, &s.vz, &s.p, &s.e, &s.opened, &s.ux, &s.uz, &s.sxx, &s.szz, &s.sxz, &s.exx, &s.ezz, &s.factor, &s.plastic}) field->assign(n, 0);
  if (relaxing.viscosity > 0) s.a.assign(n, 0);
  if (nucleation.number > 0) s.a.assign(n, 1), s.b.assign(n, 1);
  if (bubbles.fraction[0] > 0 || bubbles.fraction[1] > 0) s.a.assign(n, 1), s.b.assign(n, 0), s.c.assign(n, 1), s.d.assign(n, 0);
  if (zener.strength > 0)
    for (auto* field : {&s.mxx, &s.mzz, &s.mxz}) field->assign(n, 0);
  s.syy.assign(n, 0);
  s.contacts = contacts_;
  s.contacts.insert(s.contacts.end(), rear_.begin(), rear_.end());
  for (auto& c : s.contacts)
    if (c.gas_gap > 0) c.apart = true, c.gap = c.gas_gap;
  return s;
}

void Slice::advance_velocity(State& s, double dt) const {
  const Real a = Real(dt / (mercury_.density * grid_.h));
  for (const Run& r : mercury_x_) kernel::accelerate(&s.vx[r.begin], &s.p[r.begin], &s.p[r.begin - 1], a, r.end - r.begin);
  for (const Run& r : mercury_z_) kernel::accelerate(&s.vz[r.begin], &s.p[r.begin], &s.p[r.begin - grid_.nx], a, r.end - r.begin);
  for (const Run& r : solid_x_)
    kernel::accelerate_solid(&s.ux[r.begin], &s.sxx[r.begin], &s.sxx[r.begin - 1], &s.sxz[r.begin + grid_.nx], &s.sxz[r.begin], &inverse_mass_x_[r.begin],
                             Real(dt), r.end - r.begin);
  for (const Run& r : solid_z_)
    kernel::accelerate_solid(&s.uz[r.begin], &s.szz[r.begin], &s.szz[r.begin - grid_.nx], &s.sxz[r.begin + 1], &s.sxz[r.begin], &inverse_mass_z_[r.begin],
                             Real(dt), r.end - r.begin);
  const double per_mass = 2 / (mercury_.density * grid_.h);
  for (const Contact& c : free_) (c.across_z ? s.vz : s.vx)[c.face] += Real(c.sign * dt * per_mass * s.p[c.cell]);

  const std::size_t wetted = contacts_.size();
  for (std::size_t k = 0; k < wetted; ++k) {
    Contact& c = s.contacts[k];
    Real& v = (c.across_z ? s.vz : s.vx)[c.face];
    Real& u = (c.across_z ? s.uz : s.ux)[c.face];
    const double solid_mass = (c.across_z ? inverse_mass_z_ : inverse_mass_x_)[c.face];
    const double both = dt * (per_mass + solid_mass);
    const double away = c.sign * double(v) + dt * per_mass * s.p[c.cell], wall = c.sign * double(u);  // without the traction between them
    double traction = 0;                                                                              // compression
    if (!c.apart) {
      traction = (away - wall) / both;
      if (traction < -c.strength) {
        c.apart = true;
        c.gap = 0;
        if (c.brittle) c.strength = 0, c.suction = 0;
      }
    }
    if (c.apart) {
      double least = 0;
      traction = -c.suction;
      if (c.gas_gap > 0) {  // isothermal gas at an ambient pressure of 1e5 Pa
        least = 0.05 * c.gas_gap;
        traction = 1e5 * (c.gas_gap / c.gap - 1);
      }
      const double opening = (wall - away) + both * traction, gap = c.gap + dt * opening;
      if (gap > least) {
        c.gap = gap;
      } else {  // it closes within the step, without rebound
        traction += ((least - c.gap) / dt - opening) / both;
        c.gap = least;
        c.apart = c.gas_gap > 0;
      }
    }
    v = Real(c.sign * (away - dt * per_mass * traction));
    u = Real(c.sign * (wall + dt * solid_mass * traction));
  }

  // What lies behind a face that continues carries rho c times the velocity on top of its share of the heating pressure, and what comes back from further
  // behind.
  const std::size_t faces = s.contacts.size() - wetted;
  if (behind.coefficient != 0 && s.sent.empty()) s.sent.assign(faces * std::size_t(std::max(1L, std::lround(behind.delay / dt))), 0);
  if (!s.sent.empty()) s.time_of_ring = (s.time_of_ring + faces) % s.sent.size();
  for (std::size_t k = wetted; k < s.contacts.size(); ++k) {
    Contact& c = s.contacts[k];
    const bool solid = grid_.cells[c.cell] == Cell::solid;
    const int inner = c.cell - c.sign * (c.across_z ? grid_.nx : 1);
    const auto& heat = solid ? heat_ : p0_;
    const double p0 = s.ramp * (1.5 * heat[c.cell] - 0.5 * heat[inner]);
    if (solid) {
      Real& u = (c.across_z ? s.uz : s.ux)[c.face];
      const double share = dt * (c.across_z ? inverse_mass_z_ : inverse_mass_x_)[c.face], z = std::sqrt(density_[c.cell] * double(p_modulus_[c.cell]));
      const double now = (c.sign * double(u) - share * (p0 + 0.5 * z * c.gap)) / (1 + 0.5 * share * z);
      u = Real(c.sign * now);
      c.gap = now;  // of a face that continues: its velocity, for the next step
    } else {
      Real& v = (c.across_z ? s.vz : s.vx)[c.face];
      const double share = dt * per_mass, z = std::sqrt(mercury_.density * double(modulus_[c.cell / grid_.nx])), before = c.sign * double(v);
      const double alone = before + share * s.p[c.cell];
      Real* const sent = s.sent.empty() ? nullptr : &s.sent[s.time_of_ring + (k - wetted)];
      const double back = sent ? behind.coefficient * *sent : 0;
      double now = (alone - share * (p0 + back + 0.5 * z * before)) / (1 + 0.5 * share * z), pressure = back + 0.5 * z * (now + before);
      if (p0 + pressure < -c.strength) now = alone + share * c.strength, pressure = -c.strength - p0;
      if (sent) *sent = Real(pressure + 0.5 * z * (now + before));
      v = Real(c.sign * now);
    }
  }
}

void Slice::mercury_pressure(State& s, double dt, double ramp) const {
  kernel::Liquid q{.modulus = 0,
                   .viscosity = Real(mercury_.viscosity),
                   .front = 0,
                   .cutoff = Real(mercury_.cutoff),
                   .dt = Real(dt),
                   .per_h = Real(1 / grid_.h),
                   .ramp = Real(ramp)};
  for (const Run& r : mercury_cells_) {
    const int b = r.begin, n = r.end - r.begin, up = r.begin + grid_.nx;
    q.modulus = modulus_[std::size_t(r.row)];
    q.front = Real(mercury_.collapse * grid_.h * std::sqrt(mercury_.density * double(q.modulus)));
    if (!s.c.empty()) {
      kernel::Cloud cloud{};
      for (int i = 0; i < 2; ++i) {
        const double radius = bubbles.radius[i], inertia = mercury_.density * radius * radius;
        cloud.fraction[i] = Real(bubbles.fraction[i]);
        cloud.per_inertia[i] = Real(1 / inertia);
        cloud.surface[i] = Real(2 * bubbles.tension / radius);
        cloud.damping[i] = Real(4 * bubbles.viscosity / inertia);
      }
      cloud.ambient = Real(bubbles.ambient);
      kernel::bubbly(&s.p[b], &s.e[b], &s.opened[b], &s.a[b], &s.b[b], &s.c[b], &s.d[b], &p0_[b], &s.vx[b], &s.vz[b], &s.vz[up], q, cloud, n);
    } else if (nucleation.number > 0) {
      const double radius = nucleation.radius, all = nucleation.number * 4 / 3 * std::numbers::pi * radius * radius * radius;
      const kernel::Nuclei nuclei{.fraction = {Real(all * (1 - nucleation.stronger)), Real(all * nucleation.stronger)},
                                  .cutoff = {Real(mercury_.cutoff), Real(mercury_.cutoff + nucleation.strength)},
                                  .speed = Real(std::sqrt(2 / (3 * mercury_.density)) / radius)};
      kernel::nucleation(&s.p[b], &s.e[b], &s.opened[b], &s.a[b], &s.b[b], &p0_[b], &s.vx[b], &s.vz[b], &s.vz[up], q, nuclei, n);
    } else if (relaxing.viscosity > 0) {
      const double keep = std::exp(-dt / relaxing.time);
      kernel::relaxing(&s.p[b], &s.e[b], &s.opened[b], &s.a[b], &p0_[b], &s.vx[b], &s.vz[b], &s.vz[up], q, Real(keep), Real(relaxing.viscosity * (1 - keep)),
                       n);
    } else if (tait.exponent > 0) {
      kernel::tait(&s.p[b], &s.e[b], &s.opened[b], &p0_[b], &s.vx[b], &s.vz[b], &s.vz[up], q, Real(tait.exponent), n);
    } else {
      kernel::riemer(&s.p[b], &s.e[b], &s.opened[b], &p0_[b], &s.vx[b], &s.vz[b], &s.vz[up], q, n);
    }
  }
}

void Slice::solid_stress(State& s, double dt, double ramp_step) const {
  const Real dt_per_h = Real(dt / grid_.h);
  const int up = grid_.nx;
  for (const Run& r : solid_cells_)
    kernel::strain_increments(&s.exx[r.begin], &s.ezz[r.begin], &s.ux[r.begin], &s.uz[r.begin], &s.uz[r.begin + up], dt_per_h, r.end - r.begin);
  std::vector<Real> dxx(std::size_t(grid_.nx)), dzz(std::size_t(grid_.nx));
  const bool memory = zener.strength > 0;
  const Real keep = memory ? Real(std::exp(-dt / zener.time)) : Real(0), strength = Real(zener.strength);
  const auto change = [&](std::vector<Real>& stress, std::vector<Real>& held, const Real* d, int begin, int n) {
    if (memory)
      kernel::add_with_memory(&stress[begin], &held[begin], d, keep, strength, n);
    else
      kernel::add(&stress[begin], d, n);
  };
  for (const Run& r : solid_cells_) {
    const int b = r.begin, n = r.end - r.begin;
    kernel::normal_stress(dxx.data(), dzz.data(), &s.exx[b], &s.ezz[b], &s.exx[b - up], &s.exx[b + up], &p_modulus_[b], &lame_[b], &pair_z_[b],
                          &pair_z_[b + up], &pair_x_[b], n);
    change(s.sxx, s.mxx, dxx.data(), b, n);
    change(s.szz, s.mzz, dzz.data(), b, n);
    if (ramp_step != 0)
      for (int c = b; c < r.end; ++c) s.sxx[c] -= heat_[c] * Real(ramp_step), s.szz[c] -= heat_[c] * Real(ramp_step);
    if (yielding.stress > 0)
      for (int c = b; c < r.end; ++c) s.syy[c] += lame_[c] * (s.exx[c] + s.ezz[c]) - heat_[c] * Real(ramp_step);
    if (s.keep_strain)
      for (int c = b; c < r.end; ++c) s.total_xx[c] += s.exx[c], s.total_zz[c] += s.ezz[c];
  }
  for (const Run& r : corners_) {
    const int b = r.begin, n = r.end - r.begin;
    kernel::shear_stress(dxx.data(), &s.ux[b], &s.ux[b - up], &s.uz[b], &s.uz[b - 1], &corner_mu_[b], dt_per_h, n);
    change(s.sxz, s.mxz, dxx.data(), b, n);
  }
  if (yielding.stress > 0) yield(s);
}

/// Radial return to von Mises' surface with isotropic hardening, at the cells with the mean of the shear stresses at their corners; a corner takes the mean
/// factor of its cells.
void Slice::yield(State& s) const {
  const int up = grid_.nx;
  bool yields = false;
  for (const Run& r : solid_cells_)
    for (int c = r.begin; c < r.end; ++c) {
      const Real mean = (s.sxx[c] + s.syy[c] + s.szz[c]) / 3, xx = s.sxx[c] - mean, yy = s.syy[c] - mean, zz = s.szz[c] - mean;
      const Real xz = Real(0.25) * (s.sxz[c] + s.sxz[c + 1] + s.sxz[c + up] + s.sxz[c + up + 1]);
      const Real mises2 = Real(1.5) * (xx * xx + yy * yy + zz * zz + 2 * xz * xz), limit = Real(yielding.stress) + Real(yielding.hardening) * s.plastic[c];
      s.factor[c] = 1;
      if (mises2 <= limit * limit) continue;
      yields = true;
      const double mises = std::sqrt(double(mises2)), mu = mu_[c], flow = (mises - limit) / (3 * mu + yielding.hardening);
      const Real f = Real(1 - 3 * mu * flow / mises);
      s.plastic[c] += Real(flow);
      s.factor[c] = f;
      s.sxx[c] = mean + f * xx;
      s.syy[c] = mean + f * yy;
      s.szz[c] = mean + f * zz;
    }
  if (!yields) return;
  for (const Run& r : corners_)
    for (int c = r.begin; c < r.end; ++c) {
      Real sum = 0;
      int count = 0;
      for (const int cell : {c, c - 1, c - up, c - up - 1})
        if (grid_.cells[std::size_t(cell)] == Cell::solid) sum += s.factor[cell], ++count;
      s.sxz[c] *= sum / Real(count);
    }
}

void Slice::advance_stress(State& s, double dt, double ramp_before, double ramp) const {
  s.ramp = ramp;
  mercury_pressure(s, dt, ramp);
  solid_stress(s, dt, ramp - ramp_before);
}

std::vector<double> Slice::run(double energy, double end, double interval, std::span<const Gauge> gauges, const State* initial, double initial_scale,
                               State* last) const {
  const int steps = int(std::ceil(interval / stable_step()));
  const double dt = interval / steps;
  const auto samples = std::size_t(std::lround(end / interval)) + 1;
  State s = rest();
  if (initial) {  // the heat of the pulse before remains: its mercury is stretched from p0 / K
    const Real a = Real(initial_scale);
    for (const auto field : {&State::vx, &State::vz, &State::ux, &State::uz, &State::sxx, &State::szz, &State::sxz})
      for (std::size_t c = 0; c < (s.*field).size(); ++c) (s.*field)[c] = a * (initial->*field)[c];
    for (const Run& r : mercury_cells_)
      for (int c = r.begin; c < r.end; ++c)
        s.e[c] = a * (initial->e[c] - Real(initial->ramp) * p0_[c] / modulus_[std::size_t(r.row)]), s.p[c] = -modulus_[std::size_t(r.row)] * s.e[c];
  }
  std::vector<double> record(gauges.size() * samples, 0), strain(gauges.size(), 0);
  const auto ramp = [&](double t) { return energy * (pulse_length > 0 ? std::min(t / pulse_length, 1.0) : 1.0); };
  double t = 0, before = 0;
  for (std::size_t k = 1; k < samples; ++k) {
    for (int m = 0; m < steps; ++m) {
      advance_velocity(s, dt);
      t = interval * (double(k - 1) + double(m + 1) / steps);
      advance_stress(s, dt, before, ramp(t));
      before = ramp(t);
      for (std::size_t g = 0; g < gauges.size(); ++g) {
        double rate = 0;
        for (std::size_t f = 0; f < gauges[g].x_faces.size(); ++f) rate += gauges[g].x_weights[f] * s.ux[gauges[g].x_faces[f]];
        for (std::size_t f = 0; f < gauges[g].z_faces.size(); ++f) rate += gauges[g].z_weights[f] * s.uz[gauges[g].z_faces[f]];
        strain[g] += dt * rate;
      }
    }
    for (std::size_t g = 0; g < gauges.size(); ++g) {
      if (!std::isfinite(strain[g])) throw std::runtime_error("a strain is no longer finite: the step is too long or the law unstable");
      record[g * samples + k] = strain[g];
    }
  }
  if (last) *last = std::move(s);
  return record;
}

double Slice::stored_energy(const State& s) const {
  double sum = 0;
  for (const Run& r : solid_cells_)
    for (int c = r.begin; c < r.end; ++c) sum += 0.5 * (double(s.sxx[c]) * s.total_xx[c] + double(s.szz[c]) * s.total_zz[c]);
  for (const Run& r : corners_)
    for (int c = r.begin; c < r.end; ++c) sum += 0.5 * double(s.sxz[c]) * s.sxz[c] / corner_mu_[c];
  for (const Run& r : mercury_cells_)
    for (int c = r.begin; c < r.end; ++c) sum += 0.5 * double(s.p[c]) * s.p[c] / modulus_[std::size_t(r.row)];
  return sum * grid_.h * grid_.h;
}

double Slice::kinetic_energy(const State& a, const State& b) const {
  double sum = 0;
  const double full = mercury_.density * grid_.h;
  for (const Run& r : mercury_x_)
    for (int c = r.begin; c < r.end; ++c) sum += 0.5 * full * a.vx[c] * b.vx[c];
  for (const Run& r : mercury_z_)
    for (int c = r.begin; c < r.end; ++c) sum += 0.5 * full * a.vz[c] * b.vz[c];
  for (const auto* list : {&contacts_, &free_, &rear_})
    for (const Contact& c : *list)
      if (grid_.cells[c.cell] == Cell::mercury) sum += 0.25 * full * (c.across_z ? a.vz : a.vx)[c.face] * (c.across_z ? b.vz : b.vx)[c.face];
  for (const Run& r : solid_x_)
    for (int c = r.begin; c < r.end; ++c)
      if (inverse_mass_x_[c] > 0) sum += 0.5 / inverse_mass_x_[c] * a.ux[c] * b.ux[c];
  for (const Run& r : solid_z_)
    for (int c = r.begin; c < r.end; ++c)
      if (inverse_mass_z_[c] > 0) sum += 0.5 / inverse_mass_z_[c] * a.uz[c] * b.uz[c];
  return sum * grid_.h;
}

}  // namespace calomel::proof
