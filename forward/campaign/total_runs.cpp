#include "forward/campaign/total_runs.hpp"

#include <limits>

namespace calomel {

Eigen::MatrixXd totals_at(Runs& runs, const Eigen::MatrixXd& thetas, const Runs::Progress& progress) {
  const ModelShape& shape = runs.simulator().shape();
  std::vector<RunRequest> requests;
  for (Eigen::Index i = 0; i < thetas.cols(); ++i) {
    requests.push_back(request_at(shape.parameters, {thetas.col(i).data(), std::size_t(thetas.rows())}));
    requests.back().wanted = {.mean = false, .totals = true};
  }
  const auto records = runs.get(requests, progress);
  const auto rows = Eigen::Index(shape.conditions.size() * run_total_count);
  Eigen::MatrixXd out = Eigen::MatrixXd::Constant(rows, thetas.cols(), std::numeric_limits<double>::quiet_NaN());
  for (Eigen::Index i = 0; i < out.cols(); ++i)
    if (const auto& r = records[std::size_t(i)]; r.done) {
      expect(Eigen::Index(r.totals.size()) == rows, "a run with an energy balance has totals of every condition");
      out.col(i) = Eigen::Map<const Eigen::VectorXd>(r.totals.data(), rows);
    }
  return out;
}

}  // namespace calomel
