#pragma once
/// JSON values. Headers name `Json` through options.hpp; the files that make, read or copy one include this.
#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <span>

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

/// JSON of finite numbers; null for the others.
Json number(double x);
Json numbers(std::span<const double> xs);
/// Rows of numbers.
Json matrix_json(const Eigen::MatrixXd& m);

}  // namespace calomel
