#pragma once
/// `[model]` of a kind of model that needs no more than its name.
#include <string>

#include "base/options.hpp"

namespace calomel {

struct ModelOptions {
  std::string kind = "built_in";
  template <class V>
  void visit(V& v) {
    v("kind", kind,
      {.doc = "built_in: the explicit solver on a mesh; line: waves along a bar or a pipe, [line]; umbridge: an external model behind HTTP"});
  }
};

}  // namespace calomel
