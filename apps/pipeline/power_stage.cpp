#include "apps/pipeline/power_stage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/inputs/posterior_case.hpp"
#include "apps/inputs/posterior_inputs.hpp"
#include "apps/inputs/provenances.hpp"
#include "apps/interrupt.hpp"
#include "apps/presentation/diagnosis_course.hpp"
#include "apps/presentation/posterior_lines.hpp"
#include "apps/presentation/power_lines.hpp"
#include "apps/presentation/run_lines.hpp"
#include "base/artefact.hpp"
#include "base/median.hpp"
#include "base/not_finite.hpp"
#include "base/provenance.hpp"
#include "base/random.hpp"
#include "uq/power/power.hpp"

namespace calomel {

namespace {

constexpr double margin = 0.05;  ///< of the target's extent: so far from its edges a gauge is put

struct Place {
  Vec3 position, direction;
};

/// Places on the outer surface as far from the case's gauges and from each other as they come, one after another.
std::vector<Place> free_places(const Mesh& mesh, const std::vector<SensorOptions>& own, int wanted) {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (const auto& f : mesh.outer)
    for (const auto n : f.nodes)
      for (std::size_t i = 0; i < 3; ++i) low[i] = std::min(low[i], mesh.nodes[std::size_t(n)][i]), high[i] = std::max(high[i], mesh.nodes[std::size_t(n)][i]);
  std::vector<Place> all;
  for (const auto& f : mesh.outer) {
    std::array<Vec3, 4> x;
    Vec3 middle{};
    for (std::size_t k = 0; k < 4; ++k) {
      x[k] = mesh.nodes[std::size_t(f.nodes[k])];
      for (std::size_t i = 0; i < 3; ++i) middle[i] += x[k][i] / 4;
    }
    const Eigen::Vector3d a(x[2][0] - x[0][0], x[2][1] - x[0][1], x[2][2] - x[0][2]), b(x[3][0] - x[1][0], x[3][1] - x[1][1], x[3][2] - x[1][2]);
    const Eigen::Vector3d normal = a.cross(b).normalized().cwiseAbs();
    if (mesh.plane_strain && normal[1] > 0.5) continue;
    bool inside = true;
    for (std::size_t i = 0; i < 3; ++i) {
      if (normal[Eigen::Index(i)] > 0.5 || (mesh.plane_strain && i == 1)) continue;
      const double share = (middle[i] - low[i]) / (high[i] - low[i]);
      inside = inside && share > margin && share < 1 - margin;
    }
    if (!inside) continue;
    if (mesh.plane_strain) middle[1] = 0;
    const bool front = normal[0] > 0.7;
    all.push_back({middle, front ? Vec3{0, 0, 1} : Vec3{1, 0, 0}});
  }
  const auto distance = [](const auto& p, const auto& q) { return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]); };
  std::vector<double> nearest(all.size(), 1e300);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (const auto& s : own) nearest[i] = std::min(nearest[i], distance(all[i].position, s.position));
  std::vector<Place> out;
  while (int(out.size()) < wanted && !all.empty()) {
    const auto farthest = std::size_t(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
    if (!(nearest[farthest] > 0)) break;
    out.push_back(all[farthest]);
    for (std::size_t i = 0; i < all.size(); ++i) nearest[i] = std::min(nearest[i], distance(all[i].position, out.back().position));
  }
  return out;
}

/// The case with all gauges and beam powers that are to be tried, and the plans they make.
struct Planned {
  StudyCase study;
  std::size_t own_sensors;
  std::vector<std::string> gauges;  ///< what each further gauge is called
  std::vector<std::string> powers;  ///< of each further condition
};

Planned planned(const StudyInputs& inputs, const Mesh& mesh) {
  Planned out{.study = StudyCase::read(inputs.command().case_file, inputs.command().overrides),
              .own_sensors = inputs.study().forward.sensors.size(),
              .gauges = {},
              .powers = {}};
  const PowerOptions& options = out.study.power;
  ForwardCase& c = out.study.forward;
  std::vector<double> lengths;
  for (const auto& s : c.sensors) lengths.push_back(s.gauge_length);
  const double usual_length = lengths.empty() ? 0 : upper_median(std::move(lengths));
  for (const auto& place : free_places(mesh, c.sensors, options.gauges)) {
    SensorOptions s{.name = fmt::format("new {}", out.gauges.size() + 1), .position = place.position, .direction = place.direction};
    s.gauge_length = usual_length;
    out.gauges.push_back(
        fmt::format("a gauge along {} at ({:.3g}, {:.3g}, {:.3g}) m", s.direction[0] > 0 ? "x" : "z", s.position[0], s.position[1], s.position[2]));
    c.sensors.push_back(std::move(s));
  }
  if (c.conditions.empty() && !options.energies.empty() && (c.load.peak_pressure || c.load.energy)) {
    const auto condition = [&](const std::string& name, double by) {
      ConditionOptions o{.name = name, .peak_pressure = {}, .energy = {}};
      if (c.load.energy)
        o.energy = by * *c.load.energy;
      else
        o.peak_pressure = by * *c.load.peak_pressure;
      c.conditions.push_back(std::move(o));
    };
    condition("as planned", 1);
    for (const double by : options.energies)
      condition(fmt::format("times {:.3g}", by), by), out.powers.push_back(fmt::format("records at {:.3g} times the beam power as well", by));
  }
  return out;
}

/// Records of a model: its mean, its answer to each pulse's energy, and noise.
Recordings planned_records(const ModelShape& shape, const RunRecord& run, const PowerOptions& o, std::uint64_t seed) {
  Recordings r;
  r.conditions = shape.conditions, r.sensors = shape.sensors, r.time = shape.times, r.unit = shape.unit;
  r.source = "[power]", r.sensor_lines.assign(shape.sensors.size(), 0);
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
    const Planned plan = planned(inputs, inputs.model().mesh());
    const StudyCase& study = plan.study;
    const auto runs = runs_provenance(study);
    RunStore store(runs, inputs.journal("power_runs.journal", runs));
    LevelRuns levels(study.forward, inputs.ensemble(), posterior_parameters(study), element_sizes(study), study.emulator.viscosity, store);
    const ModelShape& shape = levels.model(0).shape();
    const auto told = [&](std::size_t done, std::size_t total) { notes.say(fmt::format("power: {} of {} runs of the true model", done, total)); };

    std::vector<double> theta;
    for (const auto& p : posterior_parameters(study)) theta.push_back(*p.nominal);
    const auto run =
        levels.run(Eigen::Map<const Eigen::MatrixXd>(theta.data(), Eigen::Index(theta.size()), 1), {0}, command.threads, told, &stop_requested())[0];
    if (!run.done) throw NumericsError("the base model fails at its nominal values: " + run.message);
    const Recordings recordings = planned_records(shape, run, study.power, command.seed);
    const RecordingOptions recording_options;
    const Problem problem = make_problem(shape, recordings, recording_options);
    const auto in =
        posterior_inputs({.study = study, .runs = levels, .problem = problem, .recordings = recordings, .recording_options = recording_options}, command, told);
    put_first_box(*in, nominal(shape));
    in->round_done = [&](const PosteriorRound& r) { notes.say(round_line(r, in->parameters)); };
    const PosteriorFit fit = fit_posterior(*in);
    const auto groups = offered_groups(study.forward, inputs.model().mesh());
    const ScreeningResult screening =
        screen_candidates({.fit = fit,
                           .problem = problem,
                           .groups = groups,
                           .level = levels.levels() > 1 ? 1 : 0,
                           .run = [&](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> added) {
                             return levels.run(thetas, level, added, command.threads, told, &stop_requested());
                           }});

    std::vector<Plan> plans{{.name = "as planned", .observations = {}}};
    for (const auto& g : plan.gauges) plans.push_back({"with " + g, {}});
    for (const auto& p : plan.powers) plans.push_back({"with " + p, {}});
    for (std::size_t i = 0; i < problem.observations.size(); ++i) {
      const auto& o = problem.observations[i];
      const bool own = o.sensor < plan.own_sensors, first = o.condition == 0 || plan.powers.empty();
      for (std::size_t k = 0; k < plans.size(); ++k) {
        const bool gauge = k > 0 && k <= plan.gauges.size() && first && o.sensor == plan.own_sensors + k - 1,
                   other = k > plan.gauges.size() && own && o.condition == k - plan.gauges.size();
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
