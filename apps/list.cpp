#include <fmt/format.h>

#include <iostream>

#include "apps/verbs.hpp"
#include "forward/campaign/design.hpp"
#include "forward/line/line_mechanism.hpp"
#include "forward/material/riemer.hpp"
#include "forward/mechanism/mechanism.hpp"
#include "forward/solver/load.hpp"
#include "forward/surrogate/emulator.hpp"
#include "inverse/objective/objective.hpp"
#include "inverse/optimizer/optimizer.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel {

namespace {

template <class Entry>
void print(const std::string& title, const Registry<Entry>& catalogue) {
  std::size_t width = 0;
  for (const auto& row : catalogue.rows()) width = std::max(width, row.name.size());
  std::cout << title << '\n';
  for (const auto& row : catalogue.rows()) std::cout << fmt::format("  {:<{}}  {}\n", row.name, width, row.summary);
}

}  // namespace

ExitStatus run_list(const CommandLine&) {
  print("laws of the liquid ([material.mercury] law)", liquid_laws());
  print("loads ([load] kind)", loads());
  print("mechanisms ([mechanism.NAME])", mechanisms());
  print("mechanisms of a bar ([model] kind = \"line\", [line] kind = \"bar\")", bar_mechanisms());
  print("mechanisms of a pipe ([line] kind = \"pipe\")", pipe_mechanisms());
  print("designs ([campaign] design)", designs());
  print("surrogates ([surrogate] kind)", surrogate_kinds());
  print("objectives ([enc], [spe] objective)", objectives());
  print("optimisers ([enc] optimizers)", optimizers());
  print("samplers ([sampler] kind)", samplers());
  return ExitStatus::done;
}

}  // namespace calomel
