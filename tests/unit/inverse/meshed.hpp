#pragma once
#include "forward/campaign/archive.hpp"
#include "forward/campaign/campaign.hpp"
#include "tests/unit/inverse/oscillations.hpp"

namespace calomel {

/// Oscillations on a mesh. The element size slows the waves, damps them and lowers their amplitude, each in proportion to it; element size 0 is exact.
class Meshed final : public ForwardModel {
 public:
  explicit Meshed(double element) : element_(element) {}
  [[nodiscard]] const ModelShape& shape() const override { return exact_.shape(); }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override {
    ++runs;
    const std::vector<double> seen{theta[0] * (1 - 0.08 * element_), theta[1] * (1 - 0.02 * element_), theta[2] + 2500 * element_};
    return exact_.evaluate(seen);
  }
  mutable std::atomic<int> runs{0};

 private:
  Oscillations exact_{120};
  double element_;
};

/// The archive of a campaign, without files.
inline Archive archive_of(const ForwardModel& model, const std::string& design, std::size_t runs, std::uint64_t seed) {
  Archive a;
  a.shape = model.shape();
  a.design = design;
  a.theta = design_points(design, a.shape.parameters, runs, seed);
  a.mean.resize(Eigen::Index(a.shape.values()), Eigen::Index(runs));
  for (Eigen::Index i = 0; i < a.theta.cols(); ++i) {
    const auto p = model.evaluate({a.theta.col(i).data(), std::size_t(a.theta.rows())});
    a.status.push_back(p.ok ? RunStatus::done : RunStatus::failed);
    a.message.push_back(p.message);
    if (p.ok)
      a.mean.col(i) = Eigen::Map<const Eigen::VectorXd>(p.mean.data(), Eigen::Index(p.mean.size())).cast<float>();
    else
      a.mean.col(i).setConstant(std::nanf(""));
  }
  return a;
}

}  // namespace calomel
