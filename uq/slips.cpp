#include "uq/slips.hpp"

#include "inverse/posterior/pulls.hpp"
#include "uq/diagnosis/mixed_up.hpp"
#include "uq/diagnosis/plain_words.hpp"

namespace calomel {

std::vector<std::string> slips(const PosteriorInputs& in, const PosteriorFit& fit) {
  std::vector<std::string> told;
  for (const auto& m : mixed_up(in.problem, fit)) told.push_back(plain_mixed_up(m));
  if (!told.empty()) return told;
  if (const auto late = late_records(in.problem, fit)) told.push_back(plain_late(*late) + " Physics that was left out may look so, too: ask calomel diagnose.");
  for (auto& pulled : far_pulls(pulls(fit), in.errors)) told.push_back(std::move(pulled));
  return told;
}

}  // namespace calomel
