#include <set>

#include "forward/surrogate/trained_map.hpp"
#include "forward/surrogate/mode_gaussian_process.hpp"
#include "forward/surrogate/mode_network.hpp"
#include "forward/surrogate/published_network.hpp"

namespace calomel {

Registry<SurrogateKind> surrogate_kinds() {
  Registry<SurrogateKind> kinds("surrogate");
  kinds.add("network", "the published feedforward network from parameters to every sample of every sensor",
            {&PublishedNetwork::train, &PublishedNetwork::load});
  kinds.add("mode_network", "small smooth networks from parameters to the proper orthogonal modes of the histories", {&ModeNetwork::train, &ModeNetwork::load});
  kinds.add("mode_gaussian_process", "a Gaussian process for each proper orthogonal mode; gives a predictive variance",
            {&ModeGaussianProcess::train, &ModeGaussianProcess::load});
  return kinds;
}

void SurrogateOptions::validate() const {
  const auto kinds = surrogate_kinds();
  (void)kinds.get(kind, "kind");
  std::set<std::string> seen{kind};
  for (const auto& k : compare) {
    (void)kinds.get(k, "compare");
    if (k != kind && !seen.insert(k).second)
      throw InputError({.problem = "a kind is listed twice", .key = "compare", .value = '"' + k + '"', .suggestion = "list every kind once"});
  }
}

}  // namespace calomel
