#pragma once
/// What a fit to some gauges predicts of the others.
#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "inverse/posterior/posterior_fit.hpp"
#include "uq/diagnosis/first_order.hpp"

namespace calomel {

/// Values of the grid that are held out together: whole records, or a stretch of one.
struct Fold {
  std::vector<Eigen::Index> rows;  ///< ascending
  double records = 0;              ///< how many, parts counted as such
};

/// Gauges of one face of the target are held out together, where they sit on three faces or more; else, and where there are no faces, each alone, with all that
/// it recorded. A single record is held out in four parts of its time.
[[nodiscard]] std::vector<Fold> folds_by_face(const Problem& problem, const Decimation& grid, const GaugePlaces& places);

/// Those of whole observations.
[[nodiscard]] Fold fold_of(const Decimation& grid, const std::vector<std::size_t>& observations);

/// Rows of the grid that belong to some observations, in their order on it.
[[nodiscard]] std::vector<Eigen::Index> rows_of(const Decimation& grid, const std::vector<std::size_t>& observations);

/// The posterior of a fit by some of the values, on its own emulator, under the errors of another fit (or its own).
[[nodiscard]] LogPosterior part_of(const PosteriorFit& fit, const std::vector<WeightedErrors>& hypotheses, const std::vector<Eigen::Index>& rows);

/// A fit without some of its values.
struct PartFit {
  double log_evidence = 0;
  Eigen::VectorXd prediction;  ///< of all values, (size): by the mode of the rest
  Eigen::VectorXd history;     ///< of the model, (values of the model), by the mode of the rest
};

/// The mode and the evidence by the values of all but the fold, from the fit's own modes. Errors: NumericsError where no mode is found.
[[nodiscard]] PartFit fit_without(const PosteriorFit& fit, const PosteriorFit& errors, const Fold& fold);

/// Mean over the fold's observations of the root mean square of (prediction - record) over the record's size on the grid: its root mean square, at most
/// greatest_amplitude; of a part of a record, over that of the whole.
[[nodiscard]] double misfit_of(const Fold& fold, const Decimation& grid, const Eigen::VectorXd& prediction, const Eigen::VectorXd& data);

/// The same of all values.
[[nodiscard]] double misfit_of_all(const Decimation& grid, const Eigen::VectorXd& prediction, const Eigen::VectorXd& data);

/// Puts what the fold holds of a history, (values of the model), in its place of another; one that is empty becomes NaN for all others first.
void keep_held_out(const Fold& fold, const Decimation& grid, const Problem& problem, const Eigen::VectorXd& history, std::vector<double>& into);

/// What an explanation says of records that it was not shown.
struct HeldOutFit {
  std::vector<double> misfit;   ///< (folds)
  std::vector<double> worth;    ///< (folds) log Bayes factor over the base model by the records that are left
  std::vector<double> history;  ///< (values of the model): each gauge by the fit without it
};

/// Numbers beside a fit whose effect on the model's values is rest + effects . numbers.
struct LinearBeside {
  const PosteriorFit& fit;
  const std::vector<WeightedErrors>&without, &with;  ///< hypotheses about the records less `rest`: the fit's, and those with the numbers as one more term
  const AddedDirections& directions;                 ///< `effects` on the grid
  const Eigen::MatrixXd& effects;                    ///< (values of the model, numbers)
  const Eigen::VectorXd& rest;                       ///< (values of the model)
};

/// Misfit of all records of a condition (a beam power) by the fit to the other conditions.
struct HeldOutCondition {
  std::string name;
  double before = 0, after = 0;  ///< by the base model, and by the model with what is named; the same where nothing is
};

/// The folds of a case, and the base model's own misfit on them. What is referred to outlives it.
class HeldOut {
 public:
  HeldOut(const Problem& problem, const PosteriorFit& base, const GaugePlaces& places);
  /// Of the base model; its worth is 0.
  [[nodiscard]] const HeldOutFit& base() const { return base_fit_; }
  [[nodiscard]] HeldOutFit by(const PosteriorFit& fit) const;
  /// Of such numbers beside the fit that they stand on.
  [[nodiscard]] HeldOutFit by(const LinearBeside& linear) const;
  /// Misfit of the first quarter of all records by what is told by the rest of them: by what such numbers stand on, and with them.
  [[nodiscard]] std::pair<double, double> beginning(const LinearBeside& linear) const;
  /// Misfit of what is left out, each fold by this fit without it, mean over the records.
  [[nodiscard]] double misfit_by(const PosteriorFit& fit) const { return &fit == &base_ ? mean(base_fit_.misfit) : mean(left_out(fit).misfit); }
  /// Each condition by the fits to the others, where there are several; `named`: of the model with what is named, or null.
  [[nodiscard]] std::vector<HeldOutCondition> by_condition(const PosteriorFit* named) const;
  /// Whether anything can be left out: a single record of a few values cannot.
  [[nodiscard]] bool possible() const { return !folds_.empty(); }
  /// The mean over the records of what is told of folds, (folds); NaN where there is none.
  [[nodiscard]] double mean(const std::vector<double>& by_fold) const;

 private:
  /// Misfits and history of a fit, and its evidences.
  [[nodiscard]] HeldOutFit left_out(const PosteriorFit& fit) const;
  /// What such numbers and the rest of the records say of a fold.
  [[nodiscard]] PartFit fit_without_fold(const LinearBeside& linear, const Fold& f) const;
  const Problem& problem_;
  const PosteriorFit& base_;
  std::vector<Fold> folds_;
  HeldOutFit base_fit_;
};

}  // namespace calomel
