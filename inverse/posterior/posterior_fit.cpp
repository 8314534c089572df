#include "inverse/posterior/posterior_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "forward/emulator/infill.hpp"

namespace calomel {

namespace {

constexpr std::size_t draws_of_a_round = 400;
constexpr double infill_reach = 2;   ///< posterior sds of the draws that runs are placed at: runs about the answer are more informative than runs beside it
constexpr double hard_variance = 2;  ///< of the emulator at a point where a run may be placed, in units of one run's noise
constexpr double widths_of_sd = 3;   ///< a box reaches so many standard deviations
constexpr double clear_of_edge_shrinking = 1;  ///< of a box that shrinks, whose deviations still shrink from round to round
constexpr double room = 0.3;                   ///< half widths of the box between a nested hypothesis and its edge
constexpr double shrunk = 4;                   ///< posterior sds that a box which shrinks reaches
constexpr double worth_shrinking = 0.7;        ///< of its width: less than that is gained
constexpr double narrowest = 0.25;             ///< of its width, in one round: the first deviations are those of a coarse emulator
constexpr double much_missed = 0.02;           ///< variance of the emulator over that of the errors, beyond which a box shrinks whatever the posterior's width
constexpr double times_run_variance = 2;       ///< and beyond so many times the variance of one run, which is known from two runs
constexpr double shrunk_anyway = 0.6;          ///< of its width
constexpr int spare = 4;                       ///< runs over coefficients to begin with
constexpr double least_spare = 1.3;            ///< the same of a mesh alone, whatever is requested
constexpr int ample = 2, cheap = 48;           ///< the same at least where runs cost little and have no noise, and how many it takes then by default

class Fit {
 public:
  Fit(const PosteriorInputs& in, const FitWatch& watch) : in_(in), watch_(watch) {
    expect(!in.box.shrinks() || (in.levels == 1 && in.held.empty()), "a box that shrinks is of one mesh and holds no nested hypothesis");
    for (const auto& p : in.parameters) priors_.emplace_back(p);
    out_.runs = in.known;
    lay_box(in.centre, in.half_width);
  }
  PosteriorFit run() {
    fill_box(0);
    fit();
    for (int round = 1; round <= in_.emulator.rounds && !settled(); ++round) {
      if (watch_.go_on && !watch_.go_on(out_)) break;
      if (near_edge()) {
        move_box();
        fill_box(std::uint64_t(round));
      } else if (may_shrink()) {
        shrink_box();
        fill_box(std::uint64_t(round));
      } else {
        add_infill(round);
      }
      fit();
    }
    out_.settled = settled();
    return std::move(out_);
  }

 private:
  void lay_box(std::span<const double> centre, std::span<const double> half_width);
  void fill_box(std::uint64_t index);
  void add_infill(int round);
  void move_box();
  [[nodiscard]] bool may_shrink() const;
  [[nodiscard]] bool misses_much() const;
  void shrink_box();
  void make(const Eigen::MatrixXd& u, const std::vector<int>& level);
  void choose_runs();
  void fit();
  [[nodiscard]] bool near_edge() const;
  [[nodiscard]] bool near_edge(const LogPosterior& posterior, const LocalMode& m) const;
  [[nodiscard]] Eigen::MatrixXd draws_of(const LogPosterior& posterior, const LocalMode& m, std::uint64_t seed) const;
  [[nodiscard]] bool settled() const;
  [[nodiscard]] double half_width_of(std::size_t k) const { return 0.5 * (in_.parameters[k].coordinate(high_[k]) - in_.parameters[k].coordinate(low_[k])); }

  const PosteriorInputs& in_;
  const FitWatch& watch_;
  std::vector<Prior> priors_;
  EmulatorBox box_;
  std::vector<double> low_, high_;
  PosteriorFit out_;
};

void Fit::lay_box(std::span<const double> centre, std::span<const double> half_width) {
  low_.clear(), high_.clear();
  for (std::size_t k = 0; k < in_.parameters.size(); ++k) {
    const Parameter& p = in_.parameters[k];
    const double least = p.coordinate(p.min), most = p.coordinate(p.max), w = std::min(half_width[k], 0.5 * (most - least));
    // Within the bounds, and of its whole width where they allow it.
    const double x = std::clamp(p.coordinate(std::clamp(centre[k], p.min, p.max)), least + w, most - w);
    double low = x - w, high = x + w;
    const auto& nested = out_.nested_modes.empty() ? in_.nested_centre : out_.nested_modes[0].at.theta;
    if (!nested.empty()) {
      low = std::min(low, p.coordinate(nested[k]) - room * w);
      high = std::max(high, p.coordinate(nested[k]) + room * w);
    }
    low_.push_back(std::max(p.min, p.natural(low))), high_.push_back(std::min(p.max, p.natural(high)));
  }
  box_ = EmulatorBox(in_.parameters, low_, high_);
}

void Fit::make(const Eigen::MatrixXd& u, const std::vector<int>& level) {
  Eigen::MatrixXd thetas(u.rows(), u.cols());
  for (Eigen::Index i = 0; i < u.cols(); ++i) {
    const auto t = box_.theta(u.col(i));
    thetas.col(i) = Eigen::Map<const Eigen::VectorXd>(t.data(), u.rows());
  }
  auto records = in_.run(thetas, level);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const auto at = thetas.col(Eigen::Index(i));
    out_.runs.push_back({{at.data(), at.data() + at.size()}, level[i], std::move(records[i])});
  }
}

/// Runs within the box that came through.
void Fit::choose_runs() {
  out_.used.clear();
  for (std::size_t i = 0; i < out_.runs.size(); ++i)
    if (out_.runs[i].record.done && box_.contains(out_.runs[i].theta)) out_.used.push_back(i);
}

/// Brings every level to the number of runs that it begins with; the fine ones use points of the coarse ones.
void Fit::fill_box(std::uint64_t index) {
  choose_runs();
  std::vector<int> there(std::size_t(in_.levels), 0), known = there;
  for (const auto i : out_.used) ++(i < in_.known.size() ? known : there)[std::size_t(out_.runs[i].level)];
  const auto d = Eigen::Index(in_.parameters.size());
  const int fine = in_.finest_to_begin(d), coarse = in_.levels > 1 ? in_.emulator.coarser_to_begin(d) : 0;
  const Eigen::MatrixXd design = first_design(d, std::max(coarse, fine), in_.seed + 1000 * index);
  std::vector<int> level;
  std::vector<Eigen::Index> at;
  for (int l = 0; l < in_.levels; ++l) {
    const bool linear = l == 0 && in_.levels > 1;  // a finer level adds a linear difference
    const int wanted = l == 0 ? fine : coarse;
    const int missing = wanted - there[std::size_t(l)] - std::min(known[std::size_t(l)], in_.stood_for(wanted, linear));
    for (int i = 0; i < missing; ++i) at.push_back(i), level.push_back(l);
  }
  if (!at.empty()) make(design(Eigen::all, at), level);
}

/// Draws from the Gaussian about a mode at which the emulator is not hopeless, (n_parameters, n).
Eigen::MatrixXd Fit::draws_of(const LogPosterior& posterior, const LocalMode& m, std::uint64_t seed) const {
  const Eigen::MatrixXd all = gaussian_draws(posterior, m, draws_of_a_round, seed, infill_reach).topRows(box_.size());
  if (all.cols() == 0) return m.at.u;  // in a corner of the box, and far wider than it
  std::vector<Eigen::Index> allowed;
  for (Eigen::Index i = 0; i < all.cols(); ++i)
    if (posterior.emulator().variance(posterior.emulator().features(all.col(i), 0)) <= hard_variance) allowed.push_back(i);
  return allowed.empty() ? all : Eigen::MatrixXd(all(Eigen::all, allowed));
}

void Fit::add_infill(int round) {
  const std::uint64_t seed = in_.seed + std::uint64_t(round);
  Eigen::MatrixXd draws = draws_of(*out_.posterior, out_.modes[0], seed);
  if (out_.nested) {
    const Eigen::MatrixXd nested = draws_of(*out_.nested, out_.nested_modes[0], seed);
    draws.conservativeResize(Eigen::NoChange, draws.cols() + nested.cols());
    draws.rightCols(nested.cols()) = nested;
  }
  const auto points = infill(out_.posterior->emulator(), draws, in_.emulator.round_coarse, in_.emulator.round_fine);
  if (!points.level.empty()) make(points.u, points.level);
}

/// About the mode, wide enough for it, no narrower than before.
void Fit::move_box() {
  const LocalMode& m = out_.modes[0];
  std::vector<double> half_width;
  const Eigen::VectorXd sd = m.covariance.diagonal().cwiseSqrt();
  for (std::size_t k = 0; k < in_.parameters.size(); ++k) {
    const double now = half_width_of(k);
    half_width.push_back(std::max(in_.box.shrinks() ? now : in_.half_width[k], std::min(2 * now, widths_of_sd * sd[Eigen::Index(k)] * now)));
  }
  lay_box(m.at.theta, half_width);
  out_.rounds.back().moved_box = true;
}

/// Whether some side of the box is far wider than the posterior.
bool Fit::may_shrink() const {
  if (!in_.box.shrinks()) return false;
  const Eigen::VectorXd sd = out_.modes[0].covariance.diagonal().cwiseSqrt();
  return misses_much() || shrunk * sd.head(Eigen::Index(in_.parameters.size())).minCoeff() < worth_shrinking;
}

/// Whether what a quadratic misses over the box, which is no noise, keeps the posterior wide and so the box.
bool Fit::misses_much() const {
  return out_.noise.trace() > times_run_variance * in_.box.run_variance + much_missed * out_.likeliest().errors.covariance().trace();
}

/// About the mode.
void Fit::shrink_box() {
  const LocalMode& m = out_.modes[0];
  const Eigen::VectorXd sd = m.covariance.diagonal().cwiseSqrt();
  std::vector<double> half_width;
  for (std::size_t k = 0; k < in_.parameters.size(); ++k) {
    const double now = half_width_of(k);
    half_width.push_back(now * std::clamp(shrunk * sd[Eigen::Index(k)], narrowest, misses_much() ? shrunk_anyway : 1.0));
  }
  lay_box(m.at.theta, half_width);
  out_.rounds.back().shrank_box = true;
}

/// Whether a mode lies too near to an edge of the box that is no bound of the case: at a bound it remains.
bool Fit::near_edge(const LogPosterior& posterior, const LocalMode& m) const {
  const Eigen::VectorXd clear = (in_.box.shrinks() ? clear_of_edge_shrinking : in_.box.clear_of_edge) * m.covariance.diagonal().cwiseSqrt();
  for (std::size_t i = 0; i < posterior.free().size(); ++i) {
    const Eigen::Index k = posterior.free()[i];
    const Parameter& p = in_.parameters[std::size_t(k)];
    if (1 - m.at.u[k] < clear[Eigen::Index(i)] && high_[std::size_t(k)] < p.max - 1e-9 * std::abs(p.max)) return true;
    if (1 + m.at.u[k] < clear[Eigen::Index(i)] && low_[std::size_t(k)] > p.min + 1e-9 * std::abs(p.min)) return true;
  }
  return false;
}

bool Fit::near_edge() const { return near_edge(*out_.posterior, out_.modes[0]) || (out_.nested && near_edge(*out_.nested, out_.nested_modes[0])); }

bool Fit::settled() const {
  const auto& rounds = out_.rounds;
  return rounds.size() > 1 && !near_edge() && !may_shrink() && rounds.back().moved < in_.emulator.stable && rounds.back().variance < in_.emulator.enough;
}

void Fit::fit() {
  choose_runs();
  const auto n = Eigen::Index(out_.used.size()), d = Eigen::Index(in_.parameters.size());
  EmulatorRuns runs{.u = Eigen::MatrixXd(d, n), .level = {}, .levels = in_.levels};
  int fine = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const TrainingRun& r = out_.runs[out_.used[std::size_t(i)]];
    runs.u.col(i) = box_.u(r.theta);
    runs.level.push_back(r.level);
    fine += r.level == 0;
  }
  const Eigen::Index needed = MultilevelRegression::coefficients(d, in_.levels);
  if (n <= needed || fine <= d + 1) {
    std::string reason = "none failed";
    for (const auto& r : out_.runs)
      if (!r.record.done) reason = r.record.message;
    throw NumericsError(
        fmt::format("the emulator has {} coefficients and only {} runs succeeded in its box, {} of them on the finest mesh; {}", needed, n, fine, reason));
  }
  const Eigen::MatrixXd histories = out_.histories();
  const bool slopes =
      std::all_of(out_.used.begin(), out_.used.end(), [&](auto i) { return out_.runs[i].record.energy_slope.size() == in_.problem.shape.values(); });

  // The grid is that of the records alone; a first error model gives it, and what numbers weigh in the judgement of the levels' noise.
  const bool first = out_.modes.empty();
  ErrorDirections directions;
  const ErrorModel plain(in_.problem, in_.recordings, in_.recording_options, in_.errors, directions);
  const Eigen::MatrixXd outputs = plain.grid().apply(histories);
  const MultilevelRegression regression(runs, outputs, Eigen::VectorXd::Ones(outputs.rows()) / outputs.cwiseAbs2().mean());

  // Errors at the present result: at the box's middle first, at the last mode later.
  const Eigen::VectorXd u = first ? Eigen::VectorXd(Eigen::VectorXd::Zero(d)) : box_.u(box_.nearest(out_.modes[0].at.theta));
  if (slopes) directions.energy_slope = out_.histories(&RunRecord::energy_slope) * regression.weights(regression.features(u, 0));
  directions.mesh = in_.levels > 1 ? 0 : in_.mesh;
  directions.pulses = in_.pulses;
  directions.energy_sd = in_.energy_sd;
  if (in_.levels > 1) directions.last_difference = histories * regression.weights(regression.features(u, 1) - regression.features(u, 0));
  if (in_.gauge_places) directions.gauge_places = in_.gauge_places(box_.theta(Eigen::VectorXd::Zero(d)));  // one place for a box: its runs are made once
  out_.coefficients = regression.fit(outputs);
  out_.noise = numerical_noise(plain.grid(), regression.residuals(outputs), regression.freedom(), in_.errors.amplitude_time);
  out_.errors.emplace(ErrorModel(in_.problem, in_.recordings, in_.recording_options, in_.errors, directions).with_record_noise(out_.noise));
  out_.hypotheses =
      in_.discrepancy ? with_discrepancy(*out_.errors, in_.problem, in_.errors, in_.places.positions) : std::vector<WeightedErrors>{{*out_.errors}};
  out_.posterior.emplace(box_, regression, out_.coefficients, out_.hypotheses, out_.noise, priors_, BeyondPrior{in_.errors.beyond, in_.errors.beyond_sd});

  const Eigen::MatrixXd design = 0.8 * first_design(d, 8, in_.seed + 77);
  const auto search = [&](const LogPosterior& posterior, const std::vector<LocalMode>& known) {
    std::vector<Eigen::VectorXd> starts;
    for (Eigen::Index i = 0; i < design.cols(); ++i) starts.push_back(posterior.q(box_.theta(design.col(i)), in_.errors.beyond));
    for (const auto& m : known) starts.push_back(posterior.q(box_.nearest(m.at.theta), m.at.beyond));
    auto modes = find_modes(posterior, starts);
    if (modes.empty()) throw NumericsError("no mode of the posterior was found on the emulator");
    return modes;
  };
  const auto before = out_.modes;
  out_.modes = search(*out_.posterior, before);
  if (!in_.held.empty()) {
    out_.nested.emplace(out_.posterior->held(in_.held));
    out_.nested_modes = search(*out_.nested, out_.nested_modes);
  }
  const LocalMode& best = out_.modes[0];

  PosteriorRound round{.theta = best.at.theta, .sd = best.covariance.diagonal().cwiseSqrt()};
  for (const auto& r : out_.runs) ++(r.level == 0 ? round.fine : round.coarse), round.failed += !r.record.done;
  round.moved =
      before.empty() ? std::numeric_limits<double>::infinity() : (box_.u(before[0].at.theta) - best.at.u).cwiseQuotient(round.sd.head(d)).cwiseAbs().maxCoeff();
  const Eigen::MatrixXd draws = gaussian_draws(*out_.posterior, best, draws_of_a_round, in_.seed);
  std::vector<double> variances;
  for (Eigen::Index i = 0; i < draws.cols(); ++i) variances.push_back(regression.variance(regression.features(draws.col(i).head(d), 0)));
  std::sort(variances.begin(), variances.end());
  round.variance = variances.empty() ? std::numeric_limits<double>::infinity() : variances[std::size_t(0.95 * double(variances.size() - 1))];
  const Eigen::VectorXd theta_sd = parameter_covariance(*out_.posterior, best).diagonal().cwiseSqrt();
  round.theta_sd.assign(theta_sd.begin(), theta_sd.end());
  out_.rounds.push_back(std::move(round));
  if (watch_.round_done) watch_.round_done(out_.rounds.back());

  const Eigen::MatrixXd left_out = regression.left_out(outputs), rest = regression.residuals(outputs);
  out_.levels.assign(std::size_t(in_.levels), {});
  for (Eigen::Index i = 0; i < n; ++i) {
    auto& l = out_.levels[std::size_t(runs.level[std::size_t(i)])];
    ++l.runs;
    l.left_out += left_out.col(i).squaredNorm() / outputs.col(i).squaredNorm();
  }
  const double noise_square = rest.squaredNorm() / regression.freedom(), size = outputs.squaredNorm() / double(n);
  for (std::size_t l = 0; l < out_.levels.size(); ++l) {
    auto& level = out_.levels[l];
    level.left_out = std::sqrt(level.left_out / std::max(1, level.runs));
    level.noise = std::sqrt(noise_square * regression.noise_ratio()[l] / size);
  }
}

}  // namespace

void EmulatorOptions::validate() const {
  for (std::size_t i = 1; i < element_sizes.size(); ++i)
    if (!(element_sizes[i] < element_sizes[i - 1]))
      throw InputError({.problem = "each element size is smaller than the one before it",
                        .key = "element_sizes",
                        .value = number_text(element_sizes[i]),
                        .suggestion = "e.g. element_sizes = [1e-3, 0.5e-3]"});
}

int EmulatorOptions::finest_to_begin(Eigen::Index parameters, int levels) const {
  const auto determined = int(levels > 1 ? parameters + 1 : MultilevelRegression::coefficients(parameters, 1));
  if (fine_runs == 0) return spare * determined;
  return levels > 1 ? fine_runs : std::max(fine_runs, int(least_spare * determined));
}

int EmulatorOptions::coarser_to_begin(Eigen::Index parameters) const {
  return coarse_runs > 0 ? coarse_runs : spare * int(MultilevelRegression::coefficients(parameters, 1));
}

int PosteriorInputs::finest_to_begin(Eigen::Index d) const {
  if (!box.shrinks()) return emulator.finest_to_begin(d, levels);
  return std::max(emulator.fine_runs > 0 ? emulator.fine_runs : cheap, ample * int(MultilevelRegression::coefficients(d, 1)));
}

int PosteriorInputs::stood_for(int runs, bool linear) const {
  const auto coefficients = [&](std::size_t n) { return linear ? double(n + 1) : double(MultilevelRegression::coefficients(Eigen::Index(n), 1)); };
  return int(runs * coefficients(known_dimension) / coefficients(parameters.size()));
}

Settling PosteriorFit::settling() const {
  if (rounds.empty()) return {.settled = settled};
  const PosteriorRound& last = rounds.back();
  return {.settled = settled, .coarse = last.coarse, .fine = last.fine, .moved = last.moved, .variance = last.variance};
}

Eigen::MatrixXd PosteriorFit::histories(const std::vector<float> RunRecord::*what) const {
  Eigen::MatrixXd all(Eigen::Index((runs[used[0]].record.*what).size()), Eigen::Index(used.size()));
  for (std::size_t i = 0; i < used.size(); ++i) {
    const auto& v = runs[used[i]].record.*what;
    all.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXf>(v.data(), Eigen::Index(v.size())).cast<double>();
  }
  return all;
}

Eigen::VectorXd PosteriorFit::prediction(const LogPosterior::Point& at) const { return coefficients * posterior->emulator().features(at.u, at.beyond); }

Eigen::VectorXd PosteriorFit::history_at_mode() const { return run_at_mode.size() ? run_at_mode : history(modes[0].at.u, modes[0].at.beyond); }

LogPosterior PosteriorFit::under(const std::vector<WeightedErrors>& errors) const {
  return {posterior->box(), posterior->emulator(), coefficients, errors, noise, posterior->priors(), posterior->beyond_prior()};
}

Eigen::VectorXd PosteriorFit::history(const Eigen::VectorXd& u, double beyond) const {
  const MultilevelRegression& e = posterior->emulator();
  const Eigen::VectorXd weights = e.weights(e.features(u, beyond));
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(Eigen::Index(runs[used[0]].record.mean.size()));
  for (std::size_t i = 0; i < used.size(); ++i) sum += weights[Eigen::Index(i)] * runs[used[i]].record.history();
  return sum;
}

PosteriorFit fit_posterior(const PosteriorInputs& in, const FitWatch& watch) { return Fit(in, watch).run(); }

}  // namespace calomel
