#pragma once
/// What is kept of one run of a model.
#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "forward/model.hpp"

namespace calomel {

/// The values in single precision: 6e-8 of themselves, far below any scatter.
struct RunRecord {
  bool done = false;
  bool lost = false;                ///< no answer came (Prediction::lost): such a record is not kept
  std::string message;              ///< why the run failed
  std::vector<float> mean;          ///< (condition, sensor, time) [-]
  std::vector<float> energy_slope;  ///< the same shape, or empty
  std::vector<float> scatter;       ///< the same shape, or empty
  std::vector<float> pulses;        ///< (pulse, condition, sensor, time), or empty
  std::vector<double> energies;     ///< (pulse)
  std::vector<double> totals;       ///< (condition, total) of a run that is asked for these alone (see total_runs.hpp), else empty
  bool operator==(const RunRecord&) const = default;

  /// mean in double precision, (condition, sensor, time) [-].
  [[nodiscard]] Eigen::VectorXd history() const { return Eigen::Map<const Eigen::VectorXf>(mean.data(), Eigen::Index(mean.size())).cast<double>(); }
};

/// The model at `theta`, (n_parameters): what goes wrong in the run, or is wrong with its values, is the record's message.
/// Errors: InputError, Interrupted and lack of memory, which are not the run's.
RunRecord evaluate_run(const ForwardModel& model, std::span<const double> theta, bool keep_pulses);

/// A record as bytes, and back. Errors: ContractFailure for bytes that are no record.
std::string bytes_of(const RunRecord& record);
RunRecord record_of(std::string_view bytes);

}  // namespace calomel
