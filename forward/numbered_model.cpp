#include "forward/numbered_model.hpp"

namespace calomel {

namespace {

/// The model with further numbers set.
class WithNumbers : public ForwardModel {
 public:
  WithNumbers(const NumberedModel& model, const std::map<std::string, double>& numbers) : model_(model), numbers_(numbers) {}
  [[nodiscard]] const ModelShape& shape() const override { return model_.shape(); }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override { return model_.evaluate(theta, numbers_); }

 private:
  const NumberedModel& model_;
  const std::map<std::string, double>& numbers_;
};

}  // namespace

std::vector<RunRecord> NumberedRuns::run(const Eigen::MatrixXd& thetas, std::span<const AddedParameter> added, int threads, const RunStore::Progress& progress,
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
