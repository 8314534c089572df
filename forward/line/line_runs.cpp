#include "forward/line/line_runs.hpp"

namespace calomel {

namespace {

/// The line with further numbers set.
class WithNumbers : public ForwardModel {
 public:
  WithNumbers(const LineModel& model, const std::map<std::string, double>& numbers) : model_(model), numbers_(numbers) {}
  [[nodiscard]] const ModelShape& shape() const override { return model_.shape(); }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override { return model_.evaluate(theta, numbers_); }

 private:
  const LineModel& model_;
  const std::map<std::string, double>& numbers_;
};

}  // namespace

std::vector<ParameterGroup> offered_groups(const LineModel& model) {
  std::vector<ParameterGroup> groups;
  for (const auto& m : model.offered()) {
    ParameterGroup g{.name = m.name, .by_sensor = m.per_station && model.shape().sensors.size() > 1, .plain = m.plain, .check = m.check};
    for (const auto& k : m.keys)
      if (k.decides) g.added.push_back(added_number(m.name, k, k.off));
    groups.push_back(std::move(g));
  }
  return groups;
}

std::vector<RunRecord> LineRuns::run(const Eigen::MatrixXd& thetas, std::span<const AddedParameter> added, int threads, const RunStore::Progress& progress,
                                     const std::atomic<bool>* stop) {
  const auto& parameters = model_.shape().parameters;
  const std::size_t own = parameters.size();
  expect(std::size_t(thetas.rows()) == own + added.size(), "a theta holds the parameters and what is added");
  std::vector<RunPoint> points;
  for (Eigen::Index i = 0; i < thetas.cols(); ++i) {
    const auto theta = thetas.col(i);
    points.push_back(point_at(parameters, {theta.data(), own}));
    set_added(points.back(), {theta.data() + own, added.size()}, added);
  }
  const auto evaluate = [&](const RunPoint& point) {
    RunPoint rest = point;
    for (const auto& p : parameters) rest.erase(p.key);
    return evaluate_run(WithNumbers(model_, rest), theta_at(parameters, point), false);
  };
  return store_.run(points, evaluate, threads, {}, progress, stop);
}

}  // namespace calomel
