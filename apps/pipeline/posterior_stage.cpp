// The stage that samples: basin, emulator, mode, chains, check by the true model.
#include "apps/pipeline/posterior_stage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/interrupt.hpp"
#include "apps/pipeline/nested_fit.hpp"
#include "apps/progress.hpp"
#include "apps/pipeline/stages.hpp"
#include "base/provenance.hpp"
#include "base/random.hpp"
#include "forward/campaign/archive.hpp"
#include "forward/surrogate/feasibility.hpp"
#include "inverse/posterior/basin.hpp"
#include "inverse/posterior/posterior_artefacts.hpp"
#include "inverse/posterior/true_model_check.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/posterior_density.hpp"
#include "uq/posterior_file.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel {

namespace {

constexpr double box_of_viscosity = 1.8;  ///< half width of the box in its logarithm, in prior sds
constexpr double widest_viscosity = 3;    ///< bounds of its prior, in sds
constexpr double box_of_young = 2.5, widest_young = 5;  ///< the same of the steel\'s modulus
constexpr std::size_t predictive_draws = 25, prior_draws = 1000;
constexpr double mesh_error_by_size = 80;      ///< over the local amplitude, per metre of element size: of the first order
constexpr double least_surrogate_error = 0.1;  ///< over the local amplitude, in the search for the basin
constexpr double alarming = 2;  ///< prior standard deviations from the handbook beyond which something else is taken to be missing

/// Half width of the first box, of the parameter or its logarithm: what a polynomial of order two follows over half a millisecond (boxes of 4.5 % of density,
/// 6 % of sound speed and 0.6e5 to 3.6e5 Pa on the slice `null`: left out, 3.6 % at 1 mm, of which 3.0 % are numerical noise).
double first_half_width(const Parameter& p) {
  if (p.key == "material.mercury.density") return 0.035;
  if (p.key == "material.mercury.sound_speed") return 0.05;
  if (p.key == "material.mercury.tensile_cutoff") return p.min > 0 ? 0.7 : 0.6 * *p.nominal;
  return 0.1 * (p.min > 0 ? std::log(p.max / p.min) : p.max - p.min);
}

/// A sentence for every parameter whose posterior lies more than `alarming` prior standard deviations from its prior's middle.
std::vector<std::string> absorption(const std::vector<Parameter>& parameters, const Convergence& convergence) {
  std::vector<std::string> out;
  for (const auto& p : parameters)
    for (const auto& s : convergence.parameters) {
      if (s.name != p.name) continue;
      const bool normal = p.prior == "normal" || p.prior == "truncated_normal", lognormal = p.prior == "lognormal";
      if (!normal && !lognormal) continue;
      const double z = normal ? (s.mean - *p.mean) / *p.sd : (std::log(s.q50) - *p.mu) / *p.sigma;
      if (std::abs(z) > alarming)
        out.push_back(fmt::format("{} sits {:.2g} prior standard deviations {} what was known of it: the model leaves something else out, which it absorbs", p.name, std::abs(z), z > 0 ? "above" : "below"));
    }
  return out;
}

/// The emulator's histories at evenly spaced draws of every chain, the recorded means, draws from the priors.
std::vector<PosteriorGroup> predictive_groups(const PosteriorFit& fit, const Problem& problem, const std::vector<Parameter>& parameters, const SamplerResult& result,
                                              std::uint64_t seed) {
  const auto& shape = problem.shape;
  const PosteriorCoordinate sensor{.name = "sensor", .unit = "", .numbers = {}, .words = shape.sensors}, time{.name = "time", .unit = "s", .numbers = shape.times, .words = {}},
      record_time{.name = "record_time", .unit = "s", .numbers = problem.time, .words = {}}, condition{.name = "condition", .unit = "", .numbers = {}, .words = shape.conditions};
  const bool many = shape.conditions.size() > 1;
  const auto dims = [&](const std::string& last) { return many ? std::vector<std::string>{"condition", "sensor", last} : std::vector<std::string>{"sensor", last}; };
  const auto coordinates = [&](const PosteriorCoordinate& last) { return many ? std::vector<PosteriorCoordinate>{condition, sensor, last} : std::vector<PosteriorCoordinate>{sensor, last}; };
  const std::string unit = shape.unit == "strain" ? "1" : shape.unit;
  const auto point_at = [&](std::size_t chain, std::size_t draw) {
    Eigen::VectorXd q(Eigen::Index(result.coordinates.names.size()));
    for (Eigen::Index k = 0; k < q.size(); ++k) q[k] = result.coordinates.at(chain, draw, std::size_t(k));
    return fit.posterior->point(q);
  };

  PosteriorGroup predictive{.name = "posterior_predictive", .chains = result.coordinates.chains, .draws = std::min(predictive_draws, result.coordinates.draws), .coordinates = coordinates(time), .variables = {}};
  PosteriorVariable strain{.name = "strain", .unit = unit, .dims = dims("time"), .values = {}};
  for (std::size_t c = 0; c < predictive.chains; ++c)
    for (std::size_t i = 0; i < predictive.draws; ++i) {
      const std::size_t draw = (i + 1) * result.coordinates.draws / predictive.draws - 1;
      const auto at = point_at(c, draw);
      const Eigen::VectorXd y = fit.history(at.u, at.beyond);
      strain.values.insert(strain.values.end(), y.begin(), y.end());
    }
  predictive.variables.push_back(std::move(strain));

  PosteriorGroup observed{.name = "observed_data", .coordinates = coordinates(record_time), .variables = {}};
  observed.variables.push_back({.name = "strain", .unit = unit, .dims = dims("record_time"), .values = band_arrays(problem).mean});

  PosteriorGroup prior{.name = "prior", .chains = 1, .draws = prior_draws, .coordinates = {}, .variables = {}};
  RandomStream random(seed, 0x9107);
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    PosteriorVariable v{.name = parameters[k].name, .unit = "", .dims = {}, .values = {}};
    for (std::size_t i = 0; i < prior_draws; ++i) v.values.push_back(fit.posterior->priors()[k].quantile(std::clamp(random.uniform(), 1e-12, 1 - 1e-12)));
    prior.variables.push_back(std::move(v));
  }

  PosteriorGroup likelihood{.name = "log_likelihood", .chains = result.coordinates.chains, .draws = result.coordinates.draws, .coordinates = {}, .variables = {}};
  PosteriorVariable records{.name = "records", .unit = "", .dims = {}, .values = {}};
  for (std::size_t c = 0; c < likelihood.chains; ++c)
    for (std::size_t i = 0; i < likelihood.draws; ++i) {
      records.values.push_back(fit.posterior->density(point_at(c, i)).log_likelihood);
    }
  likelihood.variables.push_back(std::move(records));
  return {std::move(likelihood), std::move(predictive), std::move(observed), std::move(prior)};
}

}  // namespace

std::vector<Parameter> posterior_parameters(const StudyCase& study, const ModelShape& shape) {
  auto parameters = study.map.product == "physical" ? with_handbook_priors(shape.parameters) : shape.parameters;
  const auto& e = study.emulator;
  const auto nuisance = [&](const char* name, const char* key, double median, double sd, double widest) {
    if (sd <= 0 || std::any_of(parameters.begin(), parameters.end(), [&](const Parameter& p) { return p.key == key; })) return;
    Parameter p{.name = name, .key = key, .prior = "lognormal"};
    p.nominal = median, p.mu = std::log(median), p.sigma = sd;
    p.min = median * std::exp(-widest * sd), p.max = median * std::exp(widest * sd);
    parameters.push_back(std::move(p));
  };
  nuisance("regularising_viscosity", viscosity_key, e.viscosity, e.viscosity_sd, widest_viscosity);
  nuisance("young", young_key, study.forward.steel.young, study.errors.young_sd, widest_young);
  return parameters;
}

std::vector<double> element_sizes(const StudyCase& study) {
  if (!study.emulator.element_sizes.empty()) return study.emulator.element_sizes;
  const auto own = study.forward.geometry.resolved().element_size;
  if (!own) return {0};  // of a mesh from a file there is no finer one
  return {*own, 0.5 * *own};
}

Eigen::MatrixXd gauge_positions(const StudyCase& study) {
  Eigen::MatrixXd positions(Eigen::Index(study.forward.sensors.size()), 3);
  for (std::size_t s = 0; s < study.forward.sensors.size(); ++s)
    for (std::size_t i = 0; i < 3; ++i) positions(Eigen::Index(s), Eigen::Index(i)) = study.forward.sensors[s].position[i];
  return positions;
}

double mesh_error(const StudyCase& study) {
  return study.errors.mesh.value_or(std::min(1.0, mesh_error_by_size * study.forward.geometry.resolved().element_size.value_or(0)));
}

std::vector<double> Stages::basin(const CalibrationProgress& progress, const FineRun& fine) {
  const auto& shape = model().shape();
  const bool known = study_.map.product == "physical" || std::all_of(shape.parameters.begin(), shape.parameters.end(), [](const Parameter& p) { return p.prior != "uniform"; });
  if (study_.emulator.start == "nominal" || (study_.emulator.start == "auto" && known)) return nominal(shape);
  (void)train(Asked::upstream);
  const auto surrogate = load_surrogate(command_.out / "surrogate.nc");
  const Archive archive = read_archive(command_.out / "campaign.nc");
  const Feasibility feasibility(archive);
  progress("basin", 0, 1);
  auto found = find_basin(problem(), recordings(), *study_.recordings, study_.errors, GuardedModel(*surrogate, feasibility), gauge_positions(study_),
                          std::max(least_surrogate_error, mesh_error(study_)), fine, command_.seed, command_.threads);
  progress("basin", 1, 1);
  return found;
}

Provenance Stages::runs_provenance() const {
  Json options = study_.model_options();
  options.erase("parameter");  // points name what they set
  options["campaign"] = {{"pulses", study_.campaign.pulses}, {"pulse_energy_sd", study_.campaign.pulse_energy_sd}};
  return {.stage = "runs", .options = std::move(options), .seed = 0, .inputs = study_.model_inputs()};
}

Provenance Stages::posterior_provenance() const {
  Json options{{"product", study_.map.product}, {"recordings", echo(*study_.recordings)}, {"emulator", echo(study_.emulator)}, {"errors", echo(study_.errors)}, {"sampler", echo(study_.sampler)}};
  for (const auto& p : study_.forward.parameters) options["parameter"][p.name] = echo(p);
  return {.stage = "posterior",
          .options = std::move(options),
          .seed = command_.seed,
          .inputs = {{"model", runs_provenance().identity()}, {"recordings", hash_file(study_.recordings_file())}}};
}

RunStore& Stages::run_store() {
  if (!runs_) {
    const auto journal = command_.out / "runs.journal";
    if (command_.fresh && std::filesystem::exists(journal) && RunStore::identity(journal) != runs_provenance().identity()) set_aside(journal);
    runs_ = std::make_unique<RunStore>(runs_provenance(), journal);
  }
  return *runs_;
}

std::unique_ptr<CasePosterior> Stages::fit_case_posterior(const CalibrationProgress& progress, const NestedFit* nested) {
  auto out = std::make_unique<CasePosterior>();
  const EmulatorOptions& e = study_.emulator;
  const auto parameters = posterior_parameters(study_, model().shape());
  const EnsembleOptions ensemble{.pulses = study_.campaign.pulses, .energy_sd = study_.campaign.pulse_energy_sd};
  out->runs = std::make_unique<LevelRuns>(study_.forward, ensemble, parameters, element_sizes(study_), e.viscosity, run_store());
  out->records = recordings();
  out->inputs.reset(new PosteriorInputs{.problem = problem(), .recordings = out->records, .recording_options = *study_.recordings, .errors = study_.errors, .emulator = e});
  PosteriorInputs& in = *out->inputs;
  in.parameters = parameters, in.levels = out->runs->levels(), in.seed = command_.seed;
  in.positions = gauge_positions(study_), in.mesh = mesh_error(study_), in.discrepancy = study_.map.product == "physical";
  LevelRuns* runs = out->runs.get();
  const auto told = [progress](std::size_t done, std::size_t total) { progress("runs of the true model", done, total); };
  in.run = [=, this](const Eigen::MatrixXd& thetas, const std::vector<int>& level) { return runs->run(thetas, level, command_.threads, told, &stop_requested()); };
  if (study_.errors.gauge_place_sd > 0)
    in.gauge_places = [=, this](std::span<const double> theta) { return runs->gauge_places(theta, study_.errors.gauge_place_sd, command_.threads, told, &stop_requested()); };
  const auto fine = [&](const std::vector<double>& theta) {
    std::vector<double> all = theta;
    for (std::size_t k = theta.size(); k < parameters.size(); ++k) all.push_back(*parameters[k].nominal);
    const auto record = in.run(Eigen::Map<const Eigen::MatrixXd>(all.data(), Eigen::Index(all.size()), 1), {0})[0];
    return std::vector<double>(record.mean.begin(), record.mean.end());
  };
  const auto centre = basin(progress, fine);
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    in.centre.push_back(k < centre.size() ? centre[k] : *parameters[k].nominal);
    const bool nuisance = k >= centre.size();
    in.half_width.push_back(!nuisance ? first_half_width(parameters[k]) : (parameters[k].key == viscosity_key ? box_of_viscosity : box_of_young) * *parameters[k].sigma);
  }
  in.round_done = [this, &parameters = in.parameters](const PosteriorRound& r) {
    std::string at;
    for (std::size_t k = 0; k < parameters.size(); ++k) at += fmt::format("{}{} {:.5g} ± {:.2g}", k ? ", " : "", parameters[k].name, r.theta[k], r.theta_sd[k]);
    say(fmt::format("emulator: {} coarse and {} fine runs{}: {}; emulator's variance {:.2g}", r.coarse, r.fine, r.failed ? fmt::format(" ({} failed)", r.failed) : "", at, r.variance));
  };
  if (nested) {
    in.held = nested->held, in.nested_centre = nested->theta;
    expect_nested(*nested, in.run(Eigen::Map<const Eigen::MatrixXd>(nested->theta.data(), Eigen::Index(nested->theta.size()), 1), {0})[0], study_.map);
  }
  out->fit = fit_posterior(in);
  return out;
}

const CasePosterior& Stages::case_posterior(const CalibrationProgress& progress) {
  if (!posterior_) posterior_ = fit_case_posterior(progress);
  return *posterior_;
}

ExitStatus Stages::sample() {
  (void)problem();
  const auto provenance = posterior_provenance();
  if (!due(provenance, {"posterior.json", "posterior.nc"}, Asked::by_user)) {
    say("sample: reused");
    return read_json(command_.out / "posterior.json").value("status", "") == "done" ? ExitStatus::done : ExitStatus::not_to_be_trusted;
  }
  const auto progress = stage_progress("sample");
  const CasePosterior* made = study_.file.locating([&] { return &case_posterior(progress); });
  const PosteriorFit& fit = made->fit;
  const auto& parameters = made->inputs->parameters;
  say("sample: the emulator " + fit.message);

  const PosteriorDensity density(*fit.posterior);
  const auto& best = fit.modes[0];
  const Eigen::Index d = fit.posterior->box().size();
  // Laplace's covariance by q: du/dq = (1 - u^2) / 2.
  Eigen::VectorXd by_u = Eigen::VectorXd::Ones(fit.posterior->dimension());
  by_u.head(d) = 2 / (1 - best.at.u.array().square()).max(0.05);
  SamplerStart start{.mean = fit.posterior->q(best.at.theta, best.at.beyond), .covariance = by_u.asDiagonal() * best.covariance * by_u.asDiagonal(), .points = {}};
  const auto journal = command_.out / "posterior.journal";
  const SamplerRun run{.seed = command_.seed, .threads = command_.threads, .journal = journal, .provenance = provenance,
                       .progress = [&](std::size_t done, std::size_t all) { progress("transitions", done, all); }, .stop = &stop_requested()};
  const auto result = run_sampler(density, start, study_.sampler, run);
  double acceptance = 0;
  for (const double a : result.summary.acceptance) acceptance += a / double(result.summary.acceptance.size());
  const Convergence convergence = assess(result.quantities, {.acceptance = acceptance, .thin = study_.sampler.thin});
  const TrueModelCheck check = check_by_true_model(*made->inputs, fit, study_.emulator.check_coarse, study_.emulator.check_fine);
  const auto alarms = absorption(parameters, convergence);

  auto groups = posterior_groups(density, result);
  for (auto& g : predictive_groups(fit, problem(), parameters, result, command_.seed)) groups.push_back(std::move(g));
  const bool trusted = convergence.converged && fit.settled && check.holds;
  Json json = posterior_json(convergence, study_.sampler.kind, result, provenance);
  json["status"] = trusted ? "done" : "not_to_be_trusted";
  json["product"] = study_.map.product == "physical" ? "physical" : "tuned";
  json["final"] = trusted;
  // What was drawn is the posterior when the chains have converged, on an emulator that has settled, where the true model lies where the emulator says.
  json["chains_converged"] = convergence.converged, json["converged"] = trusted;
  json["message"] = !convergence.converged ? convergence.message : !fit.settled ? "the emulator " + fit.message : !check.holds ? check.sentence : convergence.message;
  json["mode"] = fit_json(fit, parameters);
  json["true_model_check"] = check_json(check, parameters);
  json["absorption"] = alarms;
  json["runs"] = {{"made", run_store().made()}, {"reused", run_store().reused()}, {"held", run_store().size()}, {"element_sizes", element_sizes(study_)}};
  write_posterior(command_.out / "posterior.nc", groups, provenance);
  write_json(command_.out / "posterior.json", json);
  remove_journal(journal);
  for (const auto& p : convergence.parameters)
    say(fmt::format("sample: {} {:.5g} ± {:.2g} (90 %: {:.5g} to {:.5g}; R-hat {:.3f}, ESS {:.0f})", p.name, p.mean, p.sd, p.q05, p.q95, p.r_hat, p.ess_bulk));
  say("sample: " + check.sentence);
  for (const auto& a : alarms) say("warning: " + a);
  say("sample: " + convergence.message);
  if (!fit.settled) say("warning: the emulator " + fit.message);
  return trusted ? ExitStatus::done : ExitStatus::not_to_be_trusted;
}

}  // namespace calomel
