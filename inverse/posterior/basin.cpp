#include "inverse/posterior/basin.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/linear_algebra.hpp"
#include "forward/campaign/design.hpp"
#include "inverse/posterior/prior.hpp"

namespace calomel {

namespace {

constexpr std::size_t design = 1024, local_design = 64;
constexpr std::size_t basins = 8;       ///< that are looked into
constexpr double apart = 0.1;           ///< of two basins, the largest over the parameters in units of their bounds
constexpr double first_reach = 0.1;     ///< half width of the first local design, in the same units
constexpr double shrinking = 0.7;
constexpr int rounds = 16;              ///< to 5e-4 of the bounds

struct At {
  Eigen::VectorXd unit;
  double cost;
};

class Basin {
 public:
  Basin(const Problem& problem, const ErrorModel& errors, const ForwardModel& surrogate, int threads)
      : errors_(errors), surrogate_(surrogate), parameters_(surrogate.shape().parameters), priors_(priors_of(parameters_)), factor_(errors.covariance()), threads_(threads) {
    expect(surrogate.shape().values() == problem.shape.values(), "the surrogate has the problem's shape");
    if (!factor_.positive_definite()) throw NumericsError("the covariance of the records' errors is not positive definite");
  }
  [[nodiscard]] std::vector<double> theta(const Eigen::VectorXd& unit) const {
    std::vector<double> t;
    for (std::size_t k = 0; k < parameters_.size(); ++k) t.push_back(parameters_[k].min + unit[Eigen::Index(k)] * (parameters_[k].max - parameters_[k].min));
    return t;
  }
  /// Points of the unit cube with chi-squared / 2 - log prior, those without prediction left out.
  [[nodiscard]] std::vector<At> at(const Eigen::MatrixXd& units) const {
    Eigen::MatrixXd thetas(units.rows(), units.cols());
    for (Eigen::Index i = 0; i < units.cols(); ++i) {
      const auto t = theta(units.col(i));
      thetas.col(i) = Eigen::Map<const Eigen::VectorXd>(t.data(), units.rows());
    }
    const Eigen::MatrixXd values = errors_.grid().apply(Eigen::MatrixXd(surrogate_.means(thetas, threads_).cast<double>()));
    const Eigen::MatrixXd whitened = factor_.solve_lower(Eigen::MatrixXd(values.colwise() - errors_.data()));
    std::vector<At> out;
    for (Eigen::Index i = 0; i < units.cols(); ++i) {
      const double cost = 0.5 * whitened.col(i).squaredNorm() - log_prior(priors_, {thetas.col(i).data(), std::size_t(thetas.rows())});
      if (std::isfinite(cost)) out.push_back({units.col(i), cost});
    }
    std::stable_sort(out.begin(), out.end(), [](const At& a, const At& b) { return a.cost < b.cost; });
    return out;
  }

 private:
  const ErrorModel& errors_;
  const ForwardModel& surrogate_;
  const std::vector<Parameter>& parameters_;
  std::vector<Prior> priors_;
  Cholesky factor_;
  int threads_;
};

}  // namespace

std::vector<double> find_basin(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options, const ErrorOptions& options,
                               const ForwardModel& surrogate, const Eigen::MatrixXd& positions, double relative, std::uint64_t seed, int threads) {
  ErrorDirections directions;
  directions.mesh = relative;
  const ErrorModel errors(problem, recordings, recording_options, options, directions, positions);
  const Basin basin(problem, errors, surrogate, threads);
  const auto n = surrogate.shape().parameters.size();
  std::vector<At> starts;
  for (const At& p : basin.at(sobol_points(n, design, seed)))
    if (starts.size() < basins && std::all_of(starts.begin(), starts.end(), [&](const At& s) { return (s.unit - p.unit).cwiseAbs().maxCoeff() >= apart; })) starts.push_back(p);
  if (starts.empty()) throw NumericsError("the surrogate gives no prediction anywhere in the parameters' bounds");
  const Eigen::MatrixXd local = 2 * sobol_points(n, local_design, seed + 1).array() - 1;
  At best = starts[0];
  for (At s : starts) {
    double reach = first_reach;
    for (int round = 0; round < rounds; ++round, reach *= shrinking) {
      const Eigen::MatrixXd about = ((reach * local).colwise() + s.unit).cwiseMax(0.0).cwiseMin(1.0);
      if (const auto found = basin.at(about); !found.empty() && found[0].cost < s.cost) s = found[0];
    }
    if (s.cost < best.cost) best = s;
  }
  return basin.theta(best.unit);
}

}  // namespace calomel
