#include "apps/presentation/power_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace calomel {

namespace {

std::string detectable_line(const Detectable& d) {
  if (d.from) return fmt::format("power: {}: {} could be named from {:.3g} on (off at {:.3g}, range to {:.3g})", d.mechanism, d.number, *d.from, d.off, d.farthest);
  const std::string why = d.limited_by.empty() ? "it does not show enough" : "the records would not tell it from " + d.limited_by;
  return fmt::format("power: {}: {} could not be named up to {:.3g}: {}", d.mechanism, d.number, d.farthest, why);
}

}  // namespace

std::vector<std::string> power_lines(const std::vector<PlanPower>& plans) {
  std::vector<std::string> lines;
  const PlanPower& first = plans.at(0);
  for (const auto& d : first.numbers) lines.push_back(detectable_line(d));
  const auto named = [](const PlanPower& p) { return std::count_if(p.numbers.begin(), p.numbers.end(), [](const auto& d) { return d.from.has_value(); }); };
  lines.push_back(fmt::format("power: {}: {} of {} numbers could be named within their ranges", first.plan.name, named(first), first.numbers.size()));
  for (std::size_t k = 1; k < plans.size(); ++k)
    lines.push_back(fmt::format("power: {}: {} of {}, strengths needed {:.2g} times those as planned (geometric mean)", plans[k].plan.name, named(plans[k]), plans[k].numbers.size(), std::exp(-plans[k].gain)));
  return lines;
}

}  // namespace calomel
