#pragma once
/// The generated pages of docs/verification: table.md and the pictures.
#include "tests/verification/row_file.hpp"

namespace calomel::testing {

/// The table in Markdown, a heading for each item.
std::string table_page(const Record& record);

/// Writes table.md and PICTURE.svg for each picture. Errors: InputError when an item has no row.
void write_pages(const Record& record, const std::filesystem::path& folder);

/// Differences between the committed table and the record: a row too many or too few, or a value that moved by more than a
/// tenth of its tolerance. Where tests could not run, their rows may be missing from the record.
std::vector<std::string> compare(const Record& record, const std::filesystem::path& page);

/// A line plot as SVG: curves named "... (points)" without a line, those named "guide ..." dashed. Axes are logarithmic for the picture "convergence".
std::string picture(const std::string& name, const std::vector<Curve>& curves);

}  // namespace calomel::testing
