#include "apps/pipeline/sample_parts.hpp"

#include <cmath>

#include "apps/presentation/posterior_lines.hpp"
#include "inverse/posterior/prior.hpp"

namespace calomel {

namespace {

constexpr double alarming = 2;  ///< prior standard deviations from the handbook beyond which something else is taken to be missing

}  // namespace

std::vector<std::string> absorption(const std::vector<Parameter>& parameters, const Convergence& convergence) {
  std::vector<std::string> out;
  for (const auto& p : parameters)
    for (const auto& s : convergence.parameters) {
      if (s.name != p.name) continue;
      const auto z = prior_deviation(p, p.prior == "lognormal" ? s.q50 : s.mean);
      if (z && std::abs(*z) > alarming) out.push_back(absorption_sentence(p.name, *z));
    }
  return out;
}

Convergence assessed(const SamplerResult& result, int thin) { return assess(result.quantities, sampling_facts(result, thin)); }

}  // namespace calomel
