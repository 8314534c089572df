// Advancing nodes: those of a block, those that blocks share, and those with a rule. Included by kernel_impl.hpp.

/// v+ = v- + kick f / m, u += dt v+; fixed directions remain.
template <class R, bool Runs, bool Balance>
CALOMEL_INLINE void advance(R* u, R* v, const R* f, R inverse_mass, std::uint8_t fixed, const StepData<R>& s, double& kinetic) {
  typename Row<R, Runs>::Lane force[3], velocity[3], place[3];
  read_row<R, Runs>(f, force), read_row<R, Runs>(v, velocity), read_row<R, Runs>(u, place);
  const R a = s.kick * inverse_mass;
  for (int c = 0; c < 3; ++c) {
    if (fixed & (1 << c)) continue;
    const auto before = velocity[c];
    velocity[c] += a * force[c];
    place[c] += s.dt * velocity[c];
    if constexpr (Balance && !Runs) kinetic += 0.5 * double(before) * double(velocity[c]) / double(inverse_mass);
  }
  write_row<R, Runs>(v, velocity), write_row<R, Runs>(u, place);
}

template <class R, bool Runs, bool Balance>
CALOMEL_INLINE void advance_interior(const BlockData<R>& b, const StepData<R>& s, const R* force, double& kinetic) {
  constexpr int width = Row<R, Runs>::width;
  for (int r = 0; r < b.range_count; ++r) {
    const auto& range = b.ranges[r];
    if (!Runs && !Balance && range.fixed == 0) {  // the common case, whole rows at once
      using V4 = Vec<R, 4>;
      for (std::int32_t n = range.begin; n < range.end; ++n) {
        const V4 v = load<V4>(s.v + std::size_t(n) * 4) + s.kick * s.inverse_mass[n] * load<V4>(force + std::size_t(n - b.first_node) * 4);
        store<V4>(s.v + std::size_t(n) * 4, v);
        store<V4>(s.u + std::size_t(n) * 4, load<V4>(s.u + std::size_t(n) * 4) + s.dt * v);
      }
      continue;
    }
    for (std::int32_t n = range.begin; n < range.end; ++n)
      advance<R, Runs, Balance>(s.u + std::size_t(n) * width, s.v + std::size_t(n) * width, force + std::size_t(n - b.first_node) * width, s.inverse_mass[n],
                                range.fixed, s, kinetic);
  }
}

/// Sum of a shared node's forces in block order, of those blocks that are at work in this step.
template <class R, bool Runs>
CALOMEL_INLINE void sum_outbox(const Layout& layout, std::int32_t node, const StepData<R>& s, typename Row<R, Runs>::Lane (&force)[3]) {
  const std::size_t k = std::size_t(node - layout.first_shared);
  for (auto& f : force) f = typename Row<R, Runs>::Lane{};
  for (std::size_t i = layout.outbox_begin[k]; i < s.outbox_end[k]; ++i) {
    typename Row<R, Runs>::Lane part[3];
    read_row<R, Runs>(s.outbox + layout.outbox_rows[i] * Row<R, Runs>::width, part);
    for (int c = 0; c < 3; ++c) force[c] += part[c];
  }
}

template <class R, bool Runs, bool Balance>
void plain(const Layout& layout, std::size_t begin, std::size_t end, const StepData<R>& s, EnergyTerms* energy) {
  constexpr int width = Row<R, Runs>::width;
  double kinetic = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const std::int32_t n = layout.plain[i];
    typename Row<R, Runs>::Lane force[3];
    sum_outbox<R, Runs>(layout, n, s, force);
    alignas(64) R row[width];
    write_row<R, Runs>(row, force);
    advance<R, Runs, Balance>(s.u + std::size_t(n) * width, s.v + std::size_t(n) * width, row, s.inverse_mass[n], layout.fixed[std::size_t(n)], s, kinetic);
  }
  if (Balance && !Runs) energy->kinetic += kinetic;
}

/// A slip pair that may come apart along its one normal n, out of the mercury. Velocities `v` of the mercury and `steel` of the steel after free motion
/// become those after the step. Together they share their normal velocity while the pull that this takes, tension positive, remains below the strength;
/// apart they pull on each other with `hold` until the gap g = (u_s - u_m).n is gone at the end of a step, which leaves them with (v_s - v_m).n = -g / dt for
/// that step: momentum is kept, the energy of the impact is not, and counts as dissipated. Resisting: apart they pull with hold + resistance dg/dt, at the rate
/// after the step. Filmed: a film of the mercury remains on the steel: along the normal its mass is the steel's, together, where that makes no difference, and
/// apart.
template <class R, bool Runs, bool Balance, bool Resisting, bool Filmed>
CALOMEL_INLINE void advance_opening_pair(const SpecialData<R>& r, std::size_t rule, const StepData<R>& s, const typename Row<R, Runs>::Lane (&before)[3],
                                         const typename Row<R, Runs>::Lane (&steel_before)[3], typename Row<R, Runs>::Lane (&v)[3],
                                         typename Row<R, Runs>::Lane (&steel)[3], EnergyTerms* energy) {
  using L = typename Row<R, Runs>::Lane;
  constexpr int width = Row<R, Runs>::width, lanes = Runs ? run_lanes : 1;
  const L zero{}, one = L{} + R(1);
  const R* n = r.normal[0];
  const R film = Filmed ? r.film : R(0), mass_node = r.mass_node - film, mass_partner = r.mass_partner + film;  // along the normal
  const R share_node = mass_node / (mass_node + mass_partner), share_partner = mass_partner / (mass_node + mass_partner);
  L u[3], u_steel[3], was;
  read_row<R, Runs>(s.u + std::size_t(r.node) * width, u), read_row<R, Runs>(s.u + std::size_t(r.partner) * width, u_steel);
  R* open = s.extras.open + rule * lanes;
  if constexpr (Runs)
    was = load<L>(open);
  else
    was = *open;
  if constexpr (Filmed) {
    L vn_before{}, vn_free{}, sn_before{}, sn_free{};
    for (int c = 0; c < 3; ++c) vn_before += before[c] * n[c], vn_free += v[c] * n[c], sn_before += steel_before[c] * n[c], sn_free += steel[c] * n[c];
    const L lighter = (r.mass_node / mass_node - 1) * (vn_free - vn_before), heavier = (r.mass_partner / mass_partner - 1) * (sn_free - sn_before);
    for (int c = 0; c < 3; ++c) v[c] += lighter * n[c], steel[c] += heavier * n[c];
  }
  const L vn = v[0] * n[0] + v[1] * n[1] + v[2] * n[2], sn = steel[0] * n[0] + steel[1] * n[1] + steel[2] * n[2];
  const L gap = (u_steel[0] - u[0]) * n[0] + (u_steel[1] - u[1]) * n[1] + (u_steel[2] - u[2]) * n[2];
  const L common = share_node * vn + share_partner * sn, pull = mass_node / s.kick * (common - vn);
  const L parts = select(pull > zero + s.extras.strength[rule], one, zero);
  L hold = s.kick * s.extras.hold[rule] * (was + (one - was) * parts);
  if constexpr (Resisting) {
    // w = w_free - (hold + kick resistance w) (1/m_f + 1/m_s) of the relative velocity w = dg/dt, which has the sign that it has without resistance.
    const R give = 1 / mass_node + 1 / mass_partner;
    const L free = sn - vn - give * hold;
    const L drag = s.kick * select(free > zero, zero + s.extras.resistance[2 * rule], zero + s.extras.resistance[2 * rule + 1]);
    hold += (was + (one - was) * parts) * drag * free / (one + give * drag);
  }
  const L towards = hold * (1 / mass_node), back = hold * (1 / mass_partner);
  const L meets = select(gap + s.dt * (sn - back - vn - towards) <= zero, one, zero);
  const L now = was * (one - meets) + (one - was) * parts, held = one - now;
  const L apart = -1 / s.dt * (was * meets * gap);  // (v_s - v_m).n of a pair that meets
  const L change = held * (common - share_partner * apart - vn) + now * towards, steel_change = held * (common + share_node * apart - sn) - now * back;
  for (int c = 0; c < 3; ++c) v[c] += change * n[c], steel[c] += steel_change * n[c];
  if constexpr (Runs)
    store(open, now);
  else
    *open = now;
  if constexpr (Balance && !Runs) {
    const double half_way = 0.5 * double(s.dt) * double(mass_node) / double(s.kick) * double(change);
    double rel_before = 0, rel_after = 0;
    for (int c = 0; c < 3; ++c) {
      rel_before += double(n[c]) * (double(steel_before[c]) - double(before[c]));
      rel_after += double(n[c]) * (double(steel[c]) - double(v[c]));
    }
    if constexpr (Filmed) {
      double vn_before = 0, vn_after = 0, sn_before = 0, sn_after = 0;
      for (int c = 0; c < 3; ++c) {
        vn_before += double(n[c]) * double(before[c]);
        vn_after += double(n[c]) * double(v[c]);
        sn_before += double(n[c]) * double(steel_before[c]);
        sn_after += double(n[c]) * double(steel[c]);
      }
      energy->kinetic += 0.5 * double(film) * (sn_before * sn_after - vn_before * vn_after);
    }
    energy->dissipated += half_way * rel_before;
    energy->damped_after += half_way * rel_after;
    energy->apart += double(s.extras.hold[rule]) * double(now) * double(gap);
  }
}

/// Extended: pairs may come apart, and the mercury behind the rear face may be under pressure before the run. Resisting: their gaps take time to grow and to
/// close. Filmed: some of the mercury remains on the steel.
template <class R, bool Runs, bool Balance, bool Extended = false, bool Resisting = false, bool Filmed = false>
void special(const Layout& layout, const SpecialData<R>* rules, std::size_t begin, std::size_t end, const StepData<R>& s, EnergyTerms* energy) {
  using L = typename Row<R, Runs>::Lane;
  constexpr int width = Row<R, Runs>::width;
  L share, stress;
  if constexpr (Runs) {
    share = load<L>(s.load);
    stress = load<L>(s.end_stress);
  } else {
    share = s.load[0];
    stress = s.end_stress[0];
  }
  for (std::size_t i = begin; i < end; ++i) {
    const SpecialData<R>& r = rules[i];
    L force[3], v[3], before[3];
    sum_outbox<R, Runs>(layout, r.node, s, force);
    read_row<R, Runs>(s.v + std::size_t(r.node) * width, before);
    for (int c = 0; c < 3; ++c) {
      force[c] += stress * r.load_area[c];
      v[c] = r.fixed_node & (1 << c) ? L{} : before[c] + s.kick / r.mass_node * force[c];
    }
    if constexpr (Balance && !Runs)
      for (int c = 0; c < 3; ++c) {
        energy->boundary_before -= 0.5 * double(s.dt) * double(stress) * double(r.load_area[c]) * double(before[c]);
        energy->boundary_after -= 0.5 * double(s.dt) * double(stress) * double(r.load_area[c]) * double(v[c]);
      }
    if (r.rear_area > 0) {
      // p = p0 + p', give p' = push v_n, not below the cutoff; v_n at mid-step, towards the end of the step the stiffer what lies
      // behind is (a rigid wall would keep a velocity that the cutoff left, with changing sign); implicit, so the face never limits the step.
      const R* n = r.rear_normal;
      const L vn_before = before[0] * n[0] + before[1] * n[1] + before[2] * n[2];
      const L vn_free = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
      L p0 = share * r.rear_p0;
      if constexpr (Extended) p0 = p0 + s.extras.rear_initial[i];
      const R a = s.kick * r.rear_area / r.mass_node, push = s.rear_late * s.rear_push;
      const L p_wave = p0 + push / (s.rear_give + push * a) * (vn_free - a * p0 + s.rear_early * vn_before);
      const L p_least = L{} - s.cutoff;
      const L p = greater(p_wave, p_least);
      const L vn_after = vn_free - a * p;
      for (int c = 0; c < 3; ++c) v[c] += (vn_after - vn_free) * n[c];
      if constexpr (Balance && !Runs) {
        energy->boundary_before += 0.5 * double(s.dt) * double(p) * double(r.rear_area) * double(vn_before);
        energy->boundary_after += 0.5 * double(s.dt) * double(p) * double(r.rear_area) * double(vn_after);
      }
    }
    L u[3];
    if (r.partner >= 0) {
      L steel_force[3], steel[3], steel_before[3];
      sum_outbox<R, Runs>(layout, r.partner, s, steel_force);
      read_row<R, Runs>(s.v + std::size_t(r.partner) * width, steel_before);
      for (int c = 0; c < 3; ++c) steel[c] = r.fixed_partner & (1 << c) ? L{} : steel_before[c] + s.kick / r.mass_partner * steel_force[c];
      // Common normal momentum: a_n = (F_s + F_f).n / (m_s + m_f).
      const R share_node = r.mass_node / (r.mass_node + r.mass_partner), share_partner = r.mass_partner / (r.mass_node + r.mass_partner);
      const bool may_open = Extended && r.normals == 1;
      if constexpr (Extended)
        if (may_open) advance_opening_pair<R, Runs, Balance, Resisting, Filmed>(r, i, s, before, steel_before, v, steel, energy);
      for (int k = 0; k < r.normals && !may_open; ++k) {
        const R* n = r.normal[k];
        const L vn = v[0] * n[0] + v[1] * n[1] + v[2] * n[2], sn = steel[0] * n[0] + steel[1] * n[1] + steel[2] * n[2];
        const L common = share_node * vn + share_partner * sn;
        for (int c = 0; c < 3; ++c) v[c] += (common - vn) * n[c], steel[c] += (common - sn) * n[c];
      }
      read_row<R, Runs>(s.u + std::size_t(r.partner) * width, u);
      for (int c = 0; c < 3; ++c) u[c] += s.dt * steel[c];
      write_row<R, Runs>(s.u + std::size_t(r.partner) * width, u);
      write_row<R, Runs>(s.v + std::size_t(r.partner) * width, steel);
      if constexpr (Balance && !Runs)
        for (int c = 0; c < 3; ++c) energy->kinetic += 0.5 * double(r.mass_partner) * double(steel_before[c]) * double(steel[c]);
    }
    read_row<R, Runs>(s.u + std::size_t(r.node) * width, u);
    for (int c = 0; c < 3; ++c) u[c] += s.dt * v[c];
    write_row<R, Runs>(s.u + std::size_t(r.node) * width, u);
    write_row<R, Runs>(s.v + std::size_t(r.node) * width, v);
    if constexpr (Balance && !Runs)
      for (int c = 0; c < 3; ++c) energy->kinetic += 0.5 * double(r.mass_node) * double(before[c]) * double(v[c]);
  }
}

/// Apart, so that what the compiler makes of the others, to the last bit, does not depend on it.
template <class R, bool Runs, bool Balance, bool Resisting, bool Filmed>
[[gnu::noinline]] void special_apart(const Layout& layout, const SpecialData<R>* rules, std::size_t begin, std::size_t end, const StepData<R>& s,
                                     EnergyTerms* energy) {
  special<R, Runs, Balance, true, Resisting, Filmed>(layout, rules, begin, end, s, energy);
}

/// Of pairs that may come apart, by what their rules have.
template <class R, bool Runs, bool Balance>
void special_extended(const Layout& layout, const SpecialData<R>* rules, std::size_t begin, std::size_t end, const StepData<R>& s, EnergyTerms* energy) {
  if (s.extras.resistance && s.extras.films) return special_apart<R, Runs, Balance, true, true>(layout, rules, begin, end, s, energy);
  if (s.extras.resistance) return special_apart<R, Runs, Balance, true, false>(layout, rules, begin, end, s, energy);
  if (s.extras.films) return special_apart<R, Runs, Balance, false, true>(layout, rules, begin, end, s, energy);
  special<R, Runs, Balance, true>(layout, rules, begin, end, s, energy);
}
