#include <fmt/format.h>

#include <iostream>

#include "apps/verbs.hpp"
#include "forward/campaign/design.hpp"
#include "forward/simulation/simulator_kinds.hpp"
#include "forward/surrogate/trained_map.hpp"
#include "inverse/objective/objective.hpp"
#include "inverse/optimizer/optimizer.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel {

namespace {

void print(const std::string& title, const std::vector<std::pair<std::string, std::string>>& entries) {
  std::size_t width = 0;
  for (const auto& [name, summary] : entries) width = std::max(width, name.size());
  std::cout << title << '\n';
  for (const auto& [name, summary] : entries) std::cout << fmt::format("  {:<{}}  {}\n", name, width, summary);
}

template <class Entry>
void print(const std::string& title, const Registry<Entry>& registry) {
  print(title, catalogue_of(title, registry).entries);
}

}  // namespace

ExitStatus run_list(const CommandLine&) {
  for (const auto& kind : simulator_kinds().rows())
    for (const auto& c : kind.entry.catalogues()) print(c.title, c.entries);
  print("kinds of model ([model] kind)", simulator_kinds());
  print("designs ([campaign] design)", designs());
  print("surrogates ([surrogate] kind)", surrogate_kinds());
  print("objectives ([enc], [spe] objective)", objectives());
  print("optimisers ([enc] optimizers)", optimizers());
  print("samplers ([sampler] kind)", samplers());
  return ExitStatus::done;
}

}  // namespace calomel
