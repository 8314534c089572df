#pragma once
/// Hold-out predictions: a fit to some gauges predicts the others.
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
  double records = 0;              ///< number of records, parts counted as such
};

/// The folds of a case. Gauges of one face of the target are held out together, where they sit on three faces or more; else, and where there are no faces, each
/// gauge alone, with all that it recorded. A single record is held out in four parts of its time.
[[nodiscard]] std::vector<Fold> folds_by_face(const Problem& problem, const Decimation& grid, const GaugePlaces& places);

/// The fold of whole observations.
[[nodiscard]] Fold fold_of(const Decimation& grid, const std::vector<std::size_t>& observations);

/// Rows of the grid that belong to some observations, in their order on it.
[[nodiscard]] std::vector<Eigen::Index> rows_of(const Decimation& grid, const std::vector<std::size_t>& observations);

/// The posterior of a fit by some of the values, on its own emulator, under the errors of another fit (or its own).
[[nodiscard]] LogPosterior part_of(const PosteriorFit& fit, const std::vector<WeightedErrors>& hypotheses, const std::vector<Eigen::Index>& rows);

/// A fit without some of its values.
struct PartFit {
  double log_evidence = 0;
  Eigen::VectorXd prediction;  ///< all values by the mode of the rest, (size)
  Eigen::VectorXd history;     ///< the model by the mode of the rest, (values of the model)
};

/// The mode and the evidence by the values of all but the fold, from the fit's own modes. Errors: NumericsError where no mode is found.
[[nodiscard]] PartFit fit_without(const PosteriorFit& fit, const PosteriorFit& errors, const Fold& fold);

/// Mean over the fold's observations of the root mean square of (prediction - record) over the record's size on the grid: its root mean square, at most
/// greatest_amplitude. A part of a record is divided by the size of the whole.
[[nodiscard]] double misfit_of(const Fold& fold, const Decimation& grid, const Eigen::VectorXd& prediction, const Eigen::VectorXd& data);

/// The same of all values.
[[nodiscard]] double misfit_of_all(const Decimation& grid, const Eigen::VectorXd& prediction, const Eigen::VectorXd& data);

/// Puts the fold's part of a history, (values of the model), in its place of another. An empty one is filled with NaN first.
void keep_held_out(const Fold& fold, const Decimation& grid, const Problem& problem, const Eigen::VectorXd& history, std::vector<double>& into);

/// Hold-out predictions of one explanation.
struct HeldOutFit {
  std::vector<double> misfit;            ///< (folds)
  std::vector<double> log_bayes_factor;  ///< over the base model by the records outside of the fold, (folds)
  std::vector<double> history;           ///< (values of the model): each gauge by the fit without it
};

/// Numbers beside a fit whose effect on the model's values is rest + effects . numbers.
struct LinearBeside {
  const PosteriorFit& fit;
  const std::vector<WeightedErrors>&without, &with;  ///< hypotheses about the records less `rest`: the fit's, and the same with the numbers as one more term
  const AddedDirections& directions;                 ///< `effects` on the grid
  const Eigen::MatrixXd& effects;                    ///< (values of the model, numbers)
  const Eigen::VectorXd& rest;                       ///< (values of the model)
};

/// Misfit of all records of a condition (a beam power) by the fit to the other conditions.
struct HeldOutCondition {
  std::string name;
  double before = 0, after = 0;  ///< by the base model, and by the model with what is named; the same where nothing is
};

/// The folds of a case, and the base model's own misfit on them. All that is referred to outlives it.
class HeldOut {
 public:
  HeldOut(const Problem& problem, const PosteriorFit& base, const GaugePlaces& places);
  /// Predictions of the base model; its log Bayes factors are 0.
  [[nodiscard]] const HeldOutFit& base() const { return base_fit_; }
  [[nodiscard]] HeldOutFit by(const PosteriorFit& fit) const;
  /// Predictions of such numbers beside the fit that they are added to.
  [[nodiscard]] HeldOutFit by(const LinearBeside& linear) const;
  /// Misfit of the first quarter of all records, predicted from the rest of them: by the fit that such numbers are added to, and with them.
  [[nodiscard]] std::pair<double, double> beginning(const LinearBeside& linear) const;
  /// Misfit of the held-out records, each fold by this fit without it, mean over the records.
  [[nodiscard]] double misfit_by(const PosteriorFit& fit) const { return &fit == &base_ ? mean(base_fit_.misfit) : mean(left_out(fit).misfit); }
  /// Each condition by the fits to the others, where there are several. `named`: fit of the model with what is named, or null.
  [[nodiscard]] std::vector<HeldOutCondition> by_condition(const PosteriorFit* named) const;
  /// Whether anything can be held out: a single record of a few values cannot.
  [[nodiscard]] bool possible() const { return !folds_.empty(); }
  /// Mean over the records of a value of each fold, (folds); NaN where there is none.
  [[nodiscard]] double mean(const std::vector<double>& by_fold) const;

 private:
  /// Misfits and history of a fit, and its log evidences in place of Bayes factors.
  [[nodiscard]] HeldOutFit left_out(const PosteriorFit& fit) const;
  /// The fit of such numbers to the records outside of a fold.
  [[nodiscard]] PartFit fit_without_fold(const LinearBeside& linear, const Fold& f) const;
  const Problem& problem_;
  const PosteriorFit& base_;
  std::vector<Fold> folds_;
  HeldOutFit base_fit_;
};

}  // namespace calomel
