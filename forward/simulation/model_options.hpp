#pragma once
/// `[model]` of a kind of model that needs no more than its name.
#include <string>

#include "base/options.hpp"

namespace calomel {

struct ModelOptions {
  std::string kind = "built_in";
  template <class V>
  void visit(V& v) {
    v("kind", kind, {.doc = "kind of the true model, one of the list below"});
  }
};

}  // namespace calomel
