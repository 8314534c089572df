#include "forward/mechanism/added_number.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace calomel {

namespace {

constexpr double first_part = 0.25;      ///< of a key's range: where its effect is first looked at
constexpr double beyond = 2;             ///< how far a number may go, in its range on that side
constexpr double least_infinite = 0.01;  ///< of the upper end of its range: the least value of a key that is infinite where it is off

}  // namespace

AddedParameter added_number(const std::string& mechanism, const MechanismKey& k, double off, double whole) {
  AddedParameter a;
  Parameter& p = a.parameter;
  p.name = mechanism + '.' + k.name;
  p.key = "mechanism." + p.name;
  a.unit = k.unit;
  a.doc = k.doc;
  if (!k.shows_below.empty()) {
    a.share_of = k.shows_below;
    a.whole = whole;
    p.nominal = 1;
    p.min = 0;
    p.max = 1;
    a.strengths = {0};
    return a;
  }
  if (off == -std::numeric_limits<double>::infinity()) {  // a pressure that nothing falls below: at the middle of its range it acts as it can
    a.inverse = true;
    p.nominal = 0;
    p.min = 1 / k.high;
    p.max = 0;
    a.strengths = {2 / (k.low + k.high)};
    return a;
  }
  if (!std::isfinite(off)) {
    a.inverse = true;
    p.nominal = 0;
    p.min = 0;
    p.max = 1 / std::max(k.low, least_infinite * k.high);
    a.strengths = {first_part * p.max};
    return a;
  }
  p.nominal = off;
  p.min = std::min(off, k.low);
  p.max = std::max(off, k.high);
  if (k.log_uniform && off < k.low) {
    const double ratio = std::log(k.high / k.low);
    p.prior = "half_cauchy";
    p.scale = std::sqrt(k.low * k.high);
    for (const double part : {0.25, 0.5, 0.75}) a.strengths.push_back(k.low * std::exp(part * ratio));
    return a;
  }
  const double up = p.max - off, down = off - p.min;
  if (up > 0) a.strengths.push_back(off + first_part * up);
  if (down > 0) a.strengths.push_back(off - first_part * down);
  // The range is two standard deviations, of the wider side. A fit may leave it: a bound where the range ends would hold the number there, and its error too
  // small.
  p.prior = "truncated_normal";
  p.mean = off;
  p.sd = 0.5 * std::max(up, down);
  p.max = std::min(k.greatest, off + beyond * up);
  p.min = std::max(k.least, off - beyond * down);
  return a;
}

}  // namespace calomel
