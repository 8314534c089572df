#include "forward/total_runs.hpp"

#include <limits>

#include "base/errors.hpp"

namespace calomel {

namespace {

RunRecord record_at(const BuiltInModel& model, std::span<const double> theta) {
  try {
    RunRecord record{.done = true};
    for (const auto& t : model.totals(theta)) record.totals.insert(record.totals.end(), {t.dissipated, t.time_at_cutoff});
    return record;
  } catch (const NumericsError& e) {
    return {.message = e.what()};
  } catch (const InputError& e) {  // a parameter that leads outside what a mesh or a table allows
    return {.message = e.what()};
  }
}

}  // namespace

Eigen::MatrixXd totals_at(const BuiltInModel& model, const Eigen::MatrixXd& thetas, RunStore& store, int threads, const RunStore::Progress& progress,
                          const std::atomic<bool>* stop) {
  const auto& shape = model.shape();
  std::vector<RunPoint> points;
  for (Eigen::Index i = 0; i < thetas.cols(); ++i) {
    points.push_back(point_at(shape.parameters, {thetas.col(i).data(), std::size_t(thetas.rows())}));
    points.back()[totals_key] = 1;
  }
  const auto records = store.run(
      points, [&](const RunPoint& p) { return record_at(model, theta_at(shape.parameters, p)); }, threads, {}, progress, stop);
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
