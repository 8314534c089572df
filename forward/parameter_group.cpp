#include "forward/parameter_group.hpp"

#include "base/errors.hpp"

namespace calomel {

void set_added(std::map<std::string, double>& numbers, std::span<const double> values, std::span<const AddedParameter> added) {
  expect(values.size() == added.size(), "one value for each number that is added");
  for (std::size_t k = 0; k < added.size(); ++k) {
    if (values[k] == *added[k].parameter.nominal) continue;
    const AddedParameter& a = added[k];
    const auto of_run = numbers.find(a.share_of);
    const double whole = of_run == numbers.end() ? a.whole : of_run->second;
    numbers[a.parameter.key] = a.inverse ? 1 / values[k] : whole * values[k];
    for (const auto& [key, number] : added[k].with) numbers[key] = number;
  }
}

}  // namespace calomel
