#include "forward/parameter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>

#include "base/json.hpp"

namespace calomel {

void Parameter::validate() const {
  if (!(max > min))
    throw InputError({.problem = "the upper bound must exceed the lower one, min = " + number_text(min),
                      .key = "max",
                      .value = number_text(max),
                      .range = "> " + number_text(min)});
  const auto within = [](const char* word, double x, Range range, const std::string& what) {
    if (!range.contains(x))
      throw InputError({.problem = what + " lies outside the parameter's bounds", .key = word, .value = number_text(x), .range = range.text()});
  };
  if (nominal && (*nominal < min || *nominal > max))
    throw InputError(
        {.problem = "the nominal value lies outside the bounds", .key = "nominal", .value = number_text(*nominal), .range = Range{min, max}.text()});
  const auto need = [&](const char* word, const std::optional<double>& value) {
    if (!value)
      throw InputError({.problem = "a " + prior + " prior needs \"" + word + "\"",
                        .key = "prior",
                        .value = '"' + prior + '"',
                        .suggestion = std::string("add ") + word + " = ..."});
  };
  if (prior == "normal" || prior == "truncated_normal") need("mean", mean), need("sd", sd);
  if (prior == "lognormal") need("mu", mu), need("sigma", sigma);
  if (prior == "normal") within("mean", *mean, {min, max}, "the prior's mean");
  if (prior == "lognormal" && max > 0)
    within("mu", *mu, {min > 0 ? std::log(min) : -std::numeric_limits<double>::infinity(), std::log(max)},
           fmt::format("the prior's median, exp(mu) = {:.4g},", std::exp(*mu)));
  if (prior == "half_cauchy") need("scale", scale);
  if (prior == "beta") need("alpha", alpha), need("beta", beta);
}

std::vector<Parameter> read_parameters(CaseFile& file, const std::string& table) {
  std::vector<Parameter> all;
  for (const auto& name : file.names("parameter")) {
    const bool taken = name == "chain" || name == "draw" || name == "beyond";
    if (taken || name.empty() || !std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; }))
      throw file.located(InputError({.problem = taken ? "posterior.nc calls something else so" : "a parameter's name has letters, digits, _ and - alone",
                                     .key = "parameter",
                                     .value = '"' + name + '"',
                                     .suggestion = "take another name"}));
    Parameter p;
    p.name = name;
    p.key = table + '.' + name;
    file.read("parameter." + name, p);
    if (const auto same = std::ranges::find(all, p.key, &Parameter::key); same != all.end())
      throw file.located(InputError({.problem = "this number is the parameter " + same->name + " already",
                                     .key = "parameter." + name + (file.has("parameter." + name + ".key") ? ".key" : ""),
                                     .value = '"' + p.key + '"',
                                     .suggestion = "take one of the two out, or give it another key"}));
    all.push_back(std::move(p));
  }
  return all;
}

void bind_parameters(CaseFile& file, std::vector<Parameter>& parameters, const std::function<double(const Parameter&)>& number) {
  for (auto& p : parameters)
    file.locating([&] {
      const std::string table = "parameter." + p.name;
      try {
        const double value = number(p);
        if (!p.nominal && p.max > p.min && (value < p.min || value > p.max))
          throw file.located(InputError(
              {.problem = fmt::format("the case's own value lies outside the bounds of [{}]", table),
               .key = file.has(p.key) ? p.key : table,
               .value = number_text(value),
               .range = Range{p.min, p.max}.text(),
               .suggestion = file.has(p.key)
                                 ? ""
                                 : fmt::format("{} is {} where the case does not set it; give nominal a value within the bounds", p.key, number_text(value))}));
        if (!p.nominal) p.nominal = value;
        p.validate();
      } catch (const InputError& e) {
        auto parts = e.parts();
        if (!parts.file.empty()) throw;
        parts.key = parts.key.empty() ? table + (file.has(table + ".key") ? ".key" : "") : table + '.' + parts.key;
        throw InputError(parts);
      }
    });
}

Json named(std::span<const Parameter> parameters, std::span<const double> theta) {
  expect(theta.size() <= parameters.size(), "a value has the name of a parameter");
  Json j = Json::object();
  for (std::size_t k = 0; k < theta.size(); ++k) j[parameters[k].name] = theta[k];
  return j;
}

}  // namespace calomel
