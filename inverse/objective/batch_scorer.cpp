#include "inverse/objective/batch_scorer.hpp"

#include <algorithm>

namespace calomel {

namespace {

constexpr std::size_t of_line = sizeof(AlignedLine) / sizeof(float);
float* floats(std::vector<AlignedLine>& lines) { return lines.data()->x; }
const float* floats(const std::vector<AlignedLine>& lines) { return lines.data()->x; }

}  // namespace

BatchScorer::BatchScorer(const Problem& problem, const HistoryBasis& basis, InstructionSet isa)
    : isa_(isa), rank_(basis.directions.cols()), mae_scale_(problem.mae_scale) {
  expect(std::size_t(basis.offset.size()) == problem.shape.values() && basis.directions.rows() == basis.offset.size(), "a basis is of a model's whole output");
  std::ptrdiff_t panels = 0;
  for (const auto& o : problem.observations) {
    const auto count = (std::ptrdiff_t(o.samples) + panel_rows - 1) / panel_rows;
    observed_.push_back({panels, count, size_of(o)});
    panels += count;
  }
  directions_.resize(std::size_t(panels * rank_ * panel_rows) / of_line + 1);
  rows_.resize(std::size_t(panels * 4 * panel_rows) / of_line);
  std::vector<std::size_t> compared;
  for (std::size_t i = 0; i < observed_.size(); ++i) {
    const auto& o = problem.observations[i];
    const std::size_t at = problem.shape.at(o.condition, o.sensor, 0);
    compared.clear();
    for (std::size_t t = 0; t < o.mean.size(); ++t)
      if (o.compared[t]) compared.push_back(t);
    const auto on_record = [&](const float* history, std::size_t t) {
      const Stencil& s = problem.stencils[t];
      double sum = 0;
      for (std::size_t j = 0; j < 4; ++j)
        if (s.weight[j] != 0) sum += s.weight[j] * double(history[at + s.index[j]]);
      return sum;
    };
    float* rows = floats(rows_) + observed_[i].first * 4 * panel_rows;
    for (std::size_t r = 0; r < compared.size(); ++r) {
      const std::size_t t = compared[r];
      float* row = rows + std::ptrdiff_t(r) / panel_rows * 4 * panel_rows + std::ptrdiff_t(r) % panel_rows;
      row[0] = float(on_record(basis.offset.data(), t) - o.mean[t]);
      if (o.banded[t]) {
        row[panel_rows] = float(o.low[t] - o.mean[t]);
        row[2 * panel_rows] = float(o.high[t] - o.mean[t]);
        row[3 * panel_rows] = float(1 / (o.high[t] - o.low[t]));
      }
    }
    float* directions = floats(directions_) + observed_[i].first * rank_ * panel_rows;
    for (std::ptrdiff_t k = 0; k < rank_; ++k)
      for (std::size_t r = 0; r < compared.size(); ++r)
        directions[(std::ptrdiff_t(r) / panel_rows * rank_ + k) * panel_rows + std::ptrdiff_t(r) % panel_rows] =
            float(on_record(basis.directions.col(k).data(), compared[r]));
  }
}

BatchScore BatchScorer::score(const Eigen::MatrixXf& coefficients) const {
  expect(coefficients.rows() == rank_, "a coefficient for each direction");
  const std::ptrdiff_t n = coefficients.cols();
  const ScoreKernel& kernel = score_kernel(isa_);
  std::vector<float> tiles;  // (tile, rank, columns of the tile)
  tiles.reserve(std::size_t(rank_ * n));
  for (std::ptrdiff_t first = 0; first < n; first += kernel.most)
    for (std::ptrdiff_t k = 0; k < rank_; ++k)
      for (std::ptrdiff_t c = first; c < std::min(n, first + kernel.most); ++c) tiles.push_back(coefficients(k, c));
  std::vector<AlignedLine> scratch(std::size_t(n) * score_scratch / of_line);
  std::vector<ScoreSums> sums(static_cast<std::size_t>(n));
  BatchScoreSum out(std::size_t(n), mae_scale_);
  for (const auto& o : observed_) {
    kernel.score(
        {.panels = o.panels, .rank = rank_, .directions = floats(directions_) + o.first * rank_ * panel_rows, .rows = floats(rows_) + o.first * 4 * panel_rows},
        tiles.data(), n, sums.data(), floats(scratch));
    out.add(o.size, sums);
  }
  return std::move(out).averages();
}

double BatchScorer::product_operations() const {
  double rows = 0;
  for (const auto& o : observed_) rows += o.size.samples;
  return 2 * rows * double(rank_);
}

BatchCost::BatchCost(const Problem& problem, const ForwardModel& model, const Objective& objective) : problem_(problem), model_(model), objective_(objective) {
  if (const HistoryBasis basis = model.basis(); !basis.empty()) scorer_.emplace(problem, basis);
}

std::vector<double> BatchCost::operator()(const Eigen::MatrixXd& points) const {
  return scorer_ ? objective_.costs(scorer_->score(model_.coefficients(points))) : objective_.costs(problem_, model_.means(points, 1));
}

}  // namespace calomel
