#pragma once
/// An external model as a ForwardModel.
#include "forward/external/external_case.hpp"
#include "forward/model.hpp"

namespace calomel {

/// The shape of the model's records as the case declares it; it needs no connection.
ModelShape shape_of(const ExternalCase& external);

class ExternalModel : public ForwardModel {
 public:
  /// Checks that the server responds, has the model, and accepts and returns the sizes of the case. Errors: Unreachable or NumericsError for the server's part;
  /// InputError naming model.name, parameter or output where the case and the model do not fit.
  explicit ExternalModel(ExternalCase external);

  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override { return evaluate(theta, {}); }
  /// `numbers`: "mechanism.NAME.parameter.P" of those that are not enabled, and reading_gain.
  [[nodiscard]] Prediction evaluate(std::span<const double> theta, const std::map<std::string, double>& numbers) const;

  /// Whether the server gives gradients.
  [[nodiscard]] bool has_gradient() const override { return support_.gradient; }
  /// Errors: NumericsError where the server gives none at theta.
  [[nodiscard]] Eigen::VectorXd vector_jacobian_product(std::span<const double> theta, std::span<const double> weights) const override;

  [[nodiscard]] const ExternalCase& external_case() const { return case_; }
  /// The model's blocks.
  [[nodiscard]] const std::vector<std::size_t>& input_sizes() const { return input_sizes_; }
  [[nodiscard]] const std::vector<std::size_t>& output_sizes() const { return output_sizes_; }

 private:
  [[nodiscard]] std::vector<double> inputs(std::span<const double> theta, const std::map<std::string, double>& numbers) const;
  [[nodiscard]] Blocks blocks(const std::vector<double>& inputs) const;
  ExternalCase case_;
  UmbridgeClient client_;
  UmbridgeSupport support_;
  std::vector<std::size_t> input_sizes_, output_sizes_;
  std::vector<std::size_t> place_;  ///< (parameters) of each among the inputs
  ModelShape shape_;
};

}  // namespace calomel
