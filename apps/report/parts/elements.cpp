#include "apps/report/parts/elements.hpp"

#include "apps/report/data/json_values.hpp"
#include "apps/report/parts/numbers.hpp"

namespace calomel {

Html heading(const std::string& text) { return element("h3", text) + "\n"; }

Html list_item(const Html& content) { return element("li", content) + "\n"; }

Html link_to(const std::string& section, const std::string& text) { return element("a", {{"href", "#" + section}}, text); }

Html place(const std::string& id, const std::string& kind) {
  HtmlAttributes attributes{{"id", id}};
  if (!kind.empty()) attributes.push_back({"class", kind});
  return element("div", attributes);
}

std::string case_argument(const ReportInput& input) { return input.case_file.empty() ? "CASE.toml" : input.case_file; }

Html command(const ReportInput& input, const std::string& verb, const std::string& more) {
  return element("code", "calomel " + verb + " " + case_argument(input) + (more.empty() ? "" : " " + more));
}

Html missing(const Html& what, const Html& how) { return paragraph_of("missing", what, how.empty() ? Html() : " " + how); }

Html no_calibration(const ReportInput& input, const std::string& lead) {
  return missing(lead,
                 fragment("There is no calibration yet (enc.json, spe.json or map.json). Make one with ", command(input, "calibrate", "--method enc"), "."));
}

Html plot(const std::string& id, const Html& caption, const std::string& label) {
  const Html drawing = element("div", {{"class", "plot"}, {"id", id}, {"role", "img"}, {"aria-label", label}});
  return element("figure", drawing, element("figcaption", caption)) + "\n";
}

Html folded(const std::string& title, const Table& table) {
  return table.empty() ? Html() : element("details", element("summary", title), table.html()) + "\n";
}

Html folded_text(const std::string& title, const std::string& text) { return element("details", element("summary", title), element("pre", text)) + "\n"; }

Html count_at(const Json& json, const std::string& key) {
  const auto x = number_at(json, key);
  return x ? number_html(*x, 6) : "an unknown number of";
}

}  // namespace calomel
