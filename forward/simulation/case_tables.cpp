#include "forward/simulation/case_tables.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace calomel {

void TimeOptions::validate() const {
  const double ratio = end / output_interval;
  if (ratio < 0.999999)
    throw InputError({.problem = fmt::format("no sample would lie before the end, end = {} s", number_text(end)),
                      .key = "output_interval",
                      .value = number_text(output_interval),
                      .range = "<= " + number_text(end)});
  if (ratio > 5e6 || std::abs(ratio - std::round(ratio)) > 1e-6 * ratio)
    throw InputError({.problem = fmt::format("the end must be a multiple of output_interval = {} s (1 to 5 million samples)", number_text(output_interval)),
                      .key = "end",
                      .value = number_text(end),
                      .suggestion = fmt::format("e.g. end = {:.12g}", std::max(1.0, std::round(ratio)) * output_interval)});
}

}  // namespace calomel
