#pragma once
/// Pieces of the page that several sections use.
#include <string>

#include "apps/report/data/report_input.hpp"
#include "apps/report/parts/html.hpp"
#include "apps/report/parts/table.hpp"

namespace calomel {

/// A paragraph on a line of its own.
template <std::convertible_to<Html>... Parts>
Html paragraph(const Parts&... parts) {
  return element("p", parts...) + "\n";
}
/// The same of a class of page.css: "outcome", "note", "missing".
template <std::convertible_to<Html>... Parts>
Html paragraph_of(const std::string& kind, const Parts&... parts) {
  return element("p", {{"class", kind}}, parts...) + "\n";
}
/// Bold text.
template <std::convertible_to<Html>... Parts>
Html strong(const Parts&... parts) {
  return element("strong", parts...);
}
/// A heading within a section.
Html heading(const std::string& text);
/// An item of a list, on a line of its own.
Html list_item(const Html& content);
/// A link to a section.
Html link_to(const std::string& section, const std::string& text);
/// An empty element that a script fills.
Html place(const std::string& id, const std::string& kind = "");

/// The case file in the commands that the page suggests.
std::string case_argument(const ReportInput& input);
/// The command that runs a verb on the case, with further words.
Html command(const ReportInput& input, const std::string& verb, const std::string& more = "");
/// A note that something is missing, and how to make it.
Html missing(const Html& what, const Html& how = {});
/// A note that there is no calibration yet; `lead` names its use.
Html no_calibration(const ReportInput& input, const std::string& lead);
/// A figure that a script draws. `label` describes it to those who do not see it.
Html plot(const std::string& id, const Html& caption, const std::string& label);
/// A table that opens when its title is clicked; empty when the table has no rows.
Html folded(const std::string& title, const Table& table);
/// Text that opens when its title is clicked.
Html folded_text(const std::string& title, const std::string& text);
/// The number at `key` of an artefact, in words when it has none.
Html count_at(const Json& json, const std::string& key);

}  // namespace calomel
