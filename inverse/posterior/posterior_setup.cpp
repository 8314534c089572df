#include "inverse/posterior/posterior_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "inverse/data/decimation.hpp"
#include "inverse/posterior/basin.hpp"
#include "inverse/posterior/multistart_least_squares.hpp"
#include "inverse/posterior/emulator_meshes.hpp"
#include "inverse/posterior/prior.hpp"

namespace calomel {

namespace {

constexpr double first_box_of_prior = 2;       ///< half width of a first box that the priors decide, in prior standard deviations
constexpr double least_surrogate_error = 0.1;  ///< over the local amplitude, in the search of the basin
constexpr double most_jitter = 1;              ///< between two runs of nearly one point, in standard errors of all records together; with more, finite
                                               ///< differences of the model contain no information

/// The prior of an uncertain number, by the options that have its name.
struct NuisancePrior {
  double median = 0, sd = 0;
};
NuisancePrior prior_of(const UncertainNumber& number, const PosteriorSettings& s) {
  if (number.name == "regularising_viscosity") return {s.emulator.viscosity, s.emulator.viscosity_sd};
  if (number.name == "young") return {number.value, s.errors.young_sd};
  if (number.name == "wall_film") return {s.errors.wall_film, s.errors.wall_film_sd};
  return {};
}

void remove_gauge_errors(ErrorOptions& e) {
  e.energy_scale_sd = 0;
  e.gain_sd = 0;
  e.baseline = 0;
  e.coherent_noise = 0;
}

/// The noise of the records alone, on the model's own times; and, of the physical product, a discrepancy on the scale of the records.
ErrorOptions errors_on_own_times(std::size_t times, double step) {
  constexpr double slack = 1.01;                                                                              // of rounding in the times
  constexpr double short_share = 1.0 / 40, long_share = 1.0 / 10, local_share = 1.0 / 16, least_steps = 1.5;  // of the record's length; of its steps
  ErrorOptions e;
  const double length = double(std::max<std::size_t>(times - 1, 1)) * step;
  e.band = slack * 0.5 / step;
  remove_gauge_errors(e);
  for (double* none : {&e.young_sd, &e.wall_film_sd, &e.gauge_place_sd, &e.beyond, &e.beyond_sd, &e.beyond_rest, &e.record_noise}) *none = 0;
  e.mesh = 0;
  e.arrival_share = 0;
  e.discrepancy_times = {std::max(short_share * length, least_steps * step), std::max(long_share * length, least_steps * step)};
  e.amplitude_time = std::max(local_share * length, least_steps * step);
  return e;
}

/// Times of the errors are no shorter than the distance of the values compared. Errors: InputError for times that are too short.
void hold_times_to_the_records(PosteriorInputs& in, const PosteriorCase& c, bool own_times) {
  const Decimation grid(in.problem, std::size_t(in.errors.values), in.errors.band);
  const auto windows = grid.windows(0);
  const double apart =
      windows.size() > 1 ? windows[1].time - windows[0].time : in.problem.time.back() - in.problem.time.front();  // one value represents the record
  if (own_times && !c.settings.discrepancy_times_given)
    for (auto& time : in.errors.discrepancy_times) time = std::max(time, apart);
  if (own_times && !c.settings.amplitude_time_given) in.errors.amplitude_time = std::max(in.errors.amplitude_time, apart);
  const auto expect_above = [&](const char* key, double time) {
    if (time >= apart) return;
    throw InputError({.problem = fmt::format("values of a record are compared {} s apart, and this is shorter", number_text(apart)),
                      .key = key,
                      .value = number_text(time),
                      .suggestion = "give times of the records' own scale, or a higher errors.band"});
  };
  expect_above("errors.discrepancy_times", *std::max_element(in.errors.discrepancy_times.begin(), in.errors.discrepancy_times.end()));
  expect_above("errors.amplitude_time", in.errors.amplitude_time);
}

/// Half width of the first box in a parameter by its prior, in the coordinate of the parameter.
double half_width_by_prior(const Parameter& p) {
  const double reach = first_box_of_prior * (p.prior == "lognormal" ? *p.sigma * std::exp(*p.mu) : p.sd.value_or((p.max - p.min) / std::sqrt(12.0)));
  return p.coordinate_width(reach, *p.nominal);
}

/// (n_parameters)
std::vector<double> nominal_values(const std::vector<Parameter>& parameters) {
  std::vector<double> theta;
  for (const auto& p : parameters) theta.push_back(*p.nominal);
  return theta;
}

/// The middle of the first box, (n_parameters of the case).
std::vector<double> middle_of(const PosteriorCase& c, const PosteriorInputs& in) {
  if (!c.surrogate) return nominal(c.runs.simulator().shape());
  if (c.basin_progress) c.basin_progress(0, 1);
  const FineRun fine = [&](const std::vector<double>& at) {
    std::vector<double> theta = at;
    for (std::size_t k = theta.size(); k < in.parameters.size(); ++k) theta.push_back(*in.parameters[k].nominal);
    const auto record = in.run(Eigen::Map<const Eigen::MatrixXd>(theta.data(), Eigen::Index(theta.size()), 1), {0})[0];
    return std::vector<double>{record.mean.begin(), record.mean.end()};
  };
  auto found =
      find_basin(in.problem, in.recordings, in.recording_options, in.errors, *c.surrogate, std::max(least_surrogate_error, in.mesh), fine, in.seed, c.threads);
  if (c.basin_progress) c.basin_progress(1, 1);
  return found;
}

/// The first box of a model on meshes, whose runs are expensive.
void lay_box_about(PosteriorInputs& in, const std::vector<double>& middle, const InferenceHints& hints) {
  for (std::size_t k = 0; k < in.parameters.size(); ++k) {
    in.centre.push_back(k < middle.size() ? middle[k] : *in.parameters[k].nominal);
    in.half_width.push_back(first_half_width(in.parameters[k], hints));
  }
}

/// The first box of a model with cheap runs: about the nominal values, or where the model itself fits best.
void lay_box_of_cheap_runs(PosteriorInputs& in, const InferenceHints& hints) {
  if (hints.start == InferenceHints::Start::least_squares) {
    for (const auto& p : in.parameters)
      if (p.prior == "uniform") in.findings.uniform_priors.push_back(p.name);
    const Jitter jitter = jitter_of_the_model(in).value_or(Jitter{});
    if (jitter.standard_errors < most_jitter) {
      place_box_by_least_squares(in);
      in.box.kind = BoxStrategy::Kind::least_squares;
      return;
    }
    in.findings.jitter_standard_errors = jitter.standard_errors;
    in.box.run_variance = jitter.variance;
  }
  for (const auto& p : in.parameters) {
    in.centre.push_back(*p.nominal);
    in.half_width.push_back(half_width_by_prior(p));
  }
}

}  // namespace

ErrorOptions default_errors(const Simulator& simulator) {
  const auto kind = simulator.hints().errors;
  if (kind == InferenceHints::Errors::own_times) return errors_on_own_times(simulator.shape().times.size(), simulator.hints().time_step);
  ErrorOptions errors;
  if (kind == InferenceHints::Errors::no_gauges) remove_gauge_errors(errors);
  return errors;
}

double first_half_width(const Parameter& p, const InferenceHints& hints) {
  if (const auto known = hints.half_widths.find(p.key); known != hints.half_widths.end()) return known->second;
  for (const auto& n : hints.nuisances)
    if (n.key == p.key && n.name == p.name) return n.box_sds * (n.logarithmic ? *p.sigma : *p.sd);
  return 0.1 * (p.logarithmic() ? std::log(p.max / p.min) : p.max - p.min);
}

std::vector<Parameter> posterior_parameters(const Simulator& simulator, const PosteriorSettings& settings) {
  const auto& own = simulator.shape().parameters;
  const InferenceHints hints = simulator.hints();
  auto parameters = settings.physical && !hints.any_prior ? with_handbook_priors(own, hints.handbook) : own;
  for (const auto& n : hints.nuisances) {
    const NuisancePrior prior = prior_of(n, settings);
    const bool absent = std::none_of(parameters.begin(), parameters.end(), [&](const Parameter& p) { return p.key == n.key; });
    if (prior.sd <= 0 || !absent) continue;
    Parameter p{.name = n.name, .key = n.key, .prior = n.logarithmic ? "lognormal" : "normal"};
    p.unit = n.unit;
    if (n.logarithmic) {
      p.nominal = prior.median;
      p.mu = std::log(prior.median);
      p.sigma = prior.sd;
      p.min = prior.median * std::exp(-n.widest_sds * prior.sd);
      p.max = prior.median * std::exp(n.widest_sds * prior.sd);
    } else {
      p.nominal = n.value;
      p.mean = prior.median;
      p.sd = prior.sd;
      p.min = prior.median - n.widest_sds * prior.sd;
      p.max = prior.median + n.widest_sds * prior.sd;
    }
    parameters.push_back(std::move(p));
  }
  return parameters;
}

MeshedRuns meshed_runs(Runs& runs, const PosteriorSettings& settings) {
  const Simulator& simulator = runs.simulator();
  const InferenceHints hints = simulator.hints();
  std::map<std::string, double> numbers;
  if (!hints.numerical_viscosity.empty()) numbers[hints.numerical_viscosity] = settings.emulator.viscosity;
  return {runs, posterior_parameters(simulator, settings), meshes_of(element_sizes(simulator, settings.emulator), numbers)};
}

std::unique_ptr<PosteriorInputs> set_up_posterior(const PosteriorCase& c) {
  const Simulator& simulator = c.runs.simulator();
  const InferenceHints hints = simulator.hints();
  const bool cheap = simulator.capabilities().cheap_runs;
  const MeshedRuns runs = meshed_runs(c.runs, c.settings);
  std::unique_ptr<PosteriorInputs> out(new PosteriorInputs{.problem = c.problem,
                                                           .recordings = c.recordings,
                                                           .recording_options = c.recording_options,
                                                           .errors = c.settings.errors,
                                                           .emulator = c.settings.emulator});
  PosteriorInputs& in = *out;
  in.parameters = runs.parameters();
  in.seed = c.seed;
  in.places.positions = hints.gauge_positions;
  in.discrepancy = c.settings.physical;
  in.identified = hints.identified;
  in.combinations = hints.combinations;
  in.levels = runs.levels();
  in.run = [runs, progress = c.progress](const Eigen::MatrixXd& thetas, const std::vector<int>& level) { return runs.get(thetas, level, {}, progress); };
  if (cheap) {
    in.mesh = mesh_error(simulator, c.settings.emulator, c.settings.errors.mesh, 0);
    if (in.parameters.empty())
      throw InputError({.problem = "the base model has no numbers that may move, so that whatever is off by a little looks like physics left out",
                        .key = "parameter",
                        .suggestion = "add [parameter.*] tables with priors, such as the wave speed and the clock of a station"});
    hold_times_to_the_records(in, c, hints.errors == InferenceHints::Errors::own_times);
    in.box.kind = BoxStrategy::Kind::shrink;
    in.errors.arrival_share = in.errors.arrival_share.value_or(0);
    if (c.first_box) lay_box_of_cheap_runs(in, hints);
    return out;
  }
  const RunRequest finest = runs.request(nominal_values(in.parameters), 0);
  const MeshScale scale = simulator.mesh_scale(finest);
  in.places.outermost = scale.outermost;
  in.mesh = mesh_error(simulator, c.settings.emulator, c.settings.errors.mesh, scale.liquid_element_size);
  in.pulses = c.settings.pulses;
  in.energy_sd = c.settings.energy_sd;
  if (const double sd = c.settings.errors.gauge_place_sd; sd > 0) {
    const auto sizes = element_sizes(simulator, c.settings.emulator);
    const double size = sizes[sizes.size() - 1 - std::size_t(std::min(1, in.levels - 1))];
    in.gauge_places = [runs, sd, size, progress = c.progress](std::span<const double> theta) { return gauge_place_effects(runs, theta, sd, size, progress); };
  }
  if (c.first_box) lay_box_about(in, middle_of(c, in), hints);
  return out;
}

}  // namespace calomel
