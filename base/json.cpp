#include "base/json.hpp"

#include <cmath>

namespace calomel {

Json number(double x) { return std::isfinite(x) ? Json(x) : Json(); }

Json numbers(std::span<const double> xs) {
  Json j = Json::array();
  for (const double x : xs) j.push_back(number(x));
  return j;
}

Json matrix_json(const Eigen::MatrixXd& m) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < m.cols(); ++j) row.push_back(number(m(i, j)));
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace calomel
