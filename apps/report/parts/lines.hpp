#pragma once
/// Lines of a plot from the columns of a table.
#include <cstddef>
#include <vector>

#include "apps/report/parts/table.hpp"
#include "base/json.hpp"

namespace calomel {

/// [{label, group, variant, x, y}] of a table with the rows (name, x, y, ...): one line for each name and each of the value columns, in the order of the rows.
/// Lines of one group share a colour, lines of one variant share a dash.
Json lines_json(const Table& table, const std::vector<std::size_t>& value_columns);

}  // namespace calomel
