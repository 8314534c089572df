#pragma once
/// How sure a point calibration is of its answer: answers to records and runs whose errors were drawn anew.
#include <Eigen/Core>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/options.hpp"
#include "inverse/posterior/identifiability.hpp"

namespace calomel {

/// What a calibration finds for the records that a pair of meshes which it does not know would have given.
struct FoundPair {
  std::vector<double> theta, found;
  double squares = 0;  ///< squared distance of the two by the covariance of the answer
};

/// Answers of one calibration to drawn errors, and their moments about its answer.
struct AnswerSpread {
  int wanted = 0;                      ///< draws; 0: none were asked for
  Eigen::MatrixXd answers;             ///< (n_parameters, draws that came to an answer)
  std::size_t at_bounds = 0;           ///< of them, those that end on a bound of a parameter
  Eigen::MatrixXd covariance;          ///< second moments about the answer, (n, n), in the parameters' own units; empty: there are none
  Eigen::VectorXd log_sd;              ///< root mean square of ln(drawn / answer), (n); NaN where a value is not positive
  std::vector<Combination> combinations;  ///< impedance and stiffness where density and sound speed are parameters
  std::vector<std::pair<std::string, double>> shares;  ///< of the trace of the records' covariance, by source
  std::vector<FoundPair> pairs;        ///< left out; empty: none were
  double inflation = 1;                ///< factor of the covariance by them
  double seconds = 0;                  ///< wall time [s]
  std::string sentence;                ///< in words, or why there is none
  [[nodiscard]] bool told() const { return covariance.size() > 0; }
};

/// Fills what follows from the drawn answers: at_bounds, covariance, log_sd, combinations, sentence. Fewer than 8 answers: no covariance, and why.
/// The second moments are about the answer, not about the draws' mean: a bias that drawn errors cause is part of what the answer may be off by.
void summarise(AnswerSpread& spread, const std::vector<Parameter>& parameters, const std::vector<double>& answer);

/// Multiplies the covariance by the median over the pairs of e' C^-1 e, e = found - theta, over the median of chi-squared with n degrees, where that is above 1, and tells so: one pair far
/// off, where few runs are, does not decide. Nothing is judged by fewer than six pairs.
void widen(AnswerSpread& spread, const std::vector<Parameter>& parameters, const std::vector<double>& answer, std::vector<FoundPair> pairs);

/// parameters, covariance, sd, log_sd, combinations and spread: keys of METHOD.json; {} where no draws were asked for.
Json spread_json(const AnswerSpread& spread, const std::vector<Parameter>& parameters);

/// name, value, low, high and relative_sd of each.
Json combinations_json(std::span<const Combination> combinations);

/// Of the option draws of a calibration.
FieldInfo draws_info();

}  // namespace calomel
