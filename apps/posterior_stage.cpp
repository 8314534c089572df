#include "apps/posterior_stage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/interrupt.hpp"
#include "apps/progress.hpp"
#include "apps/verbs.hpp"
#include "inverse/calibration.hpp"

namespace calomel {

namespace {

constexpr double box_of_viscosity = 1.8;   ///< half width of the box in its logarithm, in prior sds
constexpr double widest_viscosity = 3;     ///< bounds of its prior in sds

/// Half width of the first box about the basin, of the parameter or its logarithm: what a polynomial of order two follows over half a millisecond.
double first_half_width(const Parameter& p) {
  const double middle = *p.nominal;
  if (p.key == "material.mercury.density") return 0.035;
  if (p.key == "material.mercury.sound_speed") return 0.05;
  if (p.key == "material.mercury.tensile_cutoff") return p.min > 0 ? 0.7 : 0.6 * middle;
  return 0.1 * (p.min > 0 ? std::log(p.max / p.min) : p.max - p.min);
}

}  // namespace

std::vector<Parameter> posterior_parameters(const StudyCase& study, const ModelShape& shape) {
  auto parameters = study.map.product == "physical" ? with_handbook_priors(shape.parameters) : shape.parameters;
  const auto& e = study.emulator;
  const bool there = std::any_of(parameters.begin(), parameters.end(), [](const Parameter& p) { return p.key == viscosity_key; });
  if (!there && e.viscosity_sd > 0) {
    Parameter p{.name = "regularising_viscosity", .key = viscosity_key, .prior = "lognormal"};
    p.nominal = e.viscosity, p.mu = std::log(e.viscosity), p.sigma = e.viscosity_sd;
    p.min = e.viscosity * std::exp(-widest_viscosity * e.viscosity_sd), p.max = e.viscosity * std::exp(widest_viscosity * e.viscosity_sd);
    parameters.push_back(std::move(p));
  }
  return parameters;
}

ExitStatus Stages::sample() {
  (void)problem();
  const auto parameters = posterior_parameters(study_, model().shape());
  const EmulatorOptions& e = study_.emulator;
  std::vector<double> sizes = e.element_sizes;
  if (sizes.empty())
    if (const auto own = study_.forward.geometry.resolved().element_size) sizes = {*own, 0.5 * *own};
  Json options = study_.model_options();
  options.erase("parameter");
  options["campaign"] = {{"pulses", study_.campaign.pulses}, {"pulse_energy_sd", study_.campaign.pulse_energy_sd}};
  const Provenance of_runs{.stage = "runs", .options = std::move(options), .seed = command_.seed, .inputs = study_.model_inputs()};
  CasePosterior out;
  out.store = std::make_unique<RunStore>(of_runs, command_.out);
  const EnsembleOptions ensemble{.pulses = study_.campaign.pulses, .energy_sd = study_.campaign.pulse_energy_sd};
  out.runs = std::make_unique<LevelRuns>(study_.forward, ensemble, parameters, sizes, e.viscosity, *out.store);
  const Recordings records = recordings();
  PosteriorInputs in{.problem = problem(), .recordings = records, .recording_options = *study_.recordings, .errors = study_.errors, .emulator = e};
  in.parameters = parameters, in.levels = out.runs->levels(), in.seed = command_.seed;
  in.positions.resize(Eigen::Index(study_.forward.sensors.size()), 3);
  for (std::size_t s = 0; s < study_.forward.sensors.size(); ++s)
    for (std::size_t i = 0; i < 3; ++i) in.positions(Eigen::Index(s), Eigen::Index(i)) = study_.forward.sensors[s].position[i];
  ProgressDisplay display("sample", "runs", progress_style(command_.quiet), std::cerr);
  const auto progress = [&](std::size_t done, std::size_t total) { display.update(done, total); };
  in.run = [&](const Eigen::MatrixXd& thetas, const std::vector<int>& level) { return out.runs->run(thetas, level, command_.threads, progress, &stop_requested()); };
  if (study_.errors.young_sd > 0 || study_.errors.gauge_place_sd > 0)
    in.unknowns = [&](std::span<const double> theta) {
      return out.runs->unknowns(theta, study_.errors.young_sd, study_.errors.gauge_place_sd, command_.threads, progress, &stop_requested());
    };
  for (const auto& p : parameters) {
    in.centre.push_back(*p.nominal);
    in.half_width.push_back(p.key == viscosity_key ? box_of_viscosity * e.viscosity_sd : first_half_width(p));
  }
  const Clock clock;
  out.fit = fit_posterior(in);
  const auto& fit = out.fit;
  const auto& best = fit.modes[0];
  Json json{{"message", fit.message}, {"settled", fit.settled}, {"wall_s", clock.seconds()}, {"runs_made", out.store->made()}};
  const Eigen::MatrixXd covariance = parameter_covariance(*fit.posterior, best);
  for (std::size_t k = 0; k < parameters.size(); ++k)
    json["mode"].push_back({{"name", parameters[k].name}, {"value", best.at.theta[k]}, {"sd", std::sqrt(covariance(Eigen::Index(k), Eigen::Index(k)))}});
  json["beyond"] = best.at.beyond;
  json["gradient"] = best.gradient;
  const auto density = fit.posterior->density(best.at);
  json["chi2"] = density.chi2, json["values"] = fit.posterior->values(), json["variance"] = density.variance;
  for (const auto& r : fit.rounds)
    json["rounds"].push_back({{"coarse", r.coarse}, {"fine", r.fine}, {"failed", r.failed}, {"theta", r.theta}, {"moved", number(r.moved)}, {"variance", r.variance}, {"moved_box", r.moved_box}});
  for (const auto& l : fit.levels) json["levels"].push_back({{"runs", l.runs}, {"left_out", l.left_out}, {"noise", l.noise}});
  for (const auto& [name, share] : fit.errors->shares()) json["shares"][name] = share;
  write_json(command_.out / "posterior.json", json);
  say(json.dump(1));
  return fit.settled ? ExitStatus::done : ExitStatus::not_to_be_trusted;
}

ExitStatus run_sample(const CommandLine& command) { return Stages(command).sample(); }

}  // namespace calomel
