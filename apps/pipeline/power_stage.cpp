#include "apps/pipeline/power_stage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/inputs/provenances.hpp"
#include "apps/presentation/diagnosis_course.hpp"
#include "apps/presentation/posterior_lines.hpp"
#include "apps/presentation/power_lines.hpp"
#include "apps/presentation/run_lines.hpp"
#include "base/artefact.hpp"
#include "base/not_finite.hpp"
#include "base/provenance.hpp"
#include "base/random.hpp"
#include "uq/power/power.hpp"

namespace calomel {

namespace {

/// Records of a model: its mean, its answer to each pulse's energy, and noise.
Recordings planned_records(const ModelShape& shape, const RunRecord& run, const PowerOptions& o, std::uint64_t seed) {
  Recordings r;
  r.conditions = shape.conditions;
  r.sensors = shape.sensors;
  r.time = shape.times;
  r.unit = shape.unit;
  r.source = "[power]";
  r.sensor_lines.assign(shape.sensors.size(), 0);
  for (int p = 0; p < o.pulses; ++p) r.pulses.push_back(p);
  r.values.resize(shape.values() * r.pulses.size());
  const double memory = o.noise_time > 0 ? std::exp(-(shape.times[1] - shape.times[0]) / o.noise_time) : 0;
  RandomStream random(seed, 17);
  for (std::size_t c = 0; c < shape.conditions.size(); ++c)
    for (std::size_t p = 0; p < r.pulses.size(); ++p) {
      const double energy = o.energy_sd * random.normal();
      for (std::size_t s = 0; s < shape.sensors.size(); ++s) {
        double noise = random.normal();
        for (std::size_t t = 0; t < shape.times.size(); ++t) {
          const std::size_t i = shape.at(c, s, t);
          r.values[r.at(c, s, p, t)] = double(run.mean[i]) + energy * double(run.energy_slope.empty() ? run.mean[i] : run.energy_slope[i]) + o.noise * noise;
          noise = memory * noise + std::sqrt(1 - memory * memory) * random.normal();
        }
      }
    }
  return r;
}

Json plan_json(const PlanPower& p) {
  Json numbers = Json::array();
  for (const auto& d : p.numbers)
    numbers.push_back({{"mechanism", d.mechanism},
                       {"place", d.place},
                       {"parameter", d.number},
                       {"off", number(d.off)},
                       {"named_from", d.from ? number(*d.from) : Json()},
                       {"end_of_range", number(d.farthest)},
                       {"share_of_range", number(d.share)},
                       {"limited_by", d.limited_by}});
  return {{"name", p.plan.name}, {"gain", number(p.gain)}, {"numbers", numbers}};
}

}  // namespace

ExitStatus power_stage(StageCall& call) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  const auto& notes = inputs.notes();
  return inputs.study().file.locating([&] {
    const StudyCase& study = inputs.study();
    const auto plan = inputs.simulator().planned(study.power.gauges, study.power.energies);
    expect(plan.has_value(), "only a case whose model can be planned with comes here");
    const auto other = inputs.runs_of(*plan->simulator, "power_runs.journal");
    const ModelShape& shape = plan->simulator->shape();
    const Runs::Progress progress = [&](std::size_t done, std::size_t total) { notes.say(fmt::format("power: {} of {} runs of the true model", done, total)); };

    const RecordingOptions recording_options;
    const MeshedRuns runs = meshed_runs(*other.runs, study.posterior_settings());
    std::vector<double> theta;
    for (const auto& p : runs.parameters()) theta.push_back(*p.nominal);
    const auto run = runs.get(Eigen::Map<const Eigen::MatrixXd>(theta.data(), Eigen::Index(theta.size()), 1), {0}, {}, progress)[0];
    if (!run.done) throw NumericsError("the base model fails at its nominal values: " + run.message);
    const Recordings recordings = planned_records(shape, run, study.power, command.seed);
    const Problem problem = make_problem(shape, recordings, recording_options);
    const auto in = set_up_posterior({.runs = *other.runs,
                                      .problem = problem,
                                      .recordings = recordings,
                                      .recording_options = recording_options,
                                      .settings = study.posterior_settings(),
                                      .seed = command.seed,
                                      .threads = command.threads,
                                      .progress = progress});
    const PosteriorFit fit = fit_posterior(*in, {.round_done = [&](const PosteriorRound& r) { notes.say(round_line(r, in->parameters)); }, .go_on = {}});
    const auto groups = inputs.simulator().offered();
    const ScreeningResult screening =
        screen_candidates({.fit = fit,
                           .problem = problem,
                           .groups = groups,
                           .level = runs.levels() > 1 ? 1 : 0,
                           .run = [&](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> added) {
                             return runs.get(thetas, level, added, progress);
                           }});

    std::vector<Plan> plans{{.name = "as planned", .observations = {}}};
    for (const auto& g : plan->gauges) plans.push_back({"with " + g, {}});
    for (const auto& p : plan->energies) plans.push_back({"with " + p, {}});
    for (std::size_t i = 0; i < problem.observations.size(); ++i) {
      const auto& o = problem.observations[i];
      const bool own = o.sensor < plan->own_sensors, first = o.condition == 0 || plan->energies.empty();
      for (std::size_t k = 0; k < plans.size(); ++k) {
        const bool gauge = k > 0 && k <= plan->gauges.size() && first && o.sensor == plan->own_sensors + k - 1,
                   other = k > plan->gauges.size() && own && o.condition == k - plan->gauges.size();
        if ((own && first) || gauge || other) plans[k].observations.push_back(i);
      }
    }
    auto all = power(fit, problem, groups, screening.candidates, plans);
    std::stable_sort(all.begin() + 1, all.end(), [](const auto& a, const auto& b) { return a.gain > b.gain; });
    Json json = Json::array();
    for (const auto& p : all) json.push_back(plan_json(p));
    write_json(
        inputs.artefact("power.json"),
        {{"plans", json}, {"skipped", not_screened_texts(screening.not_screened)}, {"settled", fit.settled}, {"provenance", power_provenance(inputs).json()}});
    notes.say(power_lines(all));
    return fit.settled ? ExitStatus::done : ExitStatus::not_to_be_trusted;
  });
}

}  // namespace calomel
