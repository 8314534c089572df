#include "uq/sampler/sampler.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/linear_algebra.hpp"
#include "base/parallel.hpp"

namespace calomel {

namespace {

using Clock = std::chrono::steady_clock;

/// What a chain has done so far.
struct ChainRecord {
  std::size_t transitions = 0, evaluations = 0;
  std::vector<double> coordinates;  ///< (draw, d)
  std::vector<double> log_density;  ///< (draw)
  std::vector<double> acceptance;   ///< (draw)
  double pending = 0;               ///< acceptance summed over the transitions since the last kept draw
  std::string state;                ///< of its stream and its chain, after `transitions`; empty before the start
};

/// A frame of the journal: the chain, what it did since its last frame, and where it stands.
std::string frame_of(std::size_t chain, const ChainRecord& record, std::size_t first_draw, std::size_t d) {
  ByteWriter out;
  out.value(std::uint64_t(chain)), out.value(std::uint64_t(record.transitions)), out.value(std::uint64_t(record.evaluations)),
      out.value(std::uint64_t(first_draw));
  out.values(std::span(record.coordinates).subspan(first_draw * d));
  out.values(std::span(record.log_density).subspan(first_draw));
  out.values(std::span(record.acceptance).subspan(first_draw));
  out.value(record.pending);
  out.text(record.state);
  return out.bytes;
}

void take_frame(std::string_view payload, std::vector<ChainRecord>& records) {
  ByteReader in(payload);
  const auto chain = in.value<std::uint64_t>();
  expect(chain < records.size(), "a journal holds no more chains than are run");
  ChainRecord& r = records[chain];
  r.transitions = in.value<std::uint64_t>(), r.evaluations = in.value<std::uint64_t>();
  expect(in.value<std::uint64_t>() == r.log_density.size(), "the frames of a chain follow one another");
  for (auto* list : {&r.coordinates, &r.log_density, &r.acceptance}) {
    const auto more = in.values<double>();
    list->insert(list->end(), more.begin(), more.end());
  }
  r.pending = in.value<double>();
  r.state = in.text();
}

/// A point where the density is positive, its log density with it.
struct Beginning {
  Eigen::VectorXd x;
  double log_density = 0;
};
Beginning beginning(const LogDensity& density, const SamplerStart& start, double dispersion, std::size_t chain, RandomStream& random) {
  const auto d = Eigen::Index(density.dimension());
  const auto value_at = [&](const Eigen::VectorXd& x) {
    const double v = density.log_density({x.data(), std::size_t(d)});
    if (std::isnan(v)) throw NumericsError(fmt::format("the log density is NaN at the start of chain {}", chain + 1));
    return v;
  };
  if (start.points.size() > 0) {
    Beginning b{start.points.col(Eigen::Index(chain)), 0};
    b.log_density = value_at(b.x);
    if (!std::isfinite(b.log_density)) throw NumericsError(fmt::format("the density is zero at the start that was given for chain {}", chain + 1));
    return b;
  }
  Eigen::MatrixXd factor = Eigen::MatrixXd::Identity(d, d);
  if (start.covariance.size() > 0) factor = Cholesky(start.covariance).lower();
  double width = dispersion;
  for (int attempt = 0; attempt < 200; ++attempt, width *= 0.95) {
    Eigen::VectorXd z(d);
    for (double& v : z) v = random.normal();
    Beginning b{start.mean + width * (factor * z), 0};
    b.log_density = value_at(b.x);
    if (std::isfinite(b.log_density)) return b;
  }
  throw NumericsError(fmt::format("no start of chain {} has a positive density: 200 points about the given mean were tried, ever nearer to it", chain + 1));
}

}  // namespace

SamplerResult run_sampler(const LogDensity& density, const SamplerStart& start, const SamplerOptions& options, const SamplerRun& run) {
  const auto began = Clock::now();
  const std::size_t d = density.dimension(), chains = std::size_t(options.chains), kept = std::size_t(options.draws), thin = std::size_t(options.thin),
                    warmup = std::size_t(options.warmup), transitions = warmup + kept * thin;
  const Eigen::Index n = Eigen::Index(d);
  expect(d > 0 && chains > 0 && thin > 0, "a sampler has coordinates, chains and draws");
  expect(start.points.size() > 0 ? start.points.rows() == n && start.points.cols() == Eigen::Index(chains) : start.mean.size() == n,
         "a start has the dimension of the density");
  const auto& entry = samplers().get(options.kind, "sampler.kind");
  const Eigen::MatrixXd covariance = start.covariance.size() > 0 ? start.covariance : Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n));

  std::vector<ChainRecord> records(chains);
  std::optional<FrameFile> journal;
  if (!run.journal.empty()) journal.emplace(run.journal, "calomel chains 1", run.provenance, [&](std::string_view payload, FrameFile::Place) { take_frame(payload, records); });
  SamplerResult result;
  for (const auto& r : records) result.summary.resumed += r.transitions;

  std::atomic<std::size_t> done{result.summary.resumed};
  std::mutex telling;
  auto told = Clock::now();
  const auto tell = [&](bool now) {
    if (!run.progress) return;
    const std::lock_guard guard(telling);
    if (!now && Clock::now() - told < std::chrono::milliseconds(100)) return;
    told = Clock::now();
    run.progress(done, chains * transitions);
  };
  tell(true);

  parallel_for(chains, run.threads, [&](std::size_t c) {
    ChainRecord& r = records[c];
    if (r.transitions == transitions) return;
    RandomStream random(run.seed, c);
    const auto chain = entry(density, options, covariance);
    if (r.state.empty()) {
      const Beginning b = beginning(density, start, options.dispersion, c, random);
      chain->begin({b.x.data(), d}, b.log_density);
      ++r.evaluations;
    } else {
      ByteReader in(r.state);
      in.into(random);
      chain->restore(in);
    }
    std::size_t saved = r.log_density.size();
    auto saved_at = Clock::now();
    const auto save = [&] {
      if (!journal) return;
      ByteWriter state;
      state.value(random);
      chain->save(state);
      r.state = std::move(state.bytes);
      journal->append(frame_of(c, r, saved, d));
      saved = r.log_density.size(), saved_at = Clock::now();
    };
    for (; r.transitions < transitions;) {
      if (run.stop && run.stop->load()) {
        save();
        throw Interrupted();
      }
      if (r.transitions == warmup) chain->freeze();
      const auto step = chain->step(random, r.transitions < warmup);
      ++r.transitions, r.evaluations += std::size_t(step.evaluations);
      done.fetch_add(1, std::memory_order_relaxed);
      if (r.transitions > warmup) {
        r.pending += step.acceptance;
        if ((r.transitions - warmup) % thin == 0) {
          const auto x = chain->position();
          r.coordinates.insert(r.coordinates.end(), x.begin(), x.end());
          r.log_density.push_back(chain->log_density());
          r.acceptance.push_back(r.pending / double(thin));
          r.pending = 0;
        }
      }
      if (r.transitions % 32 == 0 || step.evaluations == 0) tell(false);
      if (journal && Clock::now() - saved_at > std::chrono::duration<double>(run.save_every)) save();
    }
    save();
  });
  tell(true);

  result.coordinates = {.names = density.coordinates(), .chains = chains, .draws = kept};
  result.quantities = {.chains = chains, .draws = kept};
  for (const auto& q : density.quantities()) result.quantities.names.push_back(q.name);
  const std::size_t reported = result.quantities.names.size();
  result.quantities.values.resize(chains * kept * reported);
  auto& s = result.summary;
  std::vector<std::size_t> still;
  for (std::size_t c = 0; c < chains; ++c) {
    const ChainRecord& r = records[c];
    for (std::size_t i = 0; i < kept; ++i)
      density.constrain(std::span(r.coordinates).subspan(i * d, d), std::span(result.quantities.values).subspan((c * kept + i) * reported, reported));
    result.coordinates.values.insert(result.coordinates.values.end(), r.coordinates.begin(), r.coordinates.end());
    result.log_density.insert(result.log_density.end(), r.log_density.begin(), r.log_density.end());
    result.acceptance.insert(result.acceptance.end(), r.acceptance.begin(), r.acceptance.end());
    s.acceptance.push_back(std::accumulate(r.acceptance.begin(), r.acceptance.end(), 0.0) / double(kept));
    s.evaluations += r.evaluations, s.transitions += r.transitions;
    const auto same = [&](double v) { return v == r.coordinates[0]; };
    bool moved = kept == 1;
    for (std::size_t i = 0; i < kept && !moved; ++i) moved = !same(r.coordinates[i * d]);
    if (!moved) still.push_back(c);
  }
  s.wall_s = std::chrono::duration<double>(Clock::now() - began).count();
  s.status = still.empty() ? ExitStatus::done : ExitStatus::not_to_be_trusted;
  s.message = still.empty() ? fmt::format("{} chains of {} draws", chains, kept)
                            : fmt::format("chain {} has not moved since the warm-up: every proposal was refused", still[0] + 1);
  return result;
}

void remove_journal(const std::filesystem::path& journal) {
  std::error_code error;
  std::filesystem::remove(journal, error);
  if (error) throw InputError({.problem = "cannot be removed: " + error.message(), .file = journal.string()});
}

}  // namespace calomel
