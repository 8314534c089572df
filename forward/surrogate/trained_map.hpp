#pragma once
/// What every kind of surrogate is: a trained map from parameters to histories. A kind joins the catalogue in
/// register.cpp with two functions, `train` and `load`.
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/netcdf_file.hpp"
#include "base/registry.hpp"
#include "forward/model.hpp"
#include "forward/parameter.hpp"
#include "forward/surrogate/options.hpp"

namespace calomel {

class TrainedMap {
 public:
  virtual ~TrainedMap() = default;
  /// thetas: (n_parameters, n), natural units; result: (values, n). The same for any number of threads.
  [[nodiscard]] virtual Eigen::MatrixXf histories(const Eigen::MatrixXd& thetas, int threads) const = 0;
  /// Offset and directions of a kind whose histories are offset + directions * coefficients(theta); empty for one that is not of this form.
  [[nodiscard]] virtual HistoryBasis basis() const { return {}; }
  /// thetas: (n_parameters, n); result: (n_directions, n). Of a kind with a basis.
  [[nodiscard]] virtual Eigen::MatrixXf coefficients(const Eigen::MatrixXd&) const { return {}; }
  /// Gradient of weights . history(theta) by theta (n_parameters); weights: (values).
  [[nodiscard]] virtual Eigen::VectorXd vector_jacobian_product(const Eigen::VectorXd& theta, const Eigen::VectorXd& weights) const = 0;
  /// Predictive variance of the values where the kind has one of its own, else empty.
  [[nodiscard]] virtual Eigen::VectorXd variance(const Eigen::VectorXd&) const { return {}; }
  /// Every number that `load` needs, as variables whose names start with `prefix`.
  virtual void save(NetcdfWriter& file, const std::string& prefix) const = 0;
};

/// Training runs, and held-out runs that may be looked at but not trained on.
struct TrainingSet {
  std::vector<Parameter> parameters;
  std::size_t series = 1;          ///< (condition, sensor) rows of a history
  Eigen::MatrixXd theta;           ///< (n_parameters, n_train)
  Eigen::MatrixXf histories;       ///< (values, n_train)
  Eigen::MatrixXd test_theta;      ///< (n_parameters, n_test), may be empty
  Eigen::MatrixXf test_histories;  ///< (values, n_test)
};

/// What training leaves to report beside the emulator.
struct TrainingRecord {
  int epochs = 0;                  ///< passes over the runs; 0 where the word has no meaning
  std::vector<double> train_loss;  ///< an epoch each, in the kind's own scale
  std::vector<double> test_loss;
  int modes = 0;           ///< 0 for a kind without modes
  double mode_energy = 0;  ///< share of the training variance in them
};

struct SurrogateKind {
  std::unique_ptr<TrainedMap> (*train)(const TrainingSet& set, const SurrogateOptions& options, std::uint64_t seed, int threads, TrainingRecord& record);
  std::unique_ptr<TrainedMap> (*load)(const NetcdfReader& file, const std::string& prefix);
};

/// All surrogates by name.
Registry<SurrogateKind> surrogate_kinds();

}  // namespace calomel
