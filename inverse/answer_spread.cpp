#include "inverse/answer_spread.hpp"

#include "base/json.hpp"
#include "inverse/calibration.hpp"

namespace calomel {

Json matrix_json(const Eigen::MatrixXd& m) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < m.cols(); ++j) row.push_back(number(m(i, j)));
    rows.push_back(std::move(row));
  }
  return rows;
}

Json combinations_json(std::span<const Combination> combinations) {
  Json all = Json::array();
  for (const auto& c : combinations)
    all.push_back({{"name", c.name}, {"value", number(c.value)}, {"low", number(c.low)}, {"high", number(c.high)}, {"relative_sd", number(c.relative_sd)}});
  return all;
}

}  // namespace calomel
