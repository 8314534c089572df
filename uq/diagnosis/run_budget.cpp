#include "uq/diagnosis/run_budget.hpp"

#include <algorithm>

namespace calomel {

void RunBudget::skip(SkippedStep step) {
  if (std::find(skipped_.begin(), skipped_.end(), step) == skipped_.end()) skipped_.push_back(std::move(step));
}

}  // namespace calomel
