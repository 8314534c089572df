#pragma once
/// The record of one run of the true model.
#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "forward/model.hpp"
#include "forward/simulation/run_request.hpp"

namespace calomel {

/// The outputs of one run, or the reason why there are none. Histories are in single precision, which is 6e-8 of a value and far below any scatter.
struct RunRecord {
  bool done = false;
  bool lost = false;                   ///< no answer came (Prediction::lost); such a record is not kept, and the run may be requested again
  std::string message;                 ///< why the run failed
  std::vector<float> mean;             ///< (condition, sensor, time) [unit of the model]
  std::vector<float> energy_slope;     ///< the same shape, or empty
  std::vector<float> scatter;          ///< the same shape, or empty
  std::vector<float> pulses;           ///< (pulse, condition, sensor, time), or empty
  std::vector<double> energies;        ///< (pulse)
  std::vector<double> totals;          ///< (condition, total), see run_totals; or empty
  std::vector<double> energy_balance;  ///< (condition) relative error of the energy balance; or empty
  std::vector<double> exact;           ///< the mean in double precision, of a model of few values such as a log density; or empty
  bool operator==(const RunRecord&) const = default;

  /// The mean in double precision, (condition, sensor, time).
  [[nodiscard]] Eigen::VectorXd history() const;
  /// The mean and the reason of a failure, as a model's answer.
  [[nodiscard]] Prediction prediction() const;
};

/// A total of a run: its name and unit.
struct RunTotal {
  const char *name, *unit;
};
inline constexpr RunTotal run_totals[] = {{"dissipated_energy", "J"}, {"time_at_cutoff", "s"}};
inline constexpr std::size_t run_total_count = std::size(run_totals);

/// The record of a prediction. A prediction of the wrong size or with a value that is not finite is a failed run whose message gives the reason.
/// keep_pulses: whether the single pulses are recorded. `shape` is that of the model.
RunRecord record_of(const ModelShape& shape, Prediction prediction, bool keep_pulses);
/// The model at `theta`, (n_parameters). An exception in the run becomes the record's message.
/// Errors: InputError, Interrupted, Unreachable and lack of memory, which are no fault of the run.
RunRecord evaluate_run(const ForwardModel& model, std::span<const double> theta, bool keep_pulses);

/// A record as bytes, and back. Errors: ContractFailure for bytes that are no record.
std::string bytes_of(const RunRecord& record);
RunRecord record_of(std::string_view bytes);

}  // namespace calomel
