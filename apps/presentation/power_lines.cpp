#include "apps/presentation/power_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace calomel {

namespace {

std::string why_not(const Detectable& d) {
  return d.limited_by.empty() ? "it does not show enough" : "the records would not distinguish it from " + d.limited_by;
}

std::string detectable_line(const Detectable& d) {
  const std::string what = d.place.empty() ? d.number : d.number + " (" + d.place + ")";
  if (d.from) return fmt::format("power: {} could be named from {:.3g} on (off at {:.3g}, range to {:.3g})", what, *d.from, d.off, d.farthest);
  return fmt::format("power: {} could not be named up to {:.3g}: {}", what, d.farthest, why_not(d));
}

/// One number of one gauge alone, over the gauges.
std::string gauges_line(const std::vector<const Detectable*>& all) {
  const auto& first = **std::min_element(all.begin(), all.end(), [](const auto* a, const auto* b) { return a->share < b->share; });
  const auto& last = **std::max_element(all.begin(), all.end(), [](const auto* a, const auto* b) { return a->share < b->share; });
  const auto named = std::count_if(all.begin(), all.end(), [](const auto* d) { return d->from.has_value(); });
  const std::string head = fmt::format("power: {} of one gauge could be named at {} of {} gauges", first.number, named, all.size());
  if (named == 0) return fmt::format("{} up to {:.3g}: {}", head, first.farthest, why_not(first));
  if (named < std::ptrdiff_t(all.size()))
    return fmt::format("{}, from {:.3g} on at {} (off at {:.3g}, range to {:.3g})", head, *first.from, first.place, first.off, first.farthest);
  return fmt::format("{}, from {:.3g} on at {}, {:.3g} at {} (off at {:.3g}, range to {:.3g})", head, *first.from, first.place, *last.from, last.place,
                     first.off, first.farthest);
}

}  // namespace

std::vector<std::string> power_lines(const std::vector<PlanPower>& plans) {
  std::vector<std::string> lines;
  const PlanPower& first = plans.at(0);
  std::vector<std::string> done;
  for (const auto& d : first.numbers) {
    if (!d.of_gauge) lines.push_back(detectable_line(d));
    if (!d.of_gauge || std::find(done.begin(), done.end(), d.number) != done.end()) continue;
    std::vector<const Detectable*> gauges;
    for (const auto& g : first.numbers)
      if (g.number == d.number) gauges.push_back(&g);
    lines.push_back(gauges_line(gauges));
    done.push_back(d.number);
  }
  const auto named = [](const PlanPower& p) { return std::count_if(p.numbers.begin(), p.numbers.end(), [](const auto& d) { return d.from.has_value(); }); };
  lines.push_back(fmt::format("power: {}: {} of {} numbers could be named within their ranges", first.plan.name, named(first), first.numbers.size()));
  for (std::size_t k = 1; k < plans.size(); ++k)
    lines.push_back(fmt::format("power: {}: {} of {}, strengths needed {:.2g} times those as planned (geometric mean)", plans[k].plan.name, named(plans[k]),
                                plans[k].numbers.size(), std::exp(-plans[k].gain)));
  return lines;
}

}  // namespace calomel
