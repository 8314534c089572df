// The phases of a step, and the same as an operator.
#include "forward/solver/run.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"

namespace calomel {

template <class R>
double Run<R>::ramp(double time) const {
  return setup_.pulse_length > 0 ? std::clamp(time / setup_.pulse_length, 0.0, 1.0) : 1.0;
}

template <class R>
void Run<R>::set_loads(StepData<R>& s, std::int64_t now, std::int64_t before) const {
  for (std::size_t l = 0; l < run_lanes; ++l) {
    const double energy = setup_.energies[std::min(l, setup_.energies.size() - 1)];
    s.load[l] = R(ramp(double(now) * dt_) * energy);
    s.load_before[l] = now > 0 ? R(ramp(double(before) * dt_) * energy) : R(0);
    s.end_stress[l] = R(setup_.end_stress.at(double(now) * dt_) * energy);
  }
}

template <class R>
StepPair<R> Run<R>::step(std::int64_t n, R* scratch) const {
  StepPair<R> pair{base_, {}, n % subcycles_ == 0, std::size_t(n % 2)};
  StepData<R>& s = pair.fast;
  s.scratch = scratch;
  set_loads(s, n, n - 1);
  s.kick = n == 0 ? R(dt_ / 2) : R(dt_);
  if (subcycles_ == 1) return pair;
  if (!pair.outer) {
    s.outbox_end = packed_.layout.outbox_fast_end.data();
    return pair;
  }
  // A slow block's forces act once in m steps, m times as strong; what it shares with fast ones it leaves in the outbox so.
  pair.slow = s;
  pair.slow.dt = R(subcycles_ * dt_);
  pair.slow.kick = R(subcycles_ * (n == 0 ? dt_ / 2 : dt_));
  pair.slow.outbox_scale = R(subcycles_);
  set_loads(pair.slow, n, n - subcycles_);
  return pair;
}

template <class R>
void Run<R>::advance_block(std::size_t b, const StepPair<R>& pair) {
  const StepData<R>& s = is_slow(b) ? pair.slow : pair.fast;
  if (packed_.runs) return kernel_.run_block(blocks_[b], s, keep_);
  EnergyTerms& energy = energies_[pair.parity][b];
  energy = {};
  kernel_.element_block(blocks_[b], s, keep_, &energy);
}

template <class R>
void Run<R>::advance_chunk(std::size_t c, const StepPair<R>& pair) {
  EnergyTerms& energy = energies_[pair.parity][blocks_.size() + c];
  energy = {};
  const Layout& layout = packed_.layout;
  const auto plain = [&](std::size_t begin, std::size_t end, const StepData<R>& s) {
    packed_.runs ? kernel_.run_plain(layout, begin, end, s) : kernel_.element_plain(layout, begin, end, s, keep_ == Keep::energies, &energy);
  };
  const StepData<R>& s = pair.fast;
  if (c < plain_chunks_) {
    plain(c * node_chunk, std::min(layout.first_slow_plain, (c + 1) * node_chunk), s);
  } else if (c >= plain_chunks_ + rule_chunks_) {
    StepData<R> slow = pair.slow;
    slow.kick = s.kick;  // the forces in the outbox are m-fold already
    const std::size_t begin = layout.first_slow_plain + (c - plain_chunks_ - rule_chunks_) * node_chunk;
    plain(begin, std::min(layout.plain.size(), begin + node_chunk), slow);
  } else {
    const std::size_t begin = (c - plain_chunks_) * node_chunk, end = std::min(rules_.size(), begin + node_chunk);
    packed_.runs ? kernel_.run_special(packed_.layout, rules_.data(), begin, end, s)
                 : kernel_.element_special(packed_.layout, rules_.data(), begin, end, s, keep_ == Keep::energies, &energy);
  }
}

template <class R>
void Run<R>::damp_nodes(std::size_t part, std::size_t parts) {
  const std::size_t stretches = node_chunks(mass_.size()), begin = stretches * part / parts, end = stretches * (part + 1) / parts;
  if (!motion_factor_.empty()) damp_motion(begin, end);
  if (!branches_.empty()) relax(begin * node_chunk, std::min(mass_.size(), end * node_chunk));
}

/// Of stretches of the nodes.
template <class R>
void Run<R>::damp_motion(std::size_t begin, std::size_t end) {
  const std::size_t width = packed_.width();
  for (std::size_t k = begin; k < end; ++k) {
    damped_[k] = 0;
    for (std::size_t n = k * node_chunk; n < std::min(mass_.size(), (k + 1) * node_chunk); ++n) {
      const double f = motion_factor_[n];
      R* v = v_.data() + n * width;
      if (keep_ == Keep::energies)
        for (std::size_t c = 0; c < 3; ++c) damped_[k] += 0.5 * mass_[n] * (1 - f * f) * double(v[c]) * double(v[c]);
      for (std::size_t c = 0; c < width; ++c) v[c] *= R(f);
    }
  }
}

template <class R>
void Run<R>::drag_slip() {
  const std::size_t stride = packed_.stride(), width = packed_.width();
  dragged_ = 0;
  for (std::size_t i = 0; i < mesh_.slip.size(); ++i) {
    const SlipPair& pair = mesh_.slip[i];
    if (setup_.slip_drag[i] == 0) continue;
    const auto steel = std::size_t(packed_.layout.to_solver[std::size_t(pair.steel)]),
               mercury = std::size_t(packed_.layout.to_solver[std::size_t(pair.mercury)]);
    const double together = mass_[steel] * mass_[mercury] / (mass_[steel] + mass_[mercury]), taken = -std::expm1(-dt_ * setup_.slip_drag[i] / together);
    for (std::size_t l = 0; l < stride; ++l) {
      R *of_steel = v_.data() + steel * width + l, *of_mercury = v_.data() + mercury * width + l;
      Vec3 along;  // velocity of the mercury against the steel, without what it has along the normals
      for (std::size_t c = 0; c < 3; ++c) along[c] = double(of_mercury[c * stride]) - double(of_steel[c * stride]);
      for (int k = 0; k < pair.count; ++k) {
        const Vec3& n = pair.normals[std::size_t(k)];
        const double normal = along[0] * n[0] + along[1] * n[1] + along[2] * n[2];
        for (std::size_t c = 0; c < 3; ++c) along[c] -= normal * n[c];
      }
      for (std::size_t c = 0; c < 3; ++c) {
        const double impulse = taken * together * along[c];
        of_steel[c * stride] += R(impulse / mass_[steel]);
        of_mercury[c * stride] -= R(impulse / mass_[mercury]);
        dragged_ += along[c] * impulse * (1 - 0.5 * taken);
      }
    }
  }
}

/// Of nodes: dx/dt = v - x / time is solved exactly over a step, in which v is constant.
template <class R>
void Run<R>::relax(std::size_t begin, std::size_t end) {
  const std::size_t width = packed_.width();
  const R* v = v_.data();
  for (const auto& branch : branches_) {
    const double left = std::exp(-dt_ / branch.time);
    const R keep = R(left), gain = R(branch.time * (1 - left));
    for (std::size_t i = begin * width; i < end * width; ++i) branch.x[i] = keep * branch.x[i] + gain * v[i];
  }
  sum_branches(begin, end);
}

template <class R>
void Run<R>::sum_branches(std::size_t begin, std::size_t end) {
  const std::size_t width = packed_.width();
  std::fill(relaxing_.data() + begin * width, relaxing_.data() + end * width, R(0));
  for (const auto& branch : branches_)
    for (std::size_t i = begin * width; i < end * width; ++i) relaxing_[i] += R(branch.share) * branch.x[i];
}

template <class R>
EnergyTerms Run<R>::energies(std::int64_t n) const {
  EnergyTerms sum;
  const auto& terms = energies_[std::size_t(n % 2)];
  const bool outer = n % subcycles_ == 0;
  const std::size_t blocks = outer ? blocks_.size() : packed_.layout.first_slow_block;
  for (std::size_t b = 0; b < blocks; ++b) sum.add(terms[b]);
  for (std::size_t c = 0; c < chunk_count(outer); ++c) sum.add(terms[blocks_.size() + c]);
  for (const double d : damped_) sum.damped_after += d;
  sum.damped_after += dragged_;
  return sum;
}

template <class R>
void Run<R>::apply_operator(const AlignedArray<R>& x, AlignedArray<R>& result, int threads, bool liquid_alone) const {
  // One step of kick 1 from rest in a linear liquid of the greatest stiffness, without loads, takes x to v = -M^-1 K x; damping C = beta K enters by the
  // velocity 2 x / dt, which is taken off again. Elements of finite strain are linear near the reference: a picometre.
  const bool linear = std::find(packed_.form.begin(), packed_.form.end(), Form::finite) == packed_.form.end();
  R greatest = 0;
  for (std::size_t i = 0; i < x.size() && !linear; ++i) greatest = std::max(greatest, std::abs(x[i]));
  const R scale = greatest > 0 ? R(1e-12) / greatest : R(1), rate = R(2 / dt_) * scale;
  AlignedArray<R> u(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) u[i] = scale * x[i], result[i] = rate * x[i];
  StepData<R> s = base_;
  s.u = u.data();
  s.v = result.data();
  s.bulk_modulus = R(setup_.liquid_stiffness());
  s.extras = {};
  s.relaxing = nullptr;
  s.dt = 0;
  s.kick = 1;
  s.quadratic = 0;
  s.cutoff = R(unlimited_cutoff);
  s.rear_give = 1;
  s.rear_push = 0;
  parallel_for(blocks_.size(), threads, [&](std::size_t b) {
    if (liquid_alone && !blocks_[b].liquid) {
      const std::size_t width = packed_.width();
      std::fill_n(s.outbox + blocks_[b].outbox * width, std::size_t(blocks_[b].shared_count) * width, R(0));
      return;
    }
    AlignedArray<R> scratch(scratch_size());
    StepData<R> own = s;
    own.scratch = scratch.data();
    BlockData<R> block = blocks_[b];
    // All of the liquid closing at once: b rho c h 2 / dt of stiffness beside K (1 + 2 beta / dt).
    if (block.liquid && base_.collapse > 0) {
      block.size = packed_.size[b].data();
      own.collapse = R(double(base_.collapse) / (0.5 * dt_ + double(base_.beta)));
    }
    block.law = {};
    block.initial = nullptr;
    EnergyTerms unused;
    packed_.runs ? kernel_.run_block(block, own, Keep::nothing) : kernel_.element_block(block, own, Keep::nothing, &unused);
  });
  EnergyTerms unused;
  const Layout& layout = packed_.layout;
  packed_.runs ? kernel_.run_plain(layout, 0, layout.plain.size(), s) : kernel_.element_plain(layout, 0, layout.plain.size(), s, false, &unused);
  // Faces that may part are apart here: together, which takes a freedom away, the greatest eigenvalue is no greater (Cauchy's interlacing).
  std::vector<SpecialData<R>> rules = rules_;
  if (faces_may_part(setup_))
    for (auto& r : rules)
      if (r.normals == 1) {
        r.normals = 0;
        r.mass_node = R(parted_mass_[std::size_t(r.node)]);
        r.mass_partner = r.partner >= 0 ? R(parted_mass_[std::size_t(r.partner)]) : R(0);
      }
  packed_.runs ? kernel_.run_special(layout, rules.data(), 0, rules.size(), s)
               : kernel_.element_special(layout, rules.data(), 0, rules.size(), s, false, &unused);
  for (std::size_t i = 0; i < x.size(); ++i) result[i] = (rate * x[i] - result[i]) / scale;
}

template <class R>
std::vector<double> Run<R>::dot(const AlignedArray<R>& a, const AlignedArray<R>& b) const {
  const std::size_t stride = packed_.stride(), width = packed_.width();
  std::vector<double> sum(stride, 0);
  for (std::size_t n = 0; n < mass_.size(); ++n)
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t l = 0; l < stride; ++l) {
        const std::size_t i = n * width + k * stride + l;
        sum[l] += parted_mass_[n] * double(a[i]) * double(b[i]);
      }
  return sum;
}

template class Run<float>;
template class Run<double>;

}  // namespace calomel
