#include "forward/simulation/run_request.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstdlib>
#include <sstream>
#include <utility>
#include <vector>

namespace calomel {

namespace {

/// Words of the text that are no dotted keys of the case.
constexpr const char* mesh_word = "mesh";
constexpr const char* pulses_word = "pulses";
constexpr const char* shift_word = "energy_shift";
constexpr const char* viscosity_word = "viscosity_factor";
constexpr const char* jitter_word = "jitter";
constexpr const char* refine_word = "refine";
constexpr const char* precision_word = "precision";
constexpr const char* want_word = "want";

constexpr std::array<std::pair<const char*, bool Outputs::*>, 4> output_words{
    {{"mean", &Outputs::mean}, {"pulses", &Outputs::pulses}, {"energy_balance", &Outputs::energy_balance}, {"totals", &Outputs::totals}}};

double number_of(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  expect(!text.empty() && *end == '\0', "a value in a run's text is a number");
  return value;
}

template <class Integer>
Integer integer_of(const std::string& text) {
  Integer value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  expect(error == std::errc() && end == text.data() + text.size(), "a count in a run's text is a whole number");
  return value;
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, at);) parts.push_back(part);
  return parts;
}

MeshJitter jitter_of(const std::string& text) {
  const auto parts = split(text, ':');
  expect(parts.size() == 3, "a jitter in a run's text is share:seed:stream");
  return {.share = number_of(parts[0]), .seed = integer_of<std::uint64_t>(parts[1]), .stream = integer_of<std::uint64_t>(parts[2])};
}

Outputs outputs_of(const std::string& text) {
  Outputs out{.mean = false};
  for (const auto& word : split(text, '+')) {
    bool known = false;
    for (const auto& [name, output] : output_words)
      if (word == name) {
        out.*output = true;
        known = true;
      }
    expect(known, "an output in a run's text has a known name");
  }
  return out;
}

}  // namespace

bool Outputs::cover(const Outputs& other) const {
  for (const auto& [name, output] : output_words)
    if (other.*output && !(this->*output)) return false;
  return true;
}

Outputs Outputs::with(const Outputs& other) const {
  Outputs all = *this;
  for (const auto& [name, output] : output_words) all.*output = all.*output || other.*output;
  return all;
}

RunRequest request_at(std::span<const Parameter> parameters, std::span<const double> theta) {
  expect(parameters.size() == theta.size(), "a request has a value for every parameter");
  RunRequest request;
  for (std::size_t k = 0; k < theta.size(); ++k) request.numbers[parameters[k].key] = theta[k];
  expect(request.numbers.size() == theta.size(), "every parameter has a key of its own");
  return request;
}

std::vector<double> theta_at(std::span<const Parameter> parameters, const RunRequest& request) {
  std::vector<double> theta;
  for (const auto& p : parameters) {
    const auto at = request.numbers.find(p.key);
    expect(at != request.numbers.end(), "a request has a value for every parameter");
    theta.push_back(at->second);
  }
  return theta;
}

std::string run_text(const RunRequest& r) {
  std::string text;
  const auto add = [&](const std::string& word, const std::string& value) {
    if (!text.empty()) text += ' ';
    text += word;
    text += '=';
    text += value;
  };
  for (const auto& [key, value] : r.numbers) add(key, number_text(value));
  if (r.element_size) add(mesh_word, number_text(*r.element_size));
  if (r.pulses) add(pulses_word, std::to_string(*r.pulses));
  if (r.energy_shift) add(shift_word, number_text(*r.energy_shift));
  if (r.viscosity_factor != 1) add(viscosity_word, number_text(r.viscosity_factor));
  if (r.jitter) add(jitter_word, number_text(r.jitter->share) + ':' + std::to_string(r.jitter->seed) + ':' + std::to_string(r.jitter->stream));
  if (r.refine != 1) add(refine_word, std::to_string(r.refine));
  if (!r.precision.empty()) add(precision_word, r.precision);
  return text.empty() ? "case" : text;
}

std::string text_of(const RunRequest& request) {
  std::string wanted;
  for (const auto& [name, output] : output_words)
    if (request.wanted.*output) {
      if (!wanted.empty()) wanted += '+';
      wanted += name;
    }
  return fmt::format("{} {}={}", run_text(request), want_word, wanted);
}

RunRequest request_of(const std::string& text) {
  RunRequest request;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (word == "case") continue;
    const auto equals = word.find('=');
    expect(equals != std::string::npos, "a run's text consists of words KEY=VALUE");
    const std::string key = word.substr(0, equals), value = word.substr(equals + 1);
    if (key == mesh_word)
      request.element_size = number_of(value);
    else if (key == pulses_word)
      request.pulses = integer_of<int>(value);
    else if (key == shift_word)
      request.energy_shift = number_of(value);
    else if (key == viscosity_word)
      request.viscosity_factor = number_of(value);
    else if (key == jitter_word)
      request.jitter = jitter_of(value);
    else if (key == refine_word)
      request.refine = integer_of<int>(value);
    else if (key == precision_word)
      request.precision = value;
    else if (key == want_word)
      request.wanted = outputs_of(value);
    else
      request.numbers[key] = number_of(value);
  }
  return request;
}

}  // namespace calomel
