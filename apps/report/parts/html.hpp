#pragma once
/// HTML that escapes by itself. Text becomes HTML only through the constructor of Html, which escapes it.
#include <concepts>
#include <string>
#include <string_view>
#include <vector>

namespace calomel {

class Html;
/// Markup without escaping. It is for the embedded template, styles and scripts alone.
Html trusted_html(std::string markup);

/// A piece of HTML. It comes from text, which is escaped, from element(), from fragment(), or from trusted_html().
class Html {
 public:
  Html() = default;
  /// The text with & < > " ' replaced by entities.
  template <std::convertible_to<std::string_view> Text>
  Html(const Text& text) : markup_(escaped(text)) {}

  Html& operator+=(const Html& more);
  [[nodiscard]] bool empty() const { return markup_.empty(); }
  /// The markup.
  [[nodiscard]] const std::string& str() const { return markup_; }

 private:
  static std::string escaped(std::string_view text);
  friend Html trusted_html(std::string markup);
  std::string markup_;
};

Html operator+(Html first, const Html& second);

/// The parts one after another. A part is Html or text.
template <std::convertible_to<Html>... Parts>
Html fragment(const Parts&... parts) {
  Html all;
  ((all += parts), ...);
  return all;
}

/// The items with `separator` between them.
Html joined(const std::vector<Html>& items, const Html& separator);

/// An attribute of an element; its value is escaped.
struct HtmlAttribute {
  std::string name;
  std::string value;
};
using HtmlAttributes = std::vector<HtmlAttribute>;

/// The element `name` about `content`. Errors: contract failure for a name of other characters than letters, digits and -.
Html enclosed(std::string_view name, const HtmlAttributes& attributes, const Html& content);

/// The element `name` about its parts: element("td", {{"class", "text"}}, "a < b").
template <std::convertible_to<Html>... Parts>
Html element(std::string_view name, const HtmlAttributes& attributes, const Parts&... parts) {
  return enclosed(name, attributes, fragment(parts...));
}
/// The same without attributes.
template <std::convertible_to<Html>... Parts>
Html element(std::string_view name, const Parts&... parts) {
  return enclosed(name, {}, fragment(parts...));
}

}  // namespace calomel
