#include "uq/sensitivity/morris.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/errors.hpp"
#include "base/random.hpp"

namespace calomel {

Eigen::MatrixXd morris_design(std::size_t dimensions, std::size_t trajectories, int levels, std::uint64_t seed) {
  expect(levels >= 2 && levels % 2 == 0, "an even number of levels");
  const auto d = Eigen::Index(dimensions);
  const int delta = levels / 2;  // in grid steps; values are divided last, so that steps are equal to the last digit
  Eigen::MatrixXd out(d, Eigen::Index(trajectories) * (d + 1));
  for (std::size_t r = 0; r < trajectories; ++r) {
    RandomStream random(seed, 0x3031 + r);
    Eigen::VectorXi at(d);
    std::vector<Eigen::Index> order(dimensions);
    std::iota(order.begin(), order.end(), 0);
    for (std::size_t k = dimensions; k > 1; --k) std::swap(order[k - 1], order[std::min(k - 1, std::size_t(random.uniform() * double(k)))]);
    for (Eigen::Index k = 0; k < d; ++k) at[k] = std::min(levels - 1, int(random.uniform() * levels));
    Eigen::Index column = Eigen::Index(r) * (d + 1);
    const auto put = [&] { out.col(column++) = at.cast<double>() / double(levels - 1); };
    put();
    for (const auto k : order) {
      at[k] += at[k] + delta < levels ? delta : -delta;
      put();
    }
  }
  return out;
}

std::vector<std::vector<MorrisEffect>> morris_effects(const Eigen::MatrixXd& design, const Eigen::MatrixXd& values) {
  const Eigen::Index d = design.rows();
  std::vector<std::vector<MorrisEffect>> out;
  for (Eigen::Index q = 0; q < values.rows(); ++q) {
    std::vector<std::vector<double>> effects(static_cast<std::size_t>(d));
    for (Eigen::Index i = 0; i + 1 < design.cols(); ++i) {
      if ((i + 1) % (d + 1) == 0 || !std::isfinite(values(q, i)) || !std::isfinite(values(q, i + 1)))
        continue;  // the step leads from one trajectory to the next, or a value is missing
      const Eigen::VectorXd step = design.col(i + 1) - design.col(i);
      Eigen::Index k = 0;
      step.cwiseAbs().maxCoeff(&k);
      effects[std::size_t(k)].push_back((values(q, i + 1) - values(q, i)) / step[k]);
    }
    std::vector<MorrisEffect> one(static_cast<std::size_t>(d));
    for (std::size_t k = 0; k < one.size(); ++k) {
      const auto n = double(effects[k].size());
      if (n == 0) continue;
      double mean = 0;
      double absolute = 0;
      for (const double e : effects[k]) {
        mean += e / n;
        absolute += std::abs(e) / n;
      }
      double squares = 0;
      double absolute_squares = 0;
      for (const double e : effects[k]) {
        squares += std::pow(e - mean, 2);
        absolute_squares += std::pow(std::abs(e) - absolute, 2);
      }
      one[k].mu = mean;
      one[k].mu_star = absolute;
      if (n <= 1) continue;
      one[k].sigma = std::sqrt(squares / (n - 1));
      one[k].mu_star_se = std::sqrt(absolute_squares / (n - 1) / n);
    }
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace calomel
