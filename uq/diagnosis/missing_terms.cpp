#include "uq/diagnosis/missing_terms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "uq/diagnosis/held_out.hpp"
#include "uq/diagnosis/verdict.hpp"

namespace calomel {

namespace {

constexpr std::size_t most_terms = 3;
constexpr double worth_telling = Gates{}.lead;  ///< log Bayes factor: what a name has to lead by

AddedDirections joined(const std::vector<const Question*>& questions) {
  AddedDirections all;
  all.by_number.resize(questions[0]->directions.by_number.rows(), Eigen::Index(questions.size())), all.prior_sd.resize(Eigen::Index(questions.size()));
  for (std::size_t i = 0; i < questions.size(); ++i) {
    all.by_number.col(Eigen::Index(i)) = questions[i]->directions.by_number.col(0);
    all.prior_sd[Eigen::Index(i)] = questions[i]->directions.prior_sd[0];
  }
  return all;
}

class Telling {
 public:
  explicit Telling(const QuestionInputs& in) : in_(in), mode_(in.fit.modes[0]), first_order_(*in.fit.posterior, mode_) {}

  MissingTerms told() {
    Answers answers = ask(in_);
    questions_ = std::move(answers.questions), out_.asked = questions_.size();
    std::map<std::string, std::size_t> reasons;  // behind the term's label
    for (const auto& s : answers.skipped) ++reasons[s.substr(s.find(": ") + 2)];
    for (const auto& [reason, count] : reasons) out_.skipped.push_back(fmt::format("{} of {} terms: {}", count, in_.groups.size(), reason));
    while (taken_.size() < most_terms && take_next()) continue;
    for (std::size_t i = 0; i < taken_.size(); ++i) out_.terms[i].value = worth_.value[Eigen::Index(i)], out_.terms[i].sd = worth_.sd[Eigen::Index(i)];
    if (!taken_.empty()) run_with_them();
    return std::move(out_);
  }

 private:
  /// The one that says most beside those that are taken, where it says enough.
  bool take_next() {
    const Question* best = nullptr;
    FirstOrder with_best;
    double most = worth_telling;
    for (const auto& q : questions_) {
      if (std::find(taken_.begin(), taken_.end(), &q) != taken_.end()) continue;
      std::vector<const Question*> with = taken_;
      with.push_back(&q);
      FirstOrder worth = first_order_.worth(joined(with));
      const Parameter& number = in_.groups[q.group].added[0].parameter;
      const double gain = worth.log_bayes_factor - worth_.log_bayes_factor - std::log(double(questions_.size())),
                   value = *number.nominal + worth.value[worth.value.size() - 1];
      if (gain > most && value >= number.min && value <= number.max)
        most = gain, best = &q, with_best = std::move(worth);  // what no law allows is no description
    }
    if (!best) return false;
    taken_.push_back(best), worth_ = std::move(with_best);
    const ParameterGroup& group = in_.groups[best->group];
    out_.terms.push_back({.what = group.name, .place = group.place, .unit = group.added[0].unit, .log_bayes_factor = most});
    return true;
  }

  void run_with_them() {
    LogPosterior::Point at = mode_.at;
    for (Eigen::Index k = 0; k < worth_.shift.size(); ++k) at = in_.fit.posterior->moved(at, k, worth_.shift[k]);
    const auto own = Eigen::Index(at.theta.size()), n = Eigen::Index(taken_.size());
    std::vector<AddedParameter> added;
    Eigen::MatrixXd thetas(own + n, 2);
    for (Eigen::Index k = 0; k < own; ++k) {
      const Prior& prior = in_.fit.posterior->priors()[std::size_t(k)];
      thetas(k, 0) = mode_.at.theta[std::size_t(k)], thetas(k, 1) = std::clamp(at.theta[std::size_t(k)], prior.low(), prior.high());
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      const AddedParameter& a = in_.groups[taken_[std::size_t(i)]->group].added[0];
      added.push_back(a);
      thetas(own + i, 0) = *a.parameter.nominal, thetas(own + i, 1) = std::clamp(*a.parameter.nominal + worth_.value[i], a.parameter.min, a.parameter.max);
    }
    const auto records = in_.run(thetas, {in_.level, in_.level}, added);
    for (const auto& r : records)
      if (!r.done) {
        out_.skipped.push_back("a run with the terms that were found: " + r.message);
        return;
      }
    const Decimation& grid = in_.fit.errors->grid();
    const Eigen::VectorXd& data = in_.fit.errors->data();
    const Eigen::VectorXd base = grid.apply(in_.fit.history_at_mode()), change = grid.apply(Eigen::VectorXd(records[1].history() - records[0].history()));
    out_.misfit_before = misfit_of_all(grid, base, data);
    out_.misfit_after = misfit_of_all(grid, base + change, data);
  }

  const QuestionInputs& in_;
  const LocalMode& mode_;
  const FirstOrderModel first_order_;
  std::vector<Question> questions_;
  std::vector<const Question*> taken_;
  FirstOrder worth_;  ///< of those that are taken
  MissingTerms out_;
};

}  // namespace

MissingTerms missing_terms(const QuestionInputs& in) { return Telling(in).told(); }

int missing_terms_runs(const std::vector<ParameterGroup>& groups) {
  int runs = 3;  // the base model's own mode, and the two at the end
  for (const auto& g : groups) runs += int(g.added.at(0).strengths.size());
  return runs;
}

}  // namespace calomel
