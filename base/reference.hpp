#pragma once
/// The table of one Options type for the reference of the case file.
#include <fmt/format.h>

#include <string>

#include "base/options.hpp"

namespace calomel {

/// A heading, a sentence and a row for every key. prefix: of the keys, as --set takes them.
template <class O>
std::string reference_table(const std::string& heading, const std::string& prefix, const std::string& text, O options = {}) {
  ReferenceVisitor v(prefix + '.');
  options.visit(v);
  return fmt::format("\n## `{}`\n\n{}\n\n| key | unit | default | allowed | meaning |\n|---|---|---|---|---|\n{}", heading, text, v.markdown);
}

}  // namespace calomel
