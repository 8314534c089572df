#pragma once
/// The course of a diagnosis, for diagnosis.cpp (questions, verdict, location) and engine_fits.cpp (fits of explanations).
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/linear_algebra.hpp"
#include "uq/diagnosis/candidate_fit.hpp"
#include "uq/diagnosis/diagnosis.hpp"
#include "uq/diagnosis/linearised.hpp"
#include "uq/diagnosis/told_moments.hpp"

namespace calomel {

/// An explanation as it was fitted: what a further one is put on top of.
struct Fitted {
  std::vector<AddedParameter> added;  ///< in the order of the fit's parameters, behind the base model's
  PosteriorInputs inputs;
  PosteriorFit fit;
};

/// One diagnosis, from the base fit to what is missing. What is referred to outlives it.
class DiagnosisEngine {
 public:
  explicit DiagnosisEngine(const DiagnosisInputs& in) : in_(in), own_(in.base.problem.shape.parameters.size()), groups_(in.groups) {}

  Diagnosis run();

 private:
  static constexpr int most_linearised = 4;   ///< times that many small numbers are linearised anew
  static constexpr double worth_fitting = 3;  ///< log Bayes factor to first order
  static constexpr double hopeless =
      2 * Gates{}.lead;  ///< log Bayes factors below the best so far: twice the lead that a name needs, as first order is not exact

  /// A history as it is kept, and as it is reckoned with.
  static std::vector<double> kept(const Eigen::VectorXd& v) { return {v.begin(), v.end()}; }
  static Eigen::Map<const Eigen::VectorXd> values(const std::vector<double>& v) { return {v.data(), Eigen::Index(v.size())}; }
  void say(const std::string& text) const {
    if (in_.say) in_.say(text);
  }
  /// Tells what is not done, once.
  void skip(std::string what) {
    if (std::find(out_.skipped.begin(), out_.skipped.end(), what) == out_.skipped.end()) out_.skipped.push_back(std::move(what));
  }
  [[nodiscard]] const LocalMode& mode() const { return out_.base.modes[0]; }
  [[nodiscard]] const Decimation& grid() const { return out_.base.errors->grid(); }
  std::vector<RunRecord> counted(const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> added) {
    runs_ += int(level.size());
    return in_.run(thetas, level, added);
  }
  /// Errors without any discrepancy of a fit at its mode: those of the records and of its emulator.
  [[nodiscard]] static Cholesky plain_errors(const PosteriorFit& fit, const LogPosterior& posterior, const LocalMode& m, const ErrorModel& errors) {
    return Cholesky(errors.covariance() + posterior.density(m.at, false).variance * fit.noise);
  }
  [[nodiscard]] static double chi2(const Cholesky& plain, const ErrorModel& errors, const PosteriorFit& fit, const LocalMode& m) {
    return plain.solve_lower(Eigen::VectorXd(errors.data() - fit.prediction(m.at))).squaredNorm();
  }
  /// |history - record| / |record|, mean over the gauges, in the band that is compared.
  [[nodiscard]] double misfit(const Eigen::VectorXd& history) const { return misfit_of_all(grid(), grid().apply(history), out_.base.errors->data()); }
  /// Distances of the case's own parameters from the middle of their priors, in standard deviations; 0 of one that has no handbook's.
  [[nodiscard]] std::vector<double> pulls(std::span<const double> theta) const {
    std::vector<double> all;
    for (std::size_t k = 0; k < own_; ++k) all.push_back(prior_deviation(in_.base.parameters[k], theta[k]).value_or(0));
    return all;
  }
  [[nodiscard]] static double root_mean_square(const std::vector<double>& x) {
    double sum = 0;
    for (const double v : x) sum += v * v;
    return x.empty() ? 0 : std::sqrt(sum / double(x.size()));
  }
  [[nodiscard]] std::vector<Estimate> own_parameters(const LogPosterior& posterior, const Moments& moments) const {
    std::vector<Estimate> all;
    for (std::size_t i = 0; i < posterior.free().size(); ++i) {
      const auto k = std::size_t(posterior.free()[i]);
      if (k < own_) all.push_back({in_.base.parameters[k].name, moments.mean[Eigen::Index(i)], moments.sd[Eigen::Index(i)]});
    }
    return all;
  }

  /// A number that is added, in the case's unit where it is a share of another, which these parameters of the case's own have or else the case.
  [[nodiscard]] Estimate told(const AddedParameter& a, double mean, double sd, const std::vector<Estimate>& own) const;
  [[nodiscard]] double best_so_far() const {
    double best = 0;
    for (const auto& c : out_.candidates)
      if (c.explanation.fitted) best = std::max(best, c.explanation.log_bayes_factor);
    return best;
  }
  [[nodiscard]] bool puzzled() const { return out_.evidence.chi2 > greatest_plausible(out_.evidence); }
  /// Whether an explanation of this log Bayes factor could lead what was fitted so far.
  [[nodiscard]] bool may_lead(double worth) const { return worth > worth_fitting && worth > best_so_far() - hopeless; }
  void describe_base();
  void describe_places();
  [[nodiscard]] QuestionInputs about(const PosteriorFit& fit, std::vector<AddedParameter> added, const std::vector<ParameterGroup>& groups);
  void explain();
  void ask_all();
  void ask_clock();
  void fit_terms();
  void follow_terms();
  void fit_linear(const Question& q, const Alternative* on_top_of = nullptr, int rounds = most_linearised);
  std::optional<Alternative> linear_fit(Linearised& about, const Alternative* on_top_of);
  bool linearise(Linearised& about, const Alternative* on_top_of);
  [[nodiscard]] Alternative to_first_order(const Question& q) const;
  void fit_leaders();
  void fit_pair();
  void fit(const Question& q, const Alternative* on_top_of = nullptr);
  void fit_best_of(const Question& q);
  void fit_fault(const Question& q, const Alternative* on_top_of = nullptr);
  void fit_gauge(const Question& q);
  [[nodiscard]] Question of_its_own(Question q);
  void judge_all();
  void hold_out_base();
  void hold_out(Alternative& c);
  void keep(HeldOutFit with, Alternative& c);
  void hold_out_verdict();
  void locate_all();
  void describe_missing();

  const DiagnosisInputs& in_;
  const std::size_t own_;               ///< the case's own parameters
  std::vector<ParameterGroup> groups_;  ///< those that are offered, and behind them the parts of single gauges that are fitted
  Diagnosis out_;
  Eigen::MatrixXd places_;
  std::vector<Question> asked_;         ///< most telling first
  std::map<std::string, Fitted> fits_;  ///< of candidates by name
  std::optional<HeldOut> held_out_;
  int runs_ = 0;
  bool ended_ = false;  ///< by the budget, the fit under way: the fits that are kept hold their run function, which outlives fit()
};

}  // namespace calomel
