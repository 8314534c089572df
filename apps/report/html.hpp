#pragma once
/// Pieces of the page that several sections are made of.
#include <string>

#include "apps/report/report.hpp"
#include "apps/report/table.hpp"

namespace calomel {

inline constexpr double percent = 100;

std::string case_argument(const ReportInput& input);
/// The command that runs a verb on the case, with further words.
std::string command(const ReportInput& input, const std::string& verb, const std::string& more = "");
/// What is not there, and how it comes about. HTML.
std::string missing(const std::string& what, const std::string& how = "");
/// A place for a script to draw in. caption: HTML.
std::string plot(const std::string& id, const std::string& caption, const std::string& label);
/// A table that is shown when its title is clicked; nothing where it is empty.
std::string folded(const std::string& title, const Table& table);

}  // namespace calomel
