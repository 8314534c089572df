#include "forward/solver/time_loop.hpp"

#include <fmt/format.h>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <limits>
#include <mutex>
#include <thread>

#include "base/artefact.hpp"
#include "base/errors.hpp"
#include "forward/solver/step_barrier.hpp"
#include "forward/solver/thread_shares.hpp"

namespace calomel {

namespace {

/// Denormals are flushed while waves arrive in untouched ground; restores the mode at the end.
class FlushDenormals {
#if defined(__x86_64__)
 public:
  FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040); }
  ~FlushDenormals() { _mm_setcsr(before_); }

 private:
  unsigned before_;
#endif
};

/// What the balance of energy remembers from step to step [J].
struct Balance {
  double dissipated = 0, heat = 0, boundary = 0, initial = 0, worst = 0, scale = 0, hourglass = 0, apart = 0;

  /// `first`: of the steps at which slow blocks are at work too, the second or an earlier one.
  void add(const EnergyTerms& sum, bool all_at_work, bool first, bool has_initial_state) {
    dissipated += sum.dissipated;
    heat += sum.heat;
    boundary += sum.boundary_before;
    if (all_at_work) close(sum, first && has_initial_state);
    boundary += sum.boundary_after;
    dissipated += sum.damped_after;
    apart = sum.apart;
  }

 private:
  void close(const EnergyTerms& sum, bool starts) {
    const double stored = sum.kinetic + sum.liquid + sum.hourglass + sum.steel;
    // An initial state brings its own energy; its velocity is that of t = 0, so that 1/2 v- M v+ holds from step 1 on.
    if (starts) initial = stored + dissipated + boundary - heat;
    worst = std::max(worst, std::abs(stored + dissipated + boundary - heat - initial));
    scale = std::max({scale, heat, stored});
    hourglass = std::max(hourglass, sum.hourglass);
  }
};

/// Processor time of the calling thread [s].
double thread_seconds() {
  std::timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

constexpr char magic[] = "calomel checkpoint 1\n";

template <class R>
class TimeLoop {
 public:
  TimeLoop(Run<R>& run, const RunSetup& setup, const Layout& layout, std::span<const ObservationRow> rows, const SolveOptions& options, int per_output)
      : run_(run),
        setup_(setup),
        layout_(layout),
        rows_(rows),
        options_(options),
        per_output_(per_output),
        threads_(std::max(1, std::min<int>(options.threads, int(run.block_count())))),
        sync_(threads_) {
    steps_ = std::int64_t(std::llround(setup.end / setup.output_interval)) * per_output;
    sample_every_ = options.every_step ? run.subcycles() : per_output;
    if (options.field_interval > 0) field_every_ = std::max<std::int64_t>(1, std::llround(options.field_interval / setup.output_interval)) * per_output;
    has_initial_state_ = !setup.initial_displacement.empty() || !setup.initial_velocity.empty() || !setup.initial_stress.empty();
    const std::size_t samples = std::size_t(steps_ / sample_every_) + 1;
    out_.times.resize(samples);
    out_.observations.assign(setup.energies.size() * rows.size() * samples, 0);
    const auto shares = [&](std::size_t begin, std::size_t end) { return thread_shares(layout, setup.liquid_law != nullptr, begin, end, threads_); };
    first_fast_ = shares(0, layout.first_slow_block);
    first_slow_ = shares(layout.first_slow_block, run.block_count());
    for (int t = 0; t < threads_; ++t) scratch_.emplace_back(run.scratch_size());
  }

  SolveSummary go() {
    if (!options_.checkpoint.path.empty()) resume();
    began_ = last_saved_ = std::chrono::steady_clock::now();
    {
      std::vector<std::jthread> pool;
      for (int t = 1; t < threads_; ++t) pool.emplace_back([this, t] { work(t); });
      work(0);
    }
    if (error_) std::rethrow_exception(error_);
    finish();
    return std::move(out_);
  }

 private:
  /// Runs `body`, keeping the first exception for the end; `step`: the last one that the threads still do together.
  template <class Body>
  void guarded(std::int64_t step, Body&& body) {
    try {
      body();
    } catch (...) {
      const std::lock_guard guard(lock_);
      if (!error_) error_ = std::current_exception();
      last_step_ = std::min(last_step_.load(), step);
    }
  }
  void wait() {
    if (threads_ > 1) sync_.arrive_and_wait();
  }

  void work(int t) {
    const double began = thread_seconds();
    step_to_end(t);
    const std::lock_guard guard(lock_);
    out_.processor_seconds += thread_seconds() - began;
  }

  void step_to_end(int t) {
    const FlushDenormals flush;
    const auto me = std::size_t(t), all = std::size_t(threads_);
    for (std::int64_t n = first_step_;; ++n) {
      if (n % sample_every_ == 0 || n % per_output_ == 0) {
        if (t == 0) guarded(n - 1, [&] { output(n); });
        wait();
      }
      if (last_step_ < n || n == steps_) return;
      const StepPair<R> s = run_.step(n, scratch_[me].data());
      guarded(n, [&] { advance_blocks(me, n, s); });
      wait();
      for (std::size_t c = me; c < run_.chunk_count(s.outer); c += all) run_.advance_chunk(c, s);
      wait();
      if (run_.damps_nodes()) {
        run_.damp_nodes(me, all);
        wait();
      }
      if (run_.drags_slip()) {
        if (t == 0) run_.drag_slip();
        wait();
      }
      if (options_.energy_balance && t == 0) balance_.add(run_.energies(n), s.outer, n <= run_.subcycles(), has_initial_state_);
    }
  }

  void advance_blocks(std::size_t me, std::int64_t n, const StepPair<R>& s) try {
    for (std::size_t b = first_fast_[me]; b < first_fast_[me + 1]; ++b) run_.advance_block(b, s);
    for (std::size_t b = first_slow_[me]; s.outer && b < first_slow_[me + 1]; ++b) run_.advance_block(b, s);
  } catch (const NumericsError& e) {
    throw NumericsError(fmt::format("{}, at step {} ({:.4g} s)", e.what(), n, double(n) * setup_.output_interval / per_output_));
  }

  void output(std::int64_t n) {
    if (n % sample_every_ == 0) observe(n);
    if (n % (std::int64_t(per_output_) * 16) == 0 || n == steps_) run_.check_finite(n);
    if (field_every_ > 0 && options_.on_field && (n % field_every_ == 0 || n == steps_) && n >= field_due_) {
      options_.on_field(run_.snapshot(n, options_.motion_alone));
      ++fields_;
    }
    if (n % per_output_ != 0) return;
    if (options_.on_progress) options_.on_progress(double(n) / double(std::max<std::int64_t>(1, steps_)));
    const bool stop = options_.stop && *options_.stop;
    if (!options_.checkpoint.path.empty() && n > first_step_ && n < steps_) {
      const auto now = std::chrono::steady_clock::now();
      if (stop || std::chrono::duration<double>(now - last_saved_).count() >= options_.checkpoint.every_seconds) {
        save(n);
        last_saved_ = now;
      }
    }
    if (stop) throw Interrupted();
  }

  void observe(std::int64_t n) {
    const std::size_t sample = std::size_t(n / sample_every_), samples = out_.times.size();
    const std::int64_t output = n / per_output_;  // exact unless every step is reported
    out_.times[sample] = options_.every_step ? double(n) * setup_.output_interval / per_output_ : double(output) * setup_.output_interval;
    for (std::size_t r = 0; r < rows_.size(); ++r)
      for (std::size_t l = 0; l < setup_.energies.size(); ++l) out_.observations[(l * rows_.size() + r) * samples + sample] = run_.observe(rows_[r], l);
  }

  [[nodiscard]] std::string identity() const {
    return fmt::format("{}|{}|{}|{}|{}|{}", options_.checkpoint.identity, sizeof(R), run_.row_count(), steps_, run_.subcycles(), out_.observations.size());
  }

  void save(std::int64_t n) {
    if (options_.checkpoint.before_saving) options_.checkpoint.before_saving(fields_);
    const auto part = options_.checkpoint.path.string() + ".part";
    {
      std::ofstream out(part, std::ios::binary);
      const std::string id = identity();
      const std::array<std::int64_t, 3> numbers{n, fields_, std::int64_t(id.size())};
      out.write(magic, sizeof(magic));
      out.write(reinterpret_cast<const char*>(numbers.data()), sizeof(numbers));
      out.write(id.data(), std::streamsize(id.size()));
      out.write(reinterpret_cast<const char*>(&balance_), sizeof(balance_));
      out.write(reinterpret_cast<const char*>(out_.times.data()), std::streamsize(out_.times.size() * sizeof(double)));
      out.write(reinterpret_cast<const char*>(out_.observations.data()), std::streamsize(out_.observations.size() * sizeof(double)));
      run_.save(out);
      if (!out.flush()) throw InputError({.problem = "the checkpoint cannot be written", .suggestion = "check the free space and the rights", .file = part});
    }
    rename_durably(part, options_.checkpoint.path);
  }

  void resume() {
    std::ifstream in(options_.checkpoint.path, std::ios::binary);
    if (!in) return;
    const auto fail = [&](const std::string& problem) {
      throw InputError(
          {.problem = problem, .suggestion = "delete it, or set it aside with --fresh, to start the run again", .file = options_.checkpoint.path.string()});
    };
    char head[sizeof(magic)] = {};
    std::array<std::int64_t, 3> numbers{};
    in.read(head, sizeof(head));
    in.read(reinterpret_cast<char*>(numbers.data()), sizeof(numbers));
    if (!in || !std::equal(head, head + sizeof(head), magic) || numbers[2] < 0 || numbers[2] > 100000) fail("not a checkpoint of this program");
    std::string id(std::size_t(numbers[2]), ' ');
    in.read(id.data(), numbers[2]);
    if (id != identity()) fail("the checkpoint is of another run: the case, the mesh or the program changed since");
    in.read(reinterpret_cast<char*>(&balance_), sizeof(balance_));
    in.read(reinterpret_cast<char*>(out_.times.data()), std::streamsize(out_.times.size() * sizeof(double)));
    in.read(reinterpret_cast<char*>(out_.observations.data()), std::streamsize(out_.observations.size() * sizeof(double)));
    run_.restore(in);
    if (!in) fail("the checkpoint ends early");
    first_step_ = field_due_ = numbers[0];
    fields_ = numbers[1];
    // A snapshot of that very step was handed out before the checkpoint was written.
    if (field_every_ > 0 && (first_step_ % field_every_ == 0 || first_step_ == steps_)) ++field_due_;
    if (options_.checkpoint.on_resume) options_.checkpoint.on_resume(first_step_, fields_, first_step_ == steps_);
  }

  void finish() {
    out_.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
    out_.steps = steps_;
    out_.resumed_from = first_step_;
    out_.time_step = setup_.output_interval / per_output_;
    out_.subcycles = run_.subcycles();
    std::size_t elements = 0;
    for (const auto& b : layout_.blocks) elements += b.elements.size();
    out_.element_steps_per_second = double(elements) * double(setup_.energies.size()) * double(steps_ - first_step_) / out_.wall_seconds;
    const Balance& b = balance_;
    out_.energy_balance_error = options_.energy_balance ? (b.scale > 0 ? b.worst / b.scale : 0) : std::nan("");
    out_.hourglass_share = b.scale > 0 ? b.hourglass / b.scale : 0;
    const bool end_load = !setup_.end_stress.time.empty();  // a bar has no rear face: what goes out there is the load's work
    out_.energy_in = b.heat + b.initial - (end_load ? b.boundary : 0);
    out_.dissipated = b.dissipated - b.apart;
    out_.radiated = end_load ? 0 : b.boundary;
    if (options_.checkpoint.path.empty()) return;
    if (options_.checkpoint.keep) {
      if (first_step_ < steps_) save(steps_);
    } else {
      std::error_code ignored;
      std::filesystem::remove(options_.checkpoint.path, ignored);
    }
  }

  Run<R>& run_;
  const RunSetup& setup_;
  const Layout& layout_;
  std::span<const ObservationRow> rows_;
  const SolveOptions& options_;
  int per_output_, threads_;
  std::int64_t steps_ = 0, sample_every_ = 1, field_every_ = 0, first_step_ = 0, field_due_ = 0, fields_ = 0;
  bool has_initial_state_ = false;
  std::vector<std::size_t> first_fast_, first_slow_;  ///< blocks of each thread
  std::vector<AlignedArray<R>> scratch_;
  Balance balance_;
  SolveSummary out_;
  StepBarrier sync_;
  std::mutex lock_;
  std::exception_ptr error_;
  std::atomic<std::int64_t> last_step_{std::numeric_limits<std::int64_t>::max()};  ///< after an error
  std::chrono::steady_clock::time_point began_, last_saved_;
};

}  // namespace

template <class R>
SolveSummary run_to_end(Run<R>& run, const RunSetup& setup, const Layout& layout, std::span<const ObservationRow> rows, const SolveOptions& options,
                        int steps_per_output) {
  return TimeLoop<R>(run, setup, layout, rows, options, steps_per_output).go();
}

template SolveSummary run_to_end<float>(Run<float>&, const RunSetup&, const Layout&, std::span<const ObservationRow>, const SolveOptions&, int);
template SolveSummary run_to_end<double>(Run<double>&, const RunSetup&, const Layout&, std::span<const ObservationRow>, const SolveOptions&, int);

}  // namespace calomel
