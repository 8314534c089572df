#include "inverse/posterior/multistart_least_squares.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/linear_algebra.hpp"
#include "forward/campaign/design.hpp"
#include "inverse/posterior/prior.hpp"

namespace calomel {

namespace {

constexpr double difference = 1e-3;  ///< of a finite difference, in prior widths; runs are kept to seven digits
constexpr double nearly = 1e-6;      ///< of two points that count as one, in prior widths
constexpr double tail = 0.01;        ///< of the priors, left out of the design
constexpr double box_sds = 4;        ///< half width of the box, in the deviations found
constexpr double box_of_prior = 3;   ///< and at most, in prior deviations: what the records do not determine keeps its prior with its tails
constexpr double least_box = 0.01;   ///< and at least, of these
constexpr int polish_iterations = 10;
constexpr double polish_tolerance = 1e-7;
constexpr double no_answer = 1e6;  ///< residual where the model has none

class Search {
 public:
  Search(const PosteriorInputs& in, const ErrorModel* errors)
      : in_(in),
        errors_(errors ? *errors
                       : ErrorModel(in.problem, in.recordings, in.recording_options, in.errors,
                                    {.energy_slope = {}, .gauge_places = {}, .last_difference = {}, .mesh = in.mesh})),
        priors_(priors_of(in.parameters)),
        factor_(errors_.covariance()),
        wanted_(errors_.data()) {
    if (!factor_.positive_definite()) throw NumericsError("the covariance of the records' errors is not positive definite");
    for (std::size_t k = 0; k < in.parameters.size(); ++k) {
      const auto& p = in.parameters[k];
      width_.push_back(p.coordinate_width(std::min(priors_[k].scale(), p.max - p.min), std::clamp(*p.nominal, p.min, p.max)));
    }
  }

  [[nodiscard]] Eigen::Index dimension() const { return Eigen::Index(in_.parameters.size()); }
  [[nodiscard]] Eigen::Index values() const { return wanted_.size(); }
  [[nodiscard]] double width(Eigen::Index k) const { return width_[std::size_t(k)]; }
  [[nodiscard]] const Parameter& parameter(Eigen::Index k) const { return in_.parameters[std::size_t(k)]; }
  [[nodiscard]] int runs() const { return runs_; }

  /// Whitened residuals, (values, n), at coordinates x (n_parameters, n); NaN where a run failed.
  Eigen::MatrixXd residuals(const Eigen::MatrixXd& x) { return whitened(compared(x).colwise() - wanted_); }
  [[nodiscard]] Eigen::MatrixXd whitened(const Eigen::MatrixXd& r) const { return factor_.solve_lower(r); }
  /// The model's values that are compared, in the records' unit; else as residuals.
  Eigen::MatrixXd compared(const Eigen::MatrixXd& x) {
    Eigen::MatrixXd thetas(x.rows(), x.cols());
    for (Eigen::Index i = 0; i < x.cols(); ++i)
      for (Eigen::Index k = 0; k < x.rows(); ++k) thetas(k, i) = std::clamp(parameter(k).natural(x(k, i)), parameter(k).min, parameter(k).max);
    const auto records = in_.run(thetas, std::vector<int>(std::size_t(x.cols()), 0));
    runs_ += int(records.size());
    Eigen::MatrixXd out(values(), x.cols());
    for (std::size_t i = 0; i < records.size(); ++i) {
      if (records[i].done) {
        out.col(Eigen::Index(i)) = errors_.grid().apply(records[i].history());
      } else {
        out.col(Eigen::Index(i)).setConstant(std::numeric_limits<double>::quiet_NaN());
        message_ = records[i].message;
      }
    }
    return out;
  }
  /// Density of theta as a residual each, and its gradient by the coordinate.
  [[nodiscard]] double prior_residual(Eigen::Index k, double x) const {
    const auto& p = priors_[std::size_t(k)];
    if (parameter(k).prior == "lognormal") {  // by its logarithm, as the posterior's mode
      const double value = parameter(k).natural(x);
      return value > 0 ? prior_deviation(parameter(k), value).value() : -no_answer;
    }
    const double lowest = log_top(k) - p.log_density(parameter(k).natural(x));
    return std::isfinite(lowest) ? std::copysign(std::sqrt(std::max(0.0, 2 * lowest)), parameter(k).natural(x) - top(k)) : no_answer;
  }
  /// Points of the design in coordinates, (n_parameters, n): the nominal first.
  [[nodiscard]] Eigen::MatrixXd design(const MultistartOptions& options) const {
    const std::size_t n = options.design_runs + options.design_runs_a_parameter * in_.parameters.size();
    const Eigen::MatrixXd unit = space_filling_points(in_.parameters.size(), n, in_.seed);
    Eigen::MatrixXd x(dimension(), Eigen::Index(n) + 1);
    for (Eigen::Index k = 0; k < dimension(); ++k) {
      const auto& p = parameter(k);
      x(k, 0) = p.coordinate(*p.nominal);
      for (std::size_t i = 0; i < n; ++i)
        x(k, Eigen::Index(i) + 1) = p.coordinate(std::clamp(priors_[std::size_t(k)].quantile(tail + (1 - 2 * tail) * unit(k, Eigen::Index(i))), p.min, p.max));
    }
    return x;
  }
  /// Of natural values, within the bounds.
  [[nodiscard]] Eigen::VectorXd coordinates(std::span<const double> theta) const {
    Eigen::VectorXd x(dimension());
    for (Eigen::Index k = 0; k < x.size(); ++k) x[k] = parameter(k).coordinate(std::clamp(theta[std::size_t(k)], parameter(k).min, parameter(k).max));
    return x;
  }
  [[nodiscard]] const std::string& message() const { return message_; }

 private:
  /// Value of greatest density, within the bounds.
  [[nodiscard]] double top(Eigen::Index k) const {
    const auto& p = parameter(k);
    const double middle = p.mean ? *p.mean : p.prior == "half_cauchy" ? 0.0 : *p.nominal;
    return std::clamp(middle, p.min, p.max);
  }
  [[nodiscard]] double log_top(Eigen::Index k) const {
    const double at_top = priors_[std::size_t(k)].log_density(top(k));
    return std::isfinite(at_top) ? at_top : 0;
  }

  const PosteriorInputs& in_;
  ErrorModel errors_;
  std::vector<Prior> priors_;
  Cholesky factor_;
  Eigen::VectorXd wanted_;
  std::vector<double> width_;
  std::string message_;
  int runs_ = 0;
};

/// The residuals for Ceres: of the records, then of the priors.
class Residuals : public ceres::CostFunction {
 public:
  explicit Residuals(Search& search) : search_(search) {
    set_num_residuals(int(search.values() + search.dimension()));
    mutable_parameter_block_sizes()->push_back(int(search.dimension()));
  }
  bool Evaluate(double const* const* at, double* residuals, double** jacobians) const override {
    const Eigen::Index d = search_.dimension(), n = search_.values();
    const Eigen::Map<const Eigen::VectorXd> x(at[0], d);
    const bool gradients = jacobians && jacobians[0];
    Eigen::MatrixXd points = x.replicate(1, gradients ? d + 1 : 1);
    Eigen::VectorXd step = Eigen::VectorXd::Zero(d);
    if (gradients)
      for (Eigen::Index k = 0; k < d; ++k) {
        step[k] = difference * search_.width(k);
        if (x[k] + step[k] > search_.parameter(k).coordinate(search_.parameter(k).max)) step[k] = -step[k];
        points(k, k + 1) += step[k];
      }
    const Eigen::MatrixXd r = search_.residuals(points);
    if (!r.allFinite()) return false;
    Eigen::Map<Eigen::VectorXd> out(residuals, n + d);
    out.head(n) = r.col(0);
    for (Eigen::Index k = 0; k < d; ++k) out[n + k] = search_.prior_residual(k, x[k]);
    if (!gradients) return true;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> j(jacobians[0], n + d, d);
    j.setZero();
    for (Eigen::Index k = 0; k < d; ++k) {
      j.col(k).head(n) = (r.col(k + 1) - r.col(0)) / step[k];
      j(n + k, k) = (search_.prior_residual(k, x[k] + step[k]) - out[n + k]) / step[k];
    }
    return true;
  }

 private:
  Search& search_;
};

}  // namespace

std::optional<Jitter> jitter_of_the_model(const PosteriorInputs& in) {
  Search search(in, nullptr);
  Eigen::MatrixXd x(search.dimension(), 2);
  for (Eigen::Index k = 0; k < x.rows(); ++k) {
    const Parameter& p = search.parameter(k);
    const double step = nearly * search.width(k), at = p.coordinate(std::clamp(*p.nominal, p.min, p.max));
    x(k, 0) = at;
    x(k, 1) = at + step > p.coordinate(p.max) ? at - step : at + step;
  }
  const Eigen::MatrixXd both = search.compared(x);
  if (!both.allFinite()) return std::nullopt;
  const Eigen::VectorXd apart = both.col(1) - both.col(0);
  return Jitter{.standard_errors = search.whitened(apart).norm(), .variance = 0.5 * apart.squaredNorm()};
}

MultistartFit multistart_least_squares(const PosteriorInputs& in, const MultistartOptions& options) {
  Search search(in, options.errors);
  const Eigen::Index d = search.dimension();
  const Eigen::MatrixXd design = search.design(options);
  const Eigen::MatrixXd r = search.residuals(design);
  std::vector<std::pair<double, Eigen::Index>> order;
  for (Eigen::Index i = 0; i < design.cols(); ++i) {
    double cost = r.col(i).squaredNorm();
    for (Eigen::Index k = 0; k < d; ++k) cost += std::pow(search.prior_residual(k, design(k, i)), 2);
    if (std::isfinite(cost)) order.emplace_back(cost, i);
  }
  if (order.empty() && options.starts.empty()) throw NumericsError("no run of the model succeeded: " + search.message());
  std::sort(order.begin(), order.end());
  std::vector<Eigen::VectorXd> from;
  for (const auto& start : options.starts) from.push_back(search.coordinates(start));
  for (std::size_t s = 0; s < std::min(options.descents, order.size()); ++s) from.emplace_back(design.col(order[s].second));

  MultistartFit out{.theta = {}, .covariance = {}, .ends = {}, .chi2 = 0, .values = search.values(), .runs = 0};
  double best = std::numeric_limits<double>::infinity();
  for (Eigen::VectorXd x : from) {
    ceres::Problem problem;
    problem.AddResidualBlock(new Residuals(search), nullptr, x.data());
    for (Eigen::Index k = 0; k < d; ++k) {
      problem.SetParameterLowerBound(x.data(), int(k), search.parameter(k).coordinate(search.parameter(k).min));
      problem.SetParameterUpperBound(x.data(), int(k), search.parameter(k).coordinate(search.parameter(k).max));
    }
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_QR;
    solver.logging_type = ceres::SILENT;
    solver.max_num_iterations = options.iterations;
    solver.function_tolerance = options.tolerance;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (!summary.IsSolutionUsable()) continue;  // its cost is meaningless: -1 for a start that could not be evaluated
    std::vector<double> end;
    for (Eigen::Index k = 0; k < d; ++k) end.push_back(std::clamp(search.parameter(k).natural(x[k]), search.parameter(k).min, search.parameter(k).max));
    out.ends.push_back(end);
    if (!(summary.final_cost < best)) continue;
    Eigen::VectorXd residuals(search.values() + d);
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> jacobian(residuals.size(), d);
    const double* at = x.data();
    double* gradients = jacobian.data();
    if (!Residuals(search).Evaluate(&at, residuals.data(), &gradients)) continue;
    best = summary.final_cost;
    out.theta = std::move(end);
    // A direction that neither data nor prior know is as wide as the prior.
    Eigen::MatrixXd information = jacobian.transpose() * jacobian;
    for (Eigen::Index k = 0; k < d; ++k) information(k, k) += 1 / std::pow(box_of_prior * search.width(k), 2);
    out.covariance = inverse_symmetric(information);
    out.chi2 = residuals.head(search.values()).squaredNorm();
  }
  if (out.theta.empty()) throw NumericsError("no descent of the model's fit came to an end: " + search.message());
  out.runs = search.runs();
  return out;
}

PosteriorFit held_to_the_model(const PosteriorInputs& in, PosteriorFit fit) {
  const LogPosterior& on_emulator = *fit.posterior;
  const LocalMode& m = fit.modes[0];
  const EmulatorBox& box = on_emulator.box();
  const WeightedErrors& likeliest = fit.likeliest();
  std::optional<MultistartFit> polished;
  try {
    polished = multistart_least_squares(in, {.design_runs = 0,
                                             .design_runs_a_parameter = 0,
                                             .descents = 0,
                                             .iterations = polish_iterations,
                                             .tolerance = polish_tolerance,
                                             .starts = {m.at.theta},
                                             .errors = &likeliest.errors});
  } catch (const NumericsError&) {  // no run succeeded
    return fit;
  }
  // The better one by the model itself: the box may end before the polished one.
  Eigen::VectorXd best;
  LogPosterior::Point at;
  double most = -std::numeric_limits<double>::infinity();
  for (const auto& theta : {m.at.theta, box.nearest(polished->theta)}) {
    const auto records = in.run(Eigen::Map<const Eigen::VectorXd>(theta.data(), Eigen::Index(theta.size())), {0});
    if (!records.at(0).done) continue;
    const auto point = on_emulator.point(on_emulator.q(theta, m.at.beyond));
    const Eigen::VectorXd history = records[0].history();
    const double density = on_emulator.log_likelihood_of(fit.errors->grid().apply(history), 0) + on_emulator.density(point, false).log_prior;
    if (density > most) {
      most = density;
      best = history;
      at = point;
    }
  }
  if (best.size() == 0) return fit;
  fit.coefficients.col(0) += fit.errors->grid().apply(best) - fit.prediction(at);  // of the constant
  fit.noise.setZero();
  fit.posterior.emplace(fit.under(fit.hypotheses));
  fit.modes = {mode_at(*fit.posterior, fit.posterior->q(at.theta, at.beyond))};
  fit.run_at_mode = best;
  return fit;
}

void place_box_by_least_squares(PosteriorInputs& in, const MultistartOptions& options) {
  const MultistartFit start = multistart_least_squares(in, options);
  const double scale = std::sqrt(std::max(1.0, start.chi2 / std::max<double>(1, double(start.values) - double(start.theta.size()))));
  const auto priors = priors_of(in.parameters);
  in.centre = start.theta;
  in.half_width.clear();
  for (std::size_t k = 0; k < in.parameters.size(); ++k) {
    const auto& p = in.parameters[k];
    const double widest = p.coordinate_width(box_of_prior * std::min(priors[k].scale(), p.max - p.min), std::clamp(*p.nominal, p.min, p.max));
    in.half_width.push_back(std::clamp(box_sds * scale * std::sqrt(start.covariance(Eigen::Index(k), Eigen::Index(k))), least_box * widest, widest));
  }
}

}  // namespace calomel
