#include "inverse/posterior/basin.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/linear_algebra.hpp"
#include "forward/campaign/design.hpp"
#include "inverse/posterior/prior.hpp"

namespace calomel {

namespace {

constexpr std::size_t design = 1024, local_design = 64;
constexpr std::size_t basins = 8;    ///< that are looked into
constexpr double apart = 0.1;        ///< of two basins, the largest over the parameters in units of their bounds
constexpr double first_reach = 0.1;  ///< half width of the first local design, in the same units
constexpr double shrinking = 0.7;
constexpr int rounds = 16;  ///< to 5e-4 of the bounds
constexpr int most_fine_runs = 6;
constexpr double stays = 0.02;  ///< a basin that moves by less, in units of the bounds, has been found

struct At {
  Eigen::VectorXd unit;
  double cost;
};

class Basin {
 public:
  Basin(const Problem& problem, const ErrorModel& errors, const ForwardModel& surrogate, int threads)
      : errors_(errors),
        surrogate_(surrogate),
        parameters_(surrogate.shape().parameters),
        priors_(priors_of(parameters_)),
        factor_(errors.covariance()),
        wanted_(errors.data()),
        threads_(threads) {
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
    const Eigen::MatrixXd whitened = factor_.solve_lower(Eigen::MatrixXd(values.colwise() - wanted_));
    std::vector<At> out;
    for (Eigen::Index i = 0; i < units.cols(); ++i) {
      const double cost = 0.5 * whitened.col(i).squaredNorm() - log_prior(priors_, {thetas.col(i).data(), std::size_t(thetas.rows())});
      if (std::isfinite(cost)) out.push_back({units.col(i), cost});
    }
    std::stable_sort(out.begin(), out.end(), [](const At& a, const At& b) { return a.cost < b.cost; });
    return out;
  }

  /// The best point of the unit cube.
  [[nodiscard]] Eigen::VectorXd find(std::uint64_t seed) const;
  /// From now on with what the finest mesh shows beyond the surrogate at a point.
  void correct(const Eigen::VectorXd& unit, const std::vector<double>& fine);

 private:
  const ErrorModel& errors_;
  const ForwardModel& surrogate_;
  const std::vector<Parameter>& parameters_;
  std::vector<Prior> priors_;
  Cholesky factor_;
  Eigen::VectorXd wanted_;  ///< records less what the finest mesh shows beyond the surrogate, (size)
  int threads_;
};

Eigen::VectorXd Basin::find(std::uint64_t seed) const {
  const auto n = parameters_.size();
  std::vector<At> starts;
  for (const At& p : at(space_filling_points(n, design, seed)))
    if (starts.size() < basins && std::all_of(starts.begin(), starts.end(), [&](const At& s) { return (s.unit - p.unit).cwiseAbs().maxCoeff() >= apart; }))
      starts.push_back(p);
  if (starts.empty()) throw NumericsError("the surrogate gives no prediction anywhere in the parameters' bounds");
  const Eigen::MatrixXd local = 2 * space_filling_points(n, local_design, seed + 1).array() - 1;
  At best = starts[0];
  for (At s : starts) {
    double reach = first_reach;
    for (int round = 0; round < rounds; ++round, reach *= shrinking) {
      const Eigen::MatrixXd about = ((reach * local).colwise() + s.unit).cwiseMax(0.0).cwiseMin(1.0);
      if (const auto found = at(about); !found.empty() && found[0].cost < s.cost) s = found[0];
    }
    if (s.cost < best.cost) best = s;
  }
  return best.unit;
}

void Basin::correct(const Eigen::VectorXd& unit, const std::vector<double>& fine) {
  const Prediction own = surrogate_.evaluate(theta(unit));
  if (!own.ok) return;
  const auto history = [](const std::vector<double>& v) { return Eigen::Map<const Eigen::VectorXd>(v.data(), Eigen::Index(v.size())); };
  wanted_ = errors_.data() - errors_.grid().apply(history(fine) - history(own.mean));
}

}  // namespace

std::vector<double> find_basin(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options, const ErrorOptions& options,
                               const ForwardModel& surrogate, double relative, const FineRun& fine, std::uint64_t seed, int threads) {
  ErrorDirections directions;
  directions.mesh = relative;
  const ErrorModel errors(problem, recordings, recording_options, options, directions);
  Basin basin(problem, errors, surrogate, threads);
  Eigen::VectorXd at = basin.find(seed);
  for (int run = 0; fine && run < most_fine_runs; ++run) {
    const auto history = fine(basin.theta(at));
    if (history.empty()) break;
    basin.correct(at, history);
    const Eigen::VectorXd before = std::exchange(at, basin.find(seed));
    if ((at - before).cwiseAbs().maxCoeff() < stays) break;
  }
  return basin.theta(at);
}

}  // namespace calomel
