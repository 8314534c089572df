#include "uq/sampler/sampler.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <mutex>
#include <numeric>
#include <optional>

#include "base/log_sum.hpp"
#include "base/not_finite.hpp"
#include "base/parallel.hpp"
#include "uq/convergence/diagnostics.hpp"
#include "uq/sampler/jumps.hpp"
#include "uq/sampler/start.hpp"

namespace calomel {

namespace {

using Clock = std::chrono::steady_clock;

/// The record of a chain.
struct ChainRecord {
  std::size_t transitions = 0;
  std::size_t evaluations = 0;
  std::size_t cheap_evaluations = 0;
  std::vector<double> coordinates;  ///< (draw, walker, d)
  std::vector<double> log_density;  ///< (draw, walker)
  std::vector<double> acceptance;   ///< (draw)
  std::vector<double> energy;       ///< (draw), empty without trajectories; so are the next two
  std::vector<double> diverging;
  std::vector<double> depth;
  double pending = 0;              ///< acceptance summed over the transitions since the last kept draw
  double pending_divergences = 0;  ///< divergent transitions since the last kept draw
  EnergyChanges energies;          ///< of the kept transitions
  std::uint64_t divergences = 0;   ///< kept transitions that diverged
  std::uint64_t cut = 0;           ///< kept transitions that the greatest number of doublings ended
  double log_evidence = nan;       ///< the chain's estimate at its end, if the sampler makes one
  std::string state;               ///< the stream and the chain after `transitions`; empty before the start

  [[nodiscard]] std::array<std::vector<double>*, 6> lists() { return {&coordinates, &log_density, &acceptance, &energy, &diverging, &depth}; }
};

/// A frame of the journal: the chain's number, what it did since its last frame, and its state. saved: lengths of the lists at the last frame.
std::string frame_of(std::size_t chain, ChainRecord& record, const std::array<std::size_t, 6>& saved) {
  ByteWriter out;
  out.value(std::uint64_t(chain));
  out.value(std::uint64_t(record.transitions));
  out.value(std::uint64_t(record.evaluations));
  out.value(std::uint64_t(record.cheap_evaluations));
  const auto lists = record.lists();
  for (std::size_t k = 0; k < lists.size(); ++k) {
    out.value(std::uint64_t(saved[k]));
    out.values(std::span<const double>(*lists[k]).subspan(saved[k]));
  }
  out.value(record.pending);
  out.value(record.pending_divergences);
  out.value(record.energies);
  out.value(record.divergences);
  out.value(record.cut);
  out.value(record.log_evidence);
  out.text(record.state);
  return out.bytes;
}

void take_frame(std::string_view payload, std::vector<ChainRecord>& records) {
  ByteReader in(payload);
  const auto chain = in.value<std::uint64_t>();
  expect(chain < records.size(), "a journal holds no more chains than are run");
  ChainRecord& r = records[chain];
  r.transitions = in.value<std::uint64_t>();
  r.evaluations = in.value<std::uint64_t>();
  r.cheap_evaluations = in.value<std::uint64_t>();
  for (auto* list : r.lists()) {
    expect(in.value<std::uint64_t>() == list->size(), "the frames of a chain follow one another");
    const auto more = in.values<double>();
    list->insert(list->end(), more.begin(), more.end());
  }
  in.into(r.pending);
  in.into(r.pending_divergences);
  in.into(r.energies);
  in.into(r.divergences);
  in.into(r.cut);
  in.into(r.log_evidence);
  r.state = in.text();
}

/// Counts a kept transition; with `draw`, stores the draw that it completes.
void keep(ChainRecord& r, const MarkovChain::Transition& step, const MarkovChain& chain, bool draw, std::size_t thin) {
  r.pending += step.acceptance;
  if (step.trajectory) {
    r.energies.add(step.trajectory->energy);
    r.divergences += step.trajectory->divergent;
    r.cut += step.trajectory->cut;
    r.pending_divergences += step.trajectory->divergent;
  }
  if (!draw) return;
  for (std::size_t w = 0; w < chain.walkers(); ++w) {
    const auto x = chain.position(w);
    r.coordinates.insert(r.coordinates.end(), x.begin(), x.end());
    r.log_density.push_back(chain.log_density(w));
  }
  r.acceptance.push_back(r.pending / double(thin));
  if (step.trajectory) {
    r.energy.push_back(step.trajectory->energy);
    r.diverging.push_back(r.pending_divergences);
    r.depth.push_back(step.trajectory->depth);
  }
  r.pending = 0;
  r.pending_divergences = 0;
}

/// Sets the log evidence, ln of the mean of exp(estimates), and its standard error by the delta method: that of the mean of Z over that mean.
void set_evidence(std::span<const double> estimates, SamplerSummary& summary) {
  const double n = double(estimates.size());
  const double value = log_mean(estimates);
  summary.log_evidence = value;
  if (estimates.size() < 2) return;
  double squares = 0;
  for (const double e : estimates) squares += std::pow(std::exp(e - value) - 1, 2);
  summary.log_evidence_error = std::sqrt(squares / (n - 1) / n);
}

/// The names of the samplers that `wanted` selects, as `"a", "b" or "c"`.
template <class Wanted>
std::string quoted_kinds(const Registry<SamplerEntry>& catalogue, Wanted&& wanted) {
  std::vector<std::string> names;
  for (const auto& row : catalogue.rows())
    if (wanted(row.entry)) names.push_back('"' + row.name + '"');
  std::string s;
  for (std::size_t i = 0; i < names.size(); ++i) s += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
  return s;
}

/// Errors: InputError when the sampler needs a second density or a gradient that is not there.
void expect_density_fits(const LogDensity& density, bool two_densities, const SamplerOptions& options) {
  const SamplerEntry& entry = options.entry();
  if (!entry.first_stage.empty() && !two_densities)
    throw InputError({.problem = "needs a cheap density beside the one that is sampled, an emulator of the model, and there is none here",
                      .key = "sampler.kind",
                      .value = '"' + options.kind + '"',
                      .suggestion = fmt::format("take \"{}\"", entry.first_stage)});
  if (entry.needs_gradient && !density.has_gradient()) {
    const auto others = quoted_kinds(*options.catalogue, [](const SamplerEntry& e) { return !e.needs_gradient && e.first_stage.empty(); });
    throw InputError({.problem = "needs the gradient of the density, and this density has none",
                      .key = "sampler.kind",
                      .value = '"' + options.kind + '"',
                      .suggestion = fmt::format("take {}, which need none", others)});
  }
}

/// Runs the chains. exact: null for a sampler of one density.
SamplerResult run_chains(const LogDensity& density, const LogDensity* exact, const SamplerStart& start, const SamplerOptions& options, const SamplerRun& run) {
  const auto began = Clock::now();
  const LogDensity& sampled = exact ? *exact : density;
  const std::size_t d = density.dimension();
  const auto chains = std::size_t(options.chains);
  const auto kept = std::size_t(options.draws);
  const auto thin = std::size_t(options.thin);
  const auto warmup = std::size_t(options.warmup);
  const std::size_t transitions = warmup + kept * thin;
  const Eigen::Index n = Eigen::Index(d);
  expect(d > 0 && chains > 0 && thin > 0, "a sampler has coordinates, chains and draws");
  expect(sampled.dimension() == d, "both densities have the same coordinates");
  expect(start.points.size() > 0 ? start.points.rows() == n && start.points.cols() == Eigen::Index(chains) : start.mean.size() == n,
         "a start has the dimension of the density");
  expect_density_fits(density, exact != nullptr, options);
  const SamplerEntry& entry = options.entry();
  const Eigen::MatrixXd covariance = start.covariance.size() > 0 ? start.covariance : Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n));
  const auto mode_of = [&](std::size_t c) -> StartMode {
    if (start.points.size() > 0) return {.mean = start.points.col(Eigen::Index(c)), .covariance = covariance};
    return start.modes.size() > 1 ? start.modes[c % start.modes.size()] : StartMode{.mean = start.mean, .covariance = covariance};
  };
  const auto chain_about = [&](const StartMode& mode) {
    return entry.chain(
        {.density = density, .exact = exact, .options = options, .mode = mode, .modes = start.modes.size() > 1 ? start.modes : std::vector{mode}});
  };
  const StartMode first_mode = mode_of(0);
  const auto first_chain = chain_about(first_mode);
  const std::size_t walkers = first_chain->walkers();
  std::optional<ModeJumps> jumps;
  if (start.modes.size() > 1 && first_chain->jumps()) jumps.emplace(start.modes);

  std::vector<ChainRecord> records(chains);
  std::optional<FrameFile> journal;
  if (!run.journal.empty())
    journal.emplace(run.journal, "calomel chains 4", run.provenance, [&](std::string_view payload, FrameFile::Place) { take_frame(payload, records); });
  SamplerResult result;
  for (const auto& r : records) result.summary.resumed += r.transitions;

  std::atomic<std::size_t> done{result.summary.resumed};
  std::mutex reporting;
  auto reported_at = Clock::now();
  const auto report = [&](bool now) {
    if (!run.progress) return;
    const std::lock_guard guard(reporting);
    if (!now && Clock::now() - reported_at < std::chrono::milliseconds(100)) return;
    reported_at = Clock::now();
    run.progress(done, chains * transitions);
  };
  report(true);

  std::atomic<bool> failed{false};  // one chain failed: the others save their state and end, so that the failure is reported at once
  const auto walk = [&](std::size_t c) {
    ChainRecord& r = records[c];
    if (r.transitions == transitions) return;
    RandomStream random(run.seed, c);
    const StartMode mode = mode_of(c);
    const auto chain = chain_about(mode);
    if (r.state.empty()) {
      Beginning b{mode.mean, 0};
      if (start.points.size() > 0) {
        b.log_density = checked_log_density(density, b.x);
        if (!std::isfinite(b.log_density)) throw NumericsError(fmt::format("the density is zero at the start that was given for chain {}", c + 1));
      } else {
        b = drawn_beginning([&](const Eigen::VectorXd& x) { return checked_log_density(density, x); }, mode.mean, covariance_factor(mode.covariance, d),
                            options.dispersion, random, fmt::format("chain {}", c + 1));
      }
      chain->begin({b.x.data(), d}, b.log_density);
      if (jumps && walkers == 1) chain->jump(0, {b.x.data(), d}, b.log_density, mode.mean);
      ++(exact ? r.cheap_evaluations : r.evaluations);
    } else {
      ByteReader in(r.state);
      in.into(random);
      chain->restore(in);
    }
    std::array<std::size_t, 6> saved{};
    const auto note_saved = [&] { std::ranges::transform(r.lists(), saved.begin(), [](const auto* list) { return list->size(); }); };
    note_saved();
    auto saved_at = Clock::now();
    auto looked_at = saved_at;
    const auto save = [&] {
      if (!journal) return;
      ByteWriter state;
      state.value(random);
      chain->save(state);
      r.state = std::move(state.bytes);
      journal->append(frame_of(c, r, saved));
      note_saved();
      saved_at = Clock::now();
    };
    for (; r.transitions < transitions;) {
      const bool stopped = run.stop && run.stop->load();
      if (stopped || failed) {
        save();
        if (stopped) throw Interrupted();
        return;
      }
      if (r.transitions == warmup) chain->freeze();
      const auto step = chain->step(random, r.transitions < warmup);
      if (jumps) r.evaluations += std::size_t(jumps->move(*chain, density, random));
      ++r.transitions;
      r.evaluations += std::size_t(step.evaluations);
      r.cheap_evaluations += std::size_t(step.cheap_evaluations);
      done.fetch_add(1, std::memory_order_relaxed);
      if (r.transitions > warmup) keep(r, step, *chain, (r.transitions - warmup) % thin == 0, thin);
      if (r.transitions == transitions) r.log_evidence = chain->log_evidence().value_or(nan);
      const auto now = Clock::now();
      if (now - looked_at > std::chrono::milliseconds(100)) {
        looked_at = now;
        report(false);
      }
      if (journal && now - saved_at > std::chrono::duration<double>(run.save_every)) save();
    }
    save();
  };
  parallel_for(chains, run.threads, [&](std::size_t c) {
    try {
      walk(c);
    } catch (...) {
      failed = true;
      throw;
    }
  });
  report(true);

  const std::size_t all_chains = chains * walkers;
  result.coordinates = {.names = sampled.coordinates(), .chains = all_chains, .draws = kept, .walkers = walkers};
  result.quantities = {.chains = all_chains, .draws = kept, .walkers = walkers};
  result.quantities.names = sampled.quantities();
  const std::size_t quantities = result.quantities.names.size();
  result.quantities.values.resize(all_chains * kept * quantities);
  auto& s = result.summary;
  s.kind = options.kind;
  s.remedies = entry.remedies;
  std::vector<double> evidences;
  for (std::size_t c = 0; c < chains; ++c) {
    const ChainRecord& r = records[c];
    for (std::size_t w = 0; w < walkers; ++w) {
      const auto place = [&](std::size_t i) { return std::span(r.coordinates).subspan((i * walkers + w) * d, d); };
      for (std::size_t i = 0; i < kept; ++i) {
        const auto x = place(i);
        sampled.constrain(x, std::span(result.quantities.values).subspan(((c * walkers + w) * kept + i) * quantities, quantities));
        result.coordinates.values.insert(result.coordinates.values.end(), x.begin(), x.end());
        result.log_density.push_back(r.log_density[i * walkers + w]);
      }
      for (const auto& [from, to] :
           {std::pair{&r.acceptance, &result.acceptance}, {&r.energy, &result.energy}, {&r.diverging, &result.diverging}, {&r.depth, &result.depth}})
        to->insert(to->end(), from->begin(), from->end());
    }
    s.acceptance.push_back(std::accumulate(r.acceptance.begin(), r.acceptance.end(), 0.0) / double(kept));
    s.evaluations += r.evaluations;
    s.cheap_evaluations += r.cheap_evaluations;
    s.transitions += r.transitions;
    if (!r.energy.empty()) {
      s.e_bfmi.push_back(r.energies.e_bfmi());
      s.divergences += r.divergences;
      s.cut += r.cut;
    }
    if (!std::isnan(r.log_evidence)) evidences.push_back(r.log_evidence);
  }
  if (evidences.size() == chains) set_evidence(evidences, s);
  s.wall_s = std::chrono::duration<double>(Clock::now() - began).count();
  return result;
}

}  // namespace

SamplerResult run_sampler(const LogDensity& density, const SamplerStart& start, const SamplerOptions& options, const SamplerRun& run) {
  return run_chains(density, nullptr, start, options, run);
}

SamplerResult run_sampler(const LogDensity& cheap, const LogDensity& exact, const SamplerStart& start, const SamplerOptions& options, const SamplerRun& run) {
  if (options.entry().first_stage.empty()) {
    const auto others = quoted_kinds(*options.catalogue, [](const SamplerEntry& e) { return !e.first_stage.empty(); });
    throw InputError(
        {.problem = "samples one density, and two were given", .key = "sampler.kind", .value = '"' + options.kind + '"', .suggestion = "take " + others});
  }
  return run_chains(cheap, &exact, start, options, run);
}

SamplingFacts sampling_facts(const SamplerResult& result, int thin) {
  const auto& s = result.summary;
  const std::size_t kept = result.coordinates.chains / std::max<std::size_t>(1, result.coordinates.walkers) * result.coordinates.draws * std::size_t(thin);
  return {.acceptance = std::accumulate(s.acceptance.begin(), s.acceptance.end(), 0.0) / double(s.acceptance.size()),
          .thin = thin,
          .e_bfmi = s.e_bfmi,
          .divergences = s.divergences,
          .cut = s.cut,
          .transitions = kept,
          .remedies = s.remedies};
}

void remove_journal(const std::filesystem::path& journal) {
  std::error_code error;
  std::filesystem::remove(journal, error);
  if (error) throw InputError({.problem = "cannot be removed: " + error.message(), .file = journal.string()});
}

}  // namespace calomel
