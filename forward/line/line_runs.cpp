#include "forward/line/line_runs.hpp"

namespace calomel {

std::vector<ParameterGroup> offered_groups(const LineModel& model) {
  std::vector<ParameterGroup> groups;
  for (const auto& m : model.offered()) {
    ParameterGroup g{.name = m.name, .by_sensor = m.per_station && model.shape().sensors.size() > 1, .plain = m.plain, .check = m.check};
    for (const auto& k : m.keys)
      if (k.decides) g.added.push_back(added_number(m.name, k, k.off));
    groups.push_back(std::move(g));
  }
  return groups;
}

}  // namespace calomel
