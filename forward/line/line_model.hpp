#pragma once
/// The line as a ForwardModel: waves along a bar or a pipe, about a millisecond a run, so that a diagnosis of omitted physics can be tested on measured
/// records.
#include <map>

#include "forward/line/line_case.hpp"
#include "forward/model.hpp"

namespace calomel {

/// A mechanism that the base model leaves out and the diagnosis may switch on: numbers "mechanism.NAME.KEY".
struct OfferedMechanism {
  std::string name;
  std::string law;
  std::vector<MechanismKey> keys;  ///< name, unit, off value, default prior range, whether it decides
  bool per_station = false;        ///< "mechanism.NAME.STATION.KEY" is of one station alone
  std::string plain, check;        ///< LineMechanismEntry's
};

/// What `check` prints.
struct LineDescription {
  std::size_t cells = 0, nodes = 0, steps = 0;  ///< pipe: of its grid; bar: frequencies, samples of the record and what is appended, one step for all times
  double time_step = 0;                         ///< [s]; bar: between samples of the record
  double friction_factor = 0;                   ///< of the pipe's turbulent flow [-]
  double steady_pressure = 0;                   ///< of the pipe at the valve [Pa]
  std::vector<std::string> active;              ///< mechanisms that are part of the model
  std::vector<std::string> offered;             ///< those that are not
  std::vector<std::string> notes;
};

class LineModel : public ForwardModel {
 public:
  explicit LineModel(LineCase line_case);

  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override;
  /// At `theta` with further numbers of the case set, by dotted key: keys of mechanisms, offered ones included, and any other number. With none it is
  /// evaluate(theta), byte for byte, and so it is with a mechanism's off values.
  /// Errors: InputError for a key that names no number.
  [[nodiscard]] Prediction evaluate(std::span<const double> theta, const std::map<std::string, double>& numbers) const;

  /// Mechanisms that the case lists without enabling them, or all of the catalogue that it does not enable where it lists none so; it must have their numbers.
  [[nodiscard]] std::vector<OfferedMechanism> offered() const;
  [[nodiscard]] LineDescription describe() const;
  [[nodiscard]] const LineCase& line_case() const { return case_; }

 private:
  [[nodiscard]] std::vector<double> histories(const LineCase& at) const;
  [[nodiscard]] std::vector<double> bar_histories(const LineCase& at) const;
  [[nodiscard]] std::vector<double> pipe_histories(const LineCase& at) const;
  LineCase case_;
  ModelShape shape_;
};

/// Numbers of a pipe's run at a case's numbers, its mechanisms that are not off included.
PipeSetup pipe_setup(const LineCase& at);

}  // namespace calomel
