#include "uq/diagnosis/alternative.hpp"

#include <algorithm>
#include <cmath>

namespace calomel {

namespace {

const AddedParameter* first_of(std::vector<AddedParameter> ParameterGroup::*numbers, const Alternative& a, const Estimate& number,
                               std::span<const ParameterGroup> groups) {
  const std::string name = a.sensor.empty() ? number.name : number.name.substr(a.sensor.size() + 1);  // behind the gauge's name
  for (const auto& g : groups)
    for (const auto& p : g.*numbers)
      if (p.parameter.name == name) return &p;
  return nullptr;
}

}  // namespace

Alternative unfitted_alternative(const ParameterGroup& group, const ScreenedCandidate& screened, const Alternative* on_top_of) {
  Alternative a{.groups = {group.name},
                .places = {{group.name, group.place}},
                .first_order_log_bayes_factor = screened.first_order.log_bayes_factor,
                .selection_penalty = screened.selection_penalty,
                .p_value = screened.p_value};
  a.explanation.numerical = group.numerical;
  a.explanation.of_two = on_top_of != nullptr;
  if (on_top_of) {
    a.groups.insert(a.groups.end(), on_top_of->groups.begin(), on_top_of->groups.end());
    std::sort(a.groups.begin(), a.groups.end());
    a.selection_penalty += on_top_of->selection_penalty;
    a.first_order_log_bayes_factor += on_top_of->explanation.log_bayes_factor;
    a.places.insert(on_top_of->places.begin(), on_top_of->places.end());
  }
  for (const auto& name : a.groups) a.explanation.name += (a.explanation.name.empty() ? "" : "+") + name;
  return a;
}

const AddedParameter* added_parameter_of(const Alternative& a, const Estimate& number, std::span<const ParameterGroup> groups) {
  return first_of(&ParameterGroup::added, a, number, groups);
}

const AddedParameter* shape_of(const Alternative& a, const Estimate& number, std::span<const ParameterGroup> groups) {
  return first_of(&ParameterGroup::shapes, a, number, groups);
}

double deviations_from_off(const Alternative& a, const Estimate& number, std::span<const ParameterGroup> groups) {
  const AddedParameter* added = added_parameter_of(a, number, groups);
  if (!added || !(number.sd > 0)) return 0;
  return std::abs(number.mean - added->whole * added->parameter.nominal.value_or(0)) / number.sd;
}

}  // namespace calomel
