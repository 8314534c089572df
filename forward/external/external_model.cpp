#include "forward/external/external_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "base/errors.hpp"

namespace calomel {

namespace {

std::string text_of(std::span<const std::size_t> sizes) {
  std::string out;
  for (const auto n : sizes) out += (out.empty() ? "" : ", ") + std::to_string(n);
  return '[' + out + ']';
}

}  // namespace

ModelShape shape_of(const ExternalCase& c) {
  ModelShape shape;
  shape.parameters = c.parameters;
  shape.conditions = {"default"};
  shape.sensors = c.output.sensors;
  shape.unit = c.unit;
  for (int k = 0; k < c.time.count; ++k) shape.times.push_back(c.time.start + k * c.time.step);
  return shape;
}

ExternalModel::ExternalModel(ExternalCase external) : case_(std::move(external)), client_(case_.server) {
  const auto& server = case_.server;
  const auto models = client_.models();
  if (std::find(models.begin(), models.end(), server.name) == models.end()) {
    std::string known;
    for (std::size_t i = 0; i < std::min<std::size_t>(models.size(), 20); ++i) known += (i ? ", " : "") + models[i];
    throw InputError({.problem = "the server has no such model",
                      .key = "model.name",
                      .value = '"' + server.name + '"',
                      .range = models.empty() ? "it lists none" : known,
                      .suggestion = name_suggestion(server.name, models)});
  }
  support_ = client_.support();
  if (!support_.evaluate) throw NumericsError(fmt::format("the model \"{}\" at {} does not support Evaluate", server.name, server.url));
  input_sizes_ = client_.input_sizes();
  output_sizes_ = client_.output_sizes();
  const std::size_t taken = std::accumulate(input_sizes_.begin(), input_sizes_.end(), std::size_t(0));
  if (taken != case_.inputs())
    throw InputError({.problem = fmt::format("the model takes {} numbers in blocks of {}, the case has {} parameters and {} parameters of mechanisms", taken,
                                             text_of(input_sizes_), case_.own, case_.inputs() - case_.own),
                      .key = "parameter",
                      .suggestion = "give one [parameter.NAME] for each number, in the model's order, those of mechanisms last"});
  const std::size_t given = case_.output.sensors.size() * std::size_t(case_.time.count);
  if (output_sizes_.empty() || output_sizes_[0] != given)
    throw InputError(
        {.problem = case_.is_log_density()
                        ? fmt::format("a log density is one number, the model's first output block has {}", output_sizes_.empty() ? 0 : output_sizes_[0])
                        : fmt::format("the model's first output block has {} numbers, {} sensors of {} times are {}",
                                      output_sizes_.empty() ? 0 : output_sizes_[0], case_.output.sensors.size(), case_.time.count, given),
         .key = "output",
         .suggestion = "correct output.sensors or output.time.count"});
  shape_ = shape_of(case_);
  for (std::size_t i = 0; i < case_.own; ++i) place_.push_back(i);
  std::size_t at = case_.own;
  for (const auto& m : case_.mechanisms) {
    for (std::size_t i = 0; i < m.parameters.size() && m.enabled; ++i) place_.push_back(at + i);
    at += m.parameters.size();
  }
}

std::vector<double> ExternalModel::inputs(std::span<const double> theta, const std::map<std::string, double>& numbers) const {
  expect(theta.size() == place_.size(), "one value for each parameter");
  std::vector<double> all(case_.own);
  std::size_t found = 0;
  for (const auto& m : case_.mechanisms)
    for (std::size_t i = 0; i < m.parameters.size(); ++i) {
      const auto number = numbers.find(m.parameters[i].key);
      found += number != numbers.end();
      all.push_back(number != numbers.end() ? number->second : m.off[i]);
    }
  for (const auto& [key, value] : numbers) found += key.starts_with(reading_gain + '.') || key.starts_with(reading_drift + '.');
  if (found != numbers.size()) throw InputError({.problem = "names no input of the external model", .value = '"' + numbers.begin()->first + '"'});
  for (std::size_t k = 0; k < theta.size(); ++k) all[place_[k]] = theta[k];
  return all;
}

Blocks ExternalModel::blocks(const std::vector<double>& all) const {
  Blocks out;
  auto at = all.begin();
  for (const std::size_t n : input_sizes_) {
    out.emplace_back(at, at + std::ptrdiff_t(n));
    at += std::ptrdiff_t(n);
  }
  return out;
}

Prediction ExternalModel::evaluate(std::span<const double> theta, const std::map<std::string, double>& numbers) const {
  auto answer = client_.evaluate(blocks(inputs(theta, numbers)), output_sizes_);
  if (answer.value) {
    auto& y = (*answer.value)[0];
    const std::size_t n = shape_.times.size();
    for (std::size_t s = 0; s < shape_.sensors.size() && !numbers.empty(); ++s) {
      const auto number = [&](const std::string& key, double off) {
        return numbers.contains(key + '.' + shape_.sensors[s]) ? numbers.at(key + '.' + shape_.sensors[s]) : off;
      };
      const double gain = number(reading_gain, 1), drift = number(reading_drift, 0);
      if (gain == 1 && drift == 0) continue;
      for (std::size_t i = 0; i < n; ++i) y[s * n + i] *= gain + (n > 1 ? drift * double(i) / double(n - 1) : 0);
    }
    return {.ok = true, .message = "", .mean = std::move(y)};
  }
  std::string at;
  for (std::size_t k = 0; k < theta.size(); ++k) at += fmt::format("{}{} = {:.6g}", k ? ", " : "", case_.parameters[k].name, theta[k]);
  return {
      .ok = false, .lost = answer.lost, .message = fmt::format("the model \"{}\" at {} {} (at {})", case_.server.name, case_.server.url, answer.message, at)};
}

Eigen::VectorXd ExternalModel::vector_jacobian_product(std::span<const double> theta, std::span<const double> weights) const {
  expect(support_.gradient, "only a server that gives gradients is asked for one");
  const auto input = blocks(inputs(theta, {}));
  std::vector<double> all;
  for (std::size_t b = 0; b < input.size(); ++b) {
    auto answer = client_.gradient(input, 0, b, weights);
    if (!answer.value) throw NumericsError(fmt::format("the model \"{}\" at {} {}", case_.server.name, case_.server.url, answer.message));
    all.insert(all.end(), answer.value->begin(), answer.value->end());
  }
  Eigen::VectorXd out(Eigen::Index(theta.size()));
  for (std::size_t k = 0; k < theta.size(); ++k) out[Eigen::Index(k)] = all[place_[k]];
  return out;
}

}  // namespace calomel
