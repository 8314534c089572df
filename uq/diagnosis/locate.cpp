#include "uq/diagnosis/locate.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/linear_algebra.hpp"

namespace calomel {

namespace {

constexpr int windows = 8;
constexpr int bands = 6;
constexpr double significant_q = 0.05;  ///< q-value

struct Tested {
  double score, p_value;
};
constexpr Tested untested{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};  ///< of a part without values

Tested tested(const Eigen::MatrixXd& rows, const Eigen::VectorXd& residual, const Eigen::MatrixXd& covariance) {
  if (rows.rows() == 0) return untested;
  const Cholesky factor(rows * covariance * rows.transpose());
  if (!factor.positive_definite()) return untested;
  const double k = double(rows.rows()), q = factor.solve_lower(Eigen::VectorXd(rows * residual)).squaredNorm();
  return {q / k, boost::math::cdf(boost::math::complement(boost::math::chi_squared(k), q))};
}

/// Rows of the unit matrix.
Eigen::MatrixXd unit_rows(const std::vector<Eigen::Index>& at, Eigen::Index n) {
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(Eigen::Index(at.size()), n);
  for (std::size_t i = 0; i < at.size(); ++i) b(Eigen::Index(i), at[i]) = 1;
  return b;
}

/// Rows of the cosine transform of one gauge's values in a band: coefficient m of N values that are dt apart is the frequency m / (2 N dt).
Eigen::MatrixXd cosine_rows(const Decimation& grid, std::size_t i, int band) {
  const auto count = grid.windows(i).size();
  std::vector<double> shares;
  for (std::size_t m = 0; m < count; ++m)
    if (const double share = double(m) / double(count); share >= double(band) / bands && share < double(band + 1) / bands) shares.push_back(share);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(Eigen::Index(shares.size()), Eigen::Index(grid.size()));
  for (std::size_t r = 0; r < shares.size(); ++r)
    for (std::size_t k = 0; k < count; ++k)
      rows(Eigen::Index(r), Eigen::Index(grid.offset(i) + k)) = std::cos(std::numbers::pi * (double(k) + 0.5) * shares[r]);
  return rows;
}

Eigen::MatrixXd stacked(const std::vector<Eigen::MatrixXd>& parts) {
  Eigen::Index rows = 0;
  for (const auto& p : parts) rows += p.rows();
  Eigen::MatrixXd all(rows, parts[0].cols());
  rows = 0;
  for (const auto& p : parts) {
    all.middleRows(rows, p.rows()) = p;
    rows += p.rows();
  }
  return all;
}

}  // namespace

std::vector<double> false_discovery(const std::vector<double>& p) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < p.size(); ++i)
    if (!std::isnan(p[i])) order.push_back(i);
  const std::size_t n = order.size();
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return p[a] < p[b]; });
  double harmonic = 0;
  for (std::size_t i = 1; i <= n; ++i) harmonic += 1 / double(i);
  std::vector<double> q(p.size(), std::numeric_limits<double>::quiet_NaN());
  double least = 1;
  for (std::size_t i = n; i-- > 0;) {
    least = std::min(least, p[order[i]] * double(n) * harmonic / double(i + 1));
    q[order[i]] = least;
  }
  return q;
}

namespace {

/// The span of the records in equal windows; records may begin late.
struct RecordSpan {
  double begin = 0, end = 0;

  explicit RecordSpan(const Decimation& grid) {
    const Eigen::VectorXd times = grid.times();
    const double step = times.size() > 1 ? grid.half_window() : 0;
    end = times.maxCoeff() + 0.5 * step;
    begin = times.minCoeff() > step ? times.minCoeff() - 0.5 * step : 0;
  }
  [[nodiscard]] int window_of(double t) const { return end > begin ? std::clamp(int((t - begin) / (end - begin) * windows), 0, windows - 1) : 0; }
  [[nodiscard]] double begin_of(int w) const { return begin + (end - begin) * w / windows; }
};

/// All parts of one residual with their scores. q-values need the p-values of all of them.
struct PartTests {
  const Decimation& grid;
  const RecordSpan span;
  std::vector<Tested> sensors, time_windows, bands_of_all, map, band_map;  ///< the maps observation by observation
};

PartTests test_all_parts(const Decimation& grid, const Eigen::VectorXd& residual, const Eigen::MatrixXd& covariance) {
  PartTests tests{.grid = grid, .span = RecordSpan(grid)};
  const Eigen::Index n = residual.size();
  const Eigen::VectorXd times = grid.times();
  const auto at_rows = [&](const std::vector<Eigen::Index>& at) { return tested(unit_rows(at, n), residual, covariance); };
  for (std::size_t i = 0; i < grid.observations(); ++i) {
    std::vector<Eigen::Index> at(grid.windows(i).size());
    std::iota(at.begin(), at.end(), Eigen::Index(grid.offset(i)));
    tests.sensors.push_back(at_rows(at));
  }
  for (int w = 0; w < windows; ++w) {
    std::vector<Eigen::Index> at;
    for (Eigen::Index i = 0; i < n; ++i)
      if (tests.span.window_of(times[i]) == w) at.push_back(i);
    tests.time_windows.push_back(at_rows(at));
  }
  for (int b = 0; b < bands; ++b) {
    std::vector<Eigen::MatrixXd> parts;
    for (std::size_t i = 0; i < grid.observations(); ++i) parts.push_back(cosine_rows(grid, i, b));
    tests.bands_of_all.push_back(tested(stacked(parts), residual, covariance));
  }
  for (std::size_t i = 0; i < grid.observations(); ++i)
    for (int w = 0; w < windows; ++w) {
      std::vector<Eigen::Index> at;
      for (std::size_t k = 0; k < grid.windows(i).size(); ++k)
        if (tests.span.window_of(grid.windows(i)[k].time) == w) at.push_back(Eigen::Index(grid.offset(i) + k));
      tests.map.push_back(at_rows(at));
    }
  for (std::size_t i = 0; i < grid.observations(); ++i)
    for (int b = 0; b < bands; ++b) tests.band_map.push_back(tested(cosine_rows(grid, i, b), residual, covariance));
  return tests;
}

/// Highest frequency of the grid [Hz].
double nyquist_of(const Decimation& grid) {
  double nyquist = 0;
  for (std::size_t i = 0; i < grid.observations(); ++i)
    if (const auto w = grid.windows(i); w.size() > 1) nyquist = std::max(nyquist, 0.5 / (w[1].time - w[0].time));
  return nyquist;
}

/// Keeps the gauge and the window at which the mismatch is first significant; the strongest where several begin together.
void find_first(const PartTests& tests, LocatedMismatch& out) {
  double first = tests.span.end, strongest = 0;
  for (std::size_t i = 0; i < tests.grid.observations(); ++i)
    for (int w = 0; w < windows; ++w) {
      const double score = tests.map[i * windows + std::size_t(w)].score, from = tests.span.begin_of(w);
      if (!(out.map_q_values(Eigen::Index(i), w) < significant_q) || from > first || (from == first && score <= strongest)) continue;
      first = from;
      strongest = score;
      out.first_sensor = out.sensors[i].name;
      out.first_observation = i;
      out.first_time = from;
    }
}

}  // namespace

LocatedMismatch locate(const Problem& problem, const Decimation& grid, const Eigen::VectorXd& residual, const Eigen::MatrixXd& covariance) {
  const PartTests tests = test_all_parts(grid, residual, covariance);
  std::vector<double> p;
  for (const auto* part : {&tests.sensors, &tests.time_windows, &tests.bands_of_all, &tests.map, &tests.band_map})
    for (const auto& t : *part) p.push_back(t.p_value);
  const auto q = false_discovery(p);
  auto next = q.begin();
  const auto fill = [&](ResidualPart& part, const Tested& t) {
    part.score = t.score;
    part.q_value = *next++;
  };
  LocatedMismatch out;
  for (std::size_t i = 0; i < grid.observations(); ++i) {
    out.sensors.emplace_back().name = problem.label(problem.observations[i]);
    fill(out.sensors.back(), tests.sensors[i]);
  }
  for (int w = 0; w < windows; ++w) {
    auto& x = out.windows.emplace_back();
    x.begin = tests.span.begin_of(w);
    x.end = tests.span.begin_of(w + 1);
    fill(x, tests.time_windows[std::size_t(w)]);
  }
  const double nyquist = nyquist_of(grid);
  for (int b = 0; b < bands; ++b) {
    auto& x = out.bands.emplace_back();
    x.low = nyquist * b / bands;
    x.high = nyquist * (b + 1) / bands;
    fill(x, tests.bands_of_all[std::size_t(b)]);
  }
  const auto fill_map = [&](const std::vector<Tested>& parts, int columns, Eigen::MatrixXd& scores, Eigen::MatrixXd& q_values) {
    scores.resize(Eigen::Index(grid.observations()), columns);
    q_values.resize(scores.rows(), columns);
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const Eigen::Index row = Eigen::Index(k) / columns, column = Eigen::Index(k) % columns;
      scores(row, column) = parts[k].score;
      q_values(row, column) = *next++;
    }
  };
  fill_map(tests.map, windows, out.map, out.map_q_values);
  fill_map(tests.band_map, bands, out.band_map, out.band_map_q_values);
  find_first(tests, out);
  return out;
}

LocatedMismatch locate_mismatch(const Problem& problem, const PosteriorFit& fit) {
  const LogPosterior& posterior = *fit.posterior;
  const LocalMode& m = fit.modes[0];
  const Eigen::VectorXd residual = fit.errors->data() - fit.prediction(m.at);
  const Eigen::MatrixXd j = posterior.jacobian(m.at);
  const Eigen::MatrixXd covariance = fit.errors->covariance() + posterior.density(m.at).variance * fit.noise + j * m.covariance * j.transpose();
  return locate(problem, fit.errors->grid(), residual, covariance);
}

}  // namespace calomel
