#include "uq/diagnosis/missing_terms.hpp"

#include <algorithm>
#include <cmath>

#include "uq/diagnosis/held_out.hpp"
#include "uq/diagnosis/verdict.hpp"

namespace calomel {

namespace {

constexpr std::size_t most_terms = 3;
constexpr double least_of_a_term = Gates{}.lead;  ///< log Bayes factor: what a name has to lead by

AddedDirections joined_directions(const std::vector<const ScreenedCandidate*>& terms) {
  const auto n = Eigen::Index(terms.size());
  AddedDirections all;
  all.by_number.resize(terms[0]->directions.by_number.rows(), n);
  all.prior_sd.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    all.by_number.col(i) = terms[std::size_t(i)]->directions.by_number.col(0);
    all.prior_sd[i] = terms[std::size_t(i)]->directions.prior_sd[0];
  }
  return all;
}

/// The selection of terms, from the screening to the run with those that were taken.
class TermSelection {
 public:
  explicit TermSelection(const ScreeningInputs& in) : in_(in), mode_(in.fit.modes[0]), first_order_(*in.fit.posterior, mode_) {}

  MissingTerms select() {
    ScreeningResult result = screen_candidates(in_);
    screened_ = std::move(result.candidates);
    out_.screened = screened_.size();
    out_.offered = in_.groups.size();
    out_.not_screened = std::move(result.not_screened);
    while (taken_.size() < most_terms && take_next()) continue;
    for (std::size_t i = 0; i < taken_.size(); ++i) {
      out_.terms[i].value = estimate_.value[Eigen::Index(i)];
      out_.terms[i].sd = estimate_.sd[Eigen::Index(i)];
    }
    if (!taken_.empty()) run_with_terms();
    return std::move(out_);
  }

 private:
  /// Takes the term with the greatest evidence beside those that are taken, where that is enough.
  bool take_next() {
    const ScreenedCandidate* best = nullptr;
    FirstOrderEstimate with_best;
    double most = least_of_a_term;
    for (const auto& candidate : screened_) {
      if (std::find(taken_.begin(), taken_.end(), &candidate) != taken_.end()) continue;
      std::vector<const ScreenedCandidate*> with = taken_;
      with.push_back(&candidate);
      FirstOrderEstimate estimate = first_order_.estimate(joined_directions(with));
      const Parameter& number = in_.groups[candidate.group].added[0].parameter;
      const double gain = estimate.log_bayes_factor - estimate_.log_bayes_factor - std::log(double(screened_.size()));
      const double value = *number.nominal + estimate.value[estimate.value.size() - 1];
      if (!(gain > most) || value < number.min || value > number.max) continue;  // a number that no law allows is no description
      most = gain;
      best = &candidate;
      with_best = std::move(estimate);
    }
    if (!best) return false;
    taken_.push_back(best);
    estimate_ = std::move(with_best);
    const ParameterGroup& group = in_.groups[best->group];
    out_.terms.push_back({.what = group.name, .place = group.place, .unit = group.added[0].unit, .log_bayes_factor = most});
    return true;
  }

  void run_with_terms() {
    LogPosterior::Point at = mode_.at;
    for (Eigen::Index k = 0; k < estimate_.shift.size(); ++k) at = in_.fit.posterior->moved(at, k, estimate_.shift[k]);
    const auto own = Eigen::Index(at.theta.size()), n = Eigen::Index(taken_.size());
    std::vector<AddedParameter> added;
    Eigen::MatrixXd thetas(own + n, 2);  // without the terms and with them
    for (Eigen::Index k = 0; k < own; ++k) {
      const Prior& prior = in_.fit.posterior->priors()[std::size_t(k)];
      thetas(k, 0) = mode_.at.theta[std::size_t(k)];
      thetas(k, 1) = std::clamp(at.theta[std::size_t(k)], prior.low(), prior.high());
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      const AddedParameter& a = in_.groups[taken_[std::size_t(i)]->group].added[0];
      added.push_back(a);
      thetas(own + i, 0) = *a.parameter.nominal;
      thetas(own + i, 1) = std::clamp(*a.parameter.nominal + estimate_.value[i], a.parameter.min, a.parameter.max);
    }
    const auto records = in_.run(thetas, {in_.level, in_.level}, added);
    for (const auto& r : records)
      if (!r.done) {
        out_.run_failure = r.message;
        return;
      }
    const Decimation& grid = in_.fit.errors->grid();
    const Eigen::VectorXd& data = in_.fit.errors->data();
    const Eigen::VectorXd base = grid.apply(in_.fit.history_at_mode());
    const Eigen::VectorXd change = grid.apply(Eigen::VectorXd(records[1].history() - records[0].history()));
    out_.misfit_before = misfit_of_all(grid, base, data);
    out_.misfit_after = misfit_of_all(grid, base + change, data);
  }

  const ScreeningInputs& in_;
  const LocalMode& mode_;
  const FirstOrderModel first_order_;
  std::vector<ScreenedCandidate> screened_;
  std::vector<const ScreenedCandidate*> taken_;
  FirstOrderEstimate estimate_;  ///< of those that are taken
  MissingTerms out_;
};

}  // namespace

MissingTerms missing_terms(const ScreeningInputs& in) { return TermSelection(in).select(); }

int missing_terms_runs(const std::vector<ParameterGroup>& groups) {
  int runs = 3;  // the base model's own mode, and the two at the end
  for (const auto& g : groups) runs += int(g.added.at(0).strengths.size());
  return runs;
}

}  // namespace calomel
