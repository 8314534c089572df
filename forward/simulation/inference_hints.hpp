#pragma once
/// What is particular to a model when its parameters are inferred. Inference itself knows no target.
#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "forward/parameter.hpp"

namespace calomel {

/// A number of the model that is uncertain whatever the case calibrates. It becomes a nuisance parameter of the posterior where it has a prior.
struct UncertainNumber {
  std::string name;  ///< of the nuisance parameter, by which the options [emulator] and [errors] give its prior
  std::string key;   ///< dotted key of the case
  double value = 0;  ///< in the case
  std::string unit;
  bool logarithmic = true;  ///< its prior is lognormal, else normal
  double box_sds = 2;       ///< half width of the emulator's first box, in prior standard deviations
  double widest_sds = 3;    ///< bounds, in prior standard deviations
};

/// The prior of a number that handbooks know: normal about the nominal value with a relative standard deviation, or lognormal with one of the logarithm.
struct HandbookPrior {
  std::string key;
  std::string prior;  ///< "normal" or "lognormal"
  double sd = 0;
};

/// A product of powers of parameters with a name of its own, such as an impedance.
struct PowerProduct {
  std::string name;
  std::map<std::string, double> exponents;  ///< by the dotted key
};

struct InferenceHints {
  /// Where the first box of the emulator is placed.
  enum class Start {
    basin,          ///< about the best point of a campaign's surrogate, or the nominal values
    nominal,        ///< about the nominal values, as wide as the priors
    least_squares,  ///< about the best of several least-squares fits of the model itself
  };
  /// Defaults of [errors].
  enum class Errors {
    strain_gauges,  ///< those of gauges on a target and of its mesh
    no_gauges,      ///< the same without errors of gauges and beam
    own_times,      ///< the noise of the records alone, on the model's own times
  };
  Start start = Start::basin;
  Errors errors = Errors::strain_gauges;
  double time_step = 0;       ///< of a model with even times of its own [s]; 0: the model has values wherever records have
  bool any_prior = false;     ///< uniform priors are allowed beside a discrepancy, with a warning
  bool idle_numbers = false;  ///< which numbers of a mechanism act alone is not known beforehand and is found by runs
  std::vector<UncertainNumber> nuisances;
  std::vector<HandbookPrior> handbook;
  std::map<std::string, double> half_widths;  ///< of the emulator's first box, by key, in the coordinate of the parameter
  std::string numerical_viscosity;            ///< key of the viscosity of the numerics, which every mesh of an emulator has alike; empty: there is none
  std::optional<double> element_size;         ///< of the case's own mesh [m]
  double resolved_length = 0;                 ///< shortest length that a mesh must resolve, such as a pulse's front [m]; 0: none is known
  Eigen::MatrixXd gauge_positions;            ///< (sensors, 3) [m]; empty: the records have no places
  std::vector<std::string> identified;        ///< keys of the parameters whose combinations are of interest; empty: all
  std::vector<PowerProduct> combinations;     ///< reported beside them
  std::vector<Parameter> varied_numbers;      ///< numbers that the repeatability floor moves where the case has no parameter
};

}  // namespace calomel
