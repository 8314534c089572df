#pragma once
/// JSON values. Headers name `Json` through options.hpp; the files that make, read or copy one include this.
#include <nlohmann/json.hpp>

#include "base/options.hpp"

namespace calomel {

/// The options as a JSON object, in the order of their fields.
template <class O>
Json echo(const O& options) {
  Json object = Json::object();
  EchoVisitor v(object);
  const_cast<O&>(options).visit(v);  // a visit that only reads
  return object;
}

}  // namespace calomel
