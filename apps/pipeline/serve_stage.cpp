#include "apps/pipeline/serve_stage.hpp"

#include <fmt/format.h>

#include "apps/inputs/provenances.hpp"
#include "apps/interrupt.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/linear_algebra.hpp"
#include "base/provenance.hpp"
#include "forward/external/umbridge_server.hpp"
#include "forward/surrogate/surrogate.hpp"

namespace calomel {

namespace {

constexpr int most_pulses = 1000;  ///< of an ensemble that a request may request

/// The pulses that a request's config gives; 1 where it gives none. Errors: InputError for any other key.
int pulses_of(const Json& config) {
  int pulses = 1;
  for (const auto& [key, value] : config.items()) {
    if (key != "pulses")
      throw InputError({.problem = "unknown key of config", .key = key, .suggestion = "the model knows \"pulses\": the ensemble mean over so many energies"});
    if (!value.is_number_integer() || value.get<std::int64_t>() < 1 || value.get<std::int64_t>() > most_pulses)
      throw InputError(
          {.problem = "must be a whole number", .key = "config.pulses", .value = value.dump().substr(0, 40), .range = fmt::format("1 to {}", most_pulses)});
    pulses = value.get<int>();
  }
  return pulses;
}

void expect_no_config(const Json& config) {
  if (!config.empty()) throw InputError({.problem = "this model takes no config", .key = config.begin().key()});
}

std::vector<double> answer_of(Prediction prediction) {
  if (!prediction.ok) throw NumericsError(prediction.message);
  return std::move(prediction.mean);
}

/// Refuses values that no case file allows, for example a negative density. ranges: of the parameters' keys.
void expect_possible(const std::vector<Parameter>& parameters, const std::vector<Range>& ranges, const std::vector<double>& theta) {
  for (std::size_t k = 0; k < theta.size(); ++k)
    if (!ranges[k].contains(theta[k]))
      throw InputError(
          {.problem = parameters[k].key + " cannot be that", .key = parameters[k].name, .value = number_text(theta[k]), .range = ranges[k].text()});
}

ServedModel described(const std::string& name, const ModelShape& shape) {
  ServedModel out{
      .name = name, .input_sizes = {shape.parameters.size()}, .output_sizes = {shape.values()}, .evaluate = {}, .gradient = {}, .apply_jacobian = {}};
  return out;
}

ServedModel served(StudyInputs& inputs) {
  const Simulator& simulator = inputs.simulator();
  (void)inputs.study().file.locating([&] { return simulator.describe(); });  // what is wrong with the case is reported before the server listens
  ServedModel out = described("forward", simulator.shape());
  std::vector<Range> ranges;
  for (const auto& p : simulator.shape().parameters) ranges.push_back(simulator.range(p));
  Runs& runs = inputs.runs();
  const bool has_pulses = simulator.capabilities().pulses;
  out.evaluate = [&simulator, &runs, ranges, has_pulses](const Blocks& input, const Json& config) {
    if (!has_pulses) expect_no_config(config);
    expect_possible(simulator.shape().parameters, ranges, input[0]);
    RunRequest request = request_at(simulator.shape().parameters, input[0]);
    if (has_pulses) request.pulses = pulses_of(config);
    return Blocks{answer_of(runs.evaluate(request))};
  };
  return out;
}

/// J v of a surrogate from as many gradients as it has directions, or values where it is not of that form.
std::vector<double> jacobian_action(const Surrogate& surrogate, const std::vector<double>& theta, const std::vector<double>& v) {
  const HistoryBasis basis = surrogate.basis();
  const Eigen::Map<const Eigen::VectorXd> direction(v.data(), Eigen::Index(v.size()));
  const auto gradient = [&](const Eigen::VectorXd& weights) {
    return surrogate.vector_jacobian_product(theta, {weights.data(), std::size_t(weights.size())}).dot(direction);
  };
  const auto values = Eigen::Index(surrogate.shape().values());
  Eigen::VectorXd out(values);
  if (basis.empty()) {
    for (Eigen::Index i = 0; i < values; ++i) out[i] = gradient(Eigen::VectorXd::Unit(values, i));
  } else {  // the weights D (D'D)^-1 e_j give the gradient of the j-th coefficient
    const Eigen::MatrixXd d = basis.directions.cast<double>();
    const Eigen::MatrixXd weights = d * inverse_symmetric(d.transpose() * d);
    Eigen::VectorXd coefficients(d.cols());
    for (Eigen::Index j = 0; j < d.cols(); ++j) coefficients[j] = gradient(weights.col(j));
    out = d * coefficients;
  }
  return {out.begin(), out.end()};
}

/// Points beyond the bounds are refused, because the surrogate has no training data there.
void expect_within(const ModelShape& shape, const std::vector<double>& theta) {
  for (std::size_t k = 0; k < theta.size(); ++k)
    if (const auto& p = shape.parameters[k]; theta[k] < p.min || theta[k] > p.max)
      throw InputError(
          {.problem = "the surrogate is valid within its bounds only", .key = p.name, .value = number_text(theta[k]), .range = Range{p.min, p.max}.text()});
}

/// Errors: InputError if the summary does not exist, or is not of this case; the seed does not matter.
void expect_of_case(const std::filesystem::path& summary, Provenance now) {
  if (!std::filesystem::exists(summary)) throw InputError({.problem = "is missing, so the case of the surrogate is unknown", .file = summary.string()});
  now.seed = read_json(summary).value(Json::json_pointer("/provenance/seed"), now.seed);
  (void)reusable(summary, now);
}

/// The surrogate in --out where it is this case's. Another is left out with a message.
std::optional<ServedModel> served_surrogate(StudyInputs& inputs) {
  const auto file = inputs.artefact("surrogate.nc");
  if (!std::filesystem::exists(file)) return std::nullopt;
  try {
    expect_of_case(inputs.artefact("campaign.json"), campaign_provenance(inputs));
    expect_of_case(inputs.artefact("train.json"), train_provenance(inputs));
  } catch (const InputError& e) {
    inputs.notes().warn({fmt::format("the surrogate in {} is not offered: {}", inputs.command().out.string(), e.what())});
    return std::nullopt;
  }
  const std::shared_ptr<const Surrogate> surrogate = load_surrogate(file);
  ServedModel out = described("surrogate", surrogate->shape());
  out.evaluate = [surrogate](const Blocks& input, const Json& config) {
    expect_no_config(config);
    expect_within(surrogate->shape(), input[0]);
    return Blocks{answer_of(surrogate->evaluate(input[0]))};
  };
  if (!surrogate->has_gradient()) return out;
  out.gradient = [surrogate](const Blocks& input, std::size_t, std::size_t, const std::vector<double>& sens, const Json& config) {
    expect_no_config(config);
    expect_within(surrogate->shape(), input[0]);
    const Eigen::VectorXd g = surrogate->vector_jacobian_product(input[0], sens);
    return std::vector<double>(g.begin(), g.end());
  };
  out.apply_jacobian = [surrogate](const Blocks& input, std::size_t, std::size_t, const std::vector<double>& vec, const Json& config) {
    expect_no_config(config);
    expect_within(surrogate->shape(), input[0]);
    return jacobian_action(*surrogate, input[0], vec);
  };
  return out;
}

}  // namespace

ExitStatus serve_stage(StageCall& call) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  std::vector<ServedModel> models{served(inputs)};
  if (auto surrogate = served_surrogate(inputs)) models.push_back(std::move(*surrogate));
  std::vector<std::string> names;
  for (const auto& m : models) names.push_back(fmt::format("{} ({} -> {})", m.name, m.input_sizes[0], m.output_sizes[0]));
  UmbridgeServer server(std::move(models), {.host = command.host, .port = command.port, .threads = command.threads});
  inputs.notes().say(fmt::format("serve: {} at http://{}:{}, {} at a time; stop with Ctrl-C", join(names),
                                 command.host.find(':') == std::string::npos ? command.host : '[' + command.host + ']', server.port(), command.threads));
  server.run(stop_requested());
  inputs.notes().say(fmt::format("serve: stopped after {} requests", server.answered()));
  return ExitStatus::done;
}

}  // namespace calomel
