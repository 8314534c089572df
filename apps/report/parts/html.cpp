#include "apps/report/parts/html.hpp"

#include <algorithm>
#include <cctype>
#include <utility>

#include "base/errors.hpp"

namespace calomel {

namespace {

std::string_view entity(char c) {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    case '\'':
      return "&#39;";
    default:
      return {};
  }
}

bool is_name(std::string_view name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '-'; });
}

}  // namespace

std::string Html::escaped(std::string_view text) {
  std::string markup;
  markup.reserve(text.size());
  for (const char c : text) {
    const auto replacement = entity(c);
    if (replacement.empty())
      markup += c;
    else
      markup += replacement;
  }
  return markup;
}

Html& Html::operator+=(const Html& more) {
  markup_ += more.markup_;
  return *this;
}

Html operator+(Html first, const Html& second) {
  first += second;
  return first;
}

Html trusted_html(std::string markup) {
  Html html;
  html.markup_ = std::move(markup);
  return html;
}

Html joined(const std::vector<Html>& items, const Html& separator) {
  Html all;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) all += separator;
    all += items[i];
  }
  return all;
}

Html enclosed(std::string_view name, const HtmlAttributes& attributes, const Html& content) {
  expect(is_name(name), "an element of HTML has a name of letters, digits and -");
  std::string markup("<");
  markup += name;
  for (const auto& a : attributes) {
    expect(is_name(a.name), "an attribute of HTML has a name of letters, digits and -");
    markup.append(" ").append(a.name).append("=\"").append(Html(a.value).str()).append("\"");
  }
  markup.append(">").append(content.str()).append("</").append(name).append(">");
  return trusted_html(std::move(markup));
}

}  // namespace calomel
