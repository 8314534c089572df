#include "apps/report/parts/lines.hpp"

#include <algorithm>
#include <string>

#include "apps/report/data/json_values.hpp"

namespace calomel {

namespace {

std::string lower_first(std::string text) {
  if (!text.empty() && text[0] >= 'A' && text[0] <= 'Z') text[0] = char(text[0] - 'A' + 'a');
  return text;
}

}  // namespace

Json lines_json(const Table& table, const std::vector<std::size_t>& value_columns) {
  Json lines = Json::array();
  std::vector<std::string> names;
  for (std::size_t variant = 0; variant < value_columns.size(); ++variant) {
    const auto column = value_columns[variant];
    std::string name;
    Json* line = nullptr;
    for (const auto& row : table.rows) {
      const auto* x = std::get_if<double>(&row[1].value);
      const auto* y = std::get_if<double>(&row[column].value);
      if (!x || !y) continue;
      const auto& row_name = std::get<std::string>(row[0].value);
      if (!line || row_name != name) {
        name = row_name;
        const std::string label = value_columns.size() > 1 ? name + ", " + lower_first(table.columns[column].title) : name;
        auto at = std::find(names.begin(), names.end(), name);
        if (at == names.end()) at = names.insert(at, name);
        lines.push_back({{"label", label},
                         {"group", at - names.begin()},
                         {"variant", value_columns.size() > 1 ? variant : std::size_t(at - names.begin())},
                         {"x", Json::array()},
                         {"y", Json::array()}});
        line = &lines.back();
      }
      (*line)["x"].push_back(rounded(*x, 6));
      (*line)["y"].push_back(rounded(*y, 5));
    }
  }
  return lines;
}

}  // namespace calomel
