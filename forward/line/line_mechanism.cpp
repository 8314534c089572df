#include "forward/line/line_mechanism.hpp"

#include <algorithm>

namespace calomel {

bool LineMechanism::off() const {
  return std::all_of(entry->keys.begin(), entry->keys.end(), [&](const MechanismKey& k) {
    if (!k.decides) return true;
    if (values[k.name] != k.off) return false;
    return std::all_of(values.by_sensor().begin(), values.by_sensor().end(),
                       [&](const auto& own) { return !own.first.ends_with('.' + k.name) || own.second == k.off; });
  });
}

std::vector<LineMechanism> read_line_mechanisms(CaseFile& file, const Registry<LineMechanismEntry>& catalogue, std::span<const std::string> stations) {
  std::vector<LineMechanism> all;
  for (const auto& row : catalogue.rows()) all.push_back({row.name, &row.entry, MechanismValues(row.entry.keys)});
  file.accept("mechanism");
  for (const auto& name : file.names("mechanism")) {
    file.locating([&] {
      try {
        (void)catalogue.get(name, "mechanism." + name);
      } catch (const InputError& e) {
        auto parts = e.parts();
        parts.value.clear();
        throw InputError(parts);
      }
    });
    auto& m = *std::find_if(all.begin(), all.end(), [&](const auto& each) { return each.name == name; });
    auto table = read_mechanism_table(file, name, m.entry->keys, m.entry->per_station, stations);
    m.listed = true;
    m.enabled = table.enabled;
    m.values = std::move(table.values);
    if (m.enabled) continue;
    for (const auto& k : m.entry->keys)  // offered, not part of the model: deciding keys have their off values, the others those of the table
      if (k.decides) {
        *m.values.find(k.name) = k.off;
        for (const auto& station : stations) m.values.forget(station + '.' + k.name);
      }
  }
  return all;
}

}  // namespace calomel
