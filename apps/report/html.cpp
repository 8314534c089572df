#include "apps/report/html.hpp"

#include <fmt/format.h>

namespace calomel {

std::string case_argument(const ReportInput& input) { return input.case_file.empty() ? "CASE.toml" : input.case_file; }

std::string command(const ReportInput& input, const std::string& verb, const std::string& more) {
  return "<code>calomel " + verb + " " + escape_html(case_argument(input)) + (more.empty() ? "" : " " + more) + "</code>";
}

std::string missing(const std::string& what, const std::string& how) { return "<p class=\"missing\">" + what + (how.empty() ? "" : " " + how) + "</p>\n"; }

std::string plot(const std::string& id, const std::string& caption, const std::string& label) {
  return fmt::format("<figure><div class=\"plot\" id=\"{}\" role=\"img\" aria-label=\"{}\"></div><figcaption>{}</figcaption></figure>\n", id,
                     escape_html(label), caption);
}

std::string folded(const std::string& title, const Table& table) {
  return table.empty() ? "" : "<details><summary>" + escape_html(title) + "</summary>" + table.html() + "</details>\n";
}

}  // namespace calomel
