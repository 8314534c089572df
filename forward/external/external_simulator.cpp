#include "forward/external/external_simulator.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>

namespace calomel {

ExternalSimulator::ExternalSimulator(ExternalCase external)
    : case_(std::move(external)), shape_(shape_of(case_)), capabilities_{.cheap_runs = true, .log_density = case_.is_log_density()} {}

const ExternalModel& ExternalSimulator::model() const {
  const std::lock_guard guard(lock_);
  if (!model_) model_ = std::make_unique<ExternalModel>(case_);
  return *model_;
}

Prediction ExternalSimulator::evaluate(const RunRequest& request) const {
  std::map<std::string, double> further = request.numbers;
  std::vector<double> theta;
  for (const auto& p : shape_.parameters) {
    const auto own = further.find(p.key);
    theta.push_back(own == further.end() ? *p.nominal : own->second);
    if (own != further.end()) further.erase(own);
  }
  return model().evaluate(theta, further);
}

Description ExternalSimulator::describe(int) const {
  const ExternalModel& m = model();
  Description out;
  const auto add = [&](const char* label, std::string text) { out.facts.push_back({label, std::move(text)}); };
  add("case", fmt::format("{}, an external model", case_.name));
  add("model", fmt::format("\"{}\" at {}, input blocks {}, output blocks {}, gradients: {}", case_.server.name, case_.server.url, m.input_sizes(),
                           m.output_sizes(), m.has_gradient() ? "yes" : "no"));
  add("output", case_.is_log_density() ? std::string("a log density")
                                       : fmt::format("{} sensors at {} times, {:.4g} to {:.4g} s, values in {}", shape_.sensors.size(), shape_.times.size(),
                                                     shape_.times.front(), shape_.times.back(), case_.unit));
  std::vector<std::string> enabled, offered, names;
  for (const auto& each : case_.mechanisms) (each.enabled ? enabled : offered).push_back(each.name);
  add("mechanisms", (enabled.empty() ? "none" : join(enabled)) + (offered.empty() ? "" : "; offered to a diagnosis: " + join(offered)));
  for (const auto& p : case_.parameters) names.push_back(fmt::format("{} {:.4g} to {:.4g}", p.name, p.min, p.max));
  add("parameters", join(names));
  out.summary = {{"elements", nullptr}, {"nodes", nullptr}};  // not known of an external model
  return out;
}

SimulatorIdentity ExternalSimulator::identity() const {
  SimulatorIdentity out{.options = case_.model_options(), .inputs = {}, .simulate = Json::object(), .offered = Json::object()};
  out.offered["mechanism"] = case_.echo()["mechanism"];  // priors of mechanisms decide a verdict and no run
  out.offered["offered"] = Json::array();
  return out;
}

InferenceHints ExternalSimulator::hints() const {
  InferenceHints h;
  h.start = InferenceHints::Start::least_squares;
  h.errors = InferenceHints::Errors::own_times;
  h.time_step = case_.time.step;
  h.any_prior = true;
  h.idle_numbers = true;
  return h;
}

Simulated ExternalSimulator::simulate(const SimulateCall& call) const {
  if (!call.fields.empty()) throw InputError({.problem = "fields are of a model on a mesh", .key = "--fields", .suggestion = "leave it out"});
  if (call.mean)
    throw InputError({.problem = "an external model gives its mean itself; set its pulses in [model.config]", .key = "--mean", .suggestion = "leave it out"});
  const auto theta = nominal(shape_);
  const ExternalModel& m = model();
  const auto start = std::chrono::steady_clock::now();
  auto prediction = m.evaluate(theta);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!prediction.ok) throw NumericsError(prediction.message);
  return {.values = std::move(prediction.mean),
          .summary = {{"steps", nullptr},
                      {"time_step_s", nullptr},
                      {"wall_s", wall},
                      {"element_steps_per_s", nullptr},
                      {"energy_balance_error", nullptr},
                      {"theta", named(shape_.parameters, theta)}},
          .wall_s = wall};
}

SimulatorKind external_kind() {
  return {.make = [](CaseFile& file, const SimulatorSettings& settings) -> std::unique_ptr<Simulator> {
            ExternalCase c = ExternalCase::read(file);
            c.server.stop = settings.stop;
            return std::make_unique<ExternalSimulator>(std::move(c));
          },
          .tables = {"output"},
          .reference = external_reference};
}

}  // namespace calomel
