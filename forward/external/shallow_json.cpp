#include "forward/external/shallow_json.hpp"

#include <algorithm>

namespace calomel {

namespace {

/// Brackets within one another, those in strings left out.
int depth_of(const std::string& text) {
  int depth = 0, deepest = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      quoted = c != '"';
    } else if (c == '"') {
      quoted = true;
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return deepest;
}

}  // namespace

Json shallow_json(const std::string& text) { return depth_of(text) > deepest_json ? Json(Json::value_t::discarded) : Json::parse(text, nullptr, false); }

}  // namespace calomel
