#pragma once
/// The search of a MAP on one model: the likelihood with the model's errors as they are at a point, starts, and modes with their covariance.
#include <mutex>

#include "inverse/map.hpp"
#include "inverse/posterior_mode.hpp"

namespace calomel {

/// A mode of the posterior on the search's model.
struct Optimum {
  Eigen::VectorXd x;
  double log_posterior = 0;
  Eigen::MatrixXd covariance;  ///< of x
};

/// Logarithm of the Laplace evidence at an optimum: exp(log posterior) sqrt((2 pi)^n |C|), C in the coordinates of the density.
double laplace_log_evidence(const Optimum& o, const SearchSpace& space);

/// All arguments outlive the object; `models` may change between calls.
class MapSearch {
 public:
  MapSearch(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options, const MapModels& models, const MapOptions& options,
            const SearchSpace& space, int threads)
      : problem_(problem), recordings_(recordings), recording_options_(recording_options), models_(models), options_(options), space_(space),
        threads_(threads) {}

  [[nodiscard]] bool on_surrogate() const { return models_.surrogate != nullptr; }
  [[nodiscard]] const ForwardModel& model() const { return on_surrogate() ? *models_.surrogate : models_.true_model; }
  [[nodiscard]] const SearchSpace& space() const { return space_; }
  [[nodiscard]] const MapOptions& options() const { return options_; }
  [[nodiscard]] int threads() const { return threads_; }

  /// The likelihood with the model's errors as they are at theta.
  [[nodiscard]] Likelihood likelihood(std::span<const double> theta, bool with_surrogate) const;
  /// Design points by the prior, (n_parameters, options.design) and the nominal one as the last column.
  [[nodiscard]] Eigen::MatrixXd design(std::uint64_t seed) const;
  /// log posteriors of the columns of `design` under a likelihood, on the search's model.
  [[nodiscard]] Eigen::VectorXd scan(const Likelihood& likelihood, const Eigen::MatrixXd& design);
  /// Modes from the given starts, best first, each with its covariance by secants of the search model.
  std::vector<Optimum> optima(const Likelihood& likelihood, const std::vector<Eigen::VectorXd>& starts, const std::vector<Eigen::VectorXd>& half_widths,
                              const CalibrationProgress& progress);
  /// Modes from the best points of the design and from `also`; then once more, under the likelihood as it is at the best of them, which is put into
  /// `likelihood`. Empty when no point of the design can be evaluated.
  std::vector<Optimum> global(std::optional<Likelihood>& likelihood, const Eigen::MatrixXd& design, const std::vector<Eigen::VectorXd>& also,
                              const CalibrationProgress& progress);
  /// laplace_log_evidence in the search's space.
  [[nodiscard]] double log_evidence(const Optimum& o) const { return laplace_log_evidence(o, space_); }
  /// Secants of the search model in posterior standard deviations: a surrogate is smooth.
  [[nodiscard]] double secant() const { return on_surrogate() ? 0.3 : options_.secant; }
  [[nodiscard]] std::size_t evaluations() const { return evaluations_; }

 private:
  const Problem& problem_;
  const Recordings& recordings_;
  const RecordingOptions& recording_options_;
  const MapModels& models_;
  const MapOptions& options_;
  const SearchSpace& space_;
  int threads_;
  std::size_t evaluations_ = 0;
};

/// Optima as proposals whose cost is -log posterior.
std::vector<Proposal> proposals(const std::vector<Optimum>& optima, const SearchSpace& space);

}  // namespace calomel
