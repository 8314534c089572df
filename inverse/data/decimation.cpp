#include "inverse/data/decimation.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/errors.hpp"

namespace calomel {

namespace {

constexpr double least_share = 0.5;  ///< of a window's weight that must be there

/// Share of the samples between its first and its last that a record has: 1, or less of a slower channel.
double density(const Observation& o) {
  const auto first = std::find(o.compared.begin(), o.compared.end(), 1), last = std::find(o.compared.rbegin(), o.compared.rend(), 1).base();
  return first < last ? double(std::count(first, last, 1)) / double(last - first) : 1;
}

std::vector<Window> windows_of(const Observation& o, std::span<const double> time, std::size_t factor) {
  std::vector<Window> all;
  const std::size_t n = time.size();
  const double least = least_share * density(o) * (1 - 1e-9);
  for (std::size_t k = 0; k < std::max<std::size_t>(1, n / factor); ++k) {
    const double middle = (double(k) + 0.5) * double(factor) - 0.5;
    Window w;
    double sum = 0, possible = 0, first_moment = 0;
    const auto begin = std::size_t(std::max(0.0, std::ceil(middle - double(factor))));
    for (std::size_t i = begin; i < n && double(i) < middle + double(factor); ++i) {
      const double weight = factor == 1 ? double(i == k) : std::pow(std::cos(std::numbers::pi * (double(i) - middle) / (2 * double(factor))), 2);
      if (weight < 1e-12) continue;
      possible += weight;
      if (!o.compared[i]) continue;
      w.index.push_back(i);
      w.weight.push_back(weight);
      sum += weight;
      first_moment += weight * time[i];
    }
    if (possible <= 0 || sum < least * possible) continue;
    for (auto& x : w.weight) x /= sum;
    w.time = first_moment / sum;
    all.push_back(std::move(w));
  }
  return all;
}

}  // namespace

Decimation::Decimation(const Problem& problem, std::size_t most_values, std::optional<double> band) : record_time_(problem.time) {
  expect(most_values > 0, "a record keeps at least one value");
  const std::size_t all = problem.observations.size() * problem.time.size();
  std::size_t factor = (all + most_values - 1) / most_values;
  if (band && problem.time.size() > 1) {
    const double step = (problem.time.back() - problem.time.front()) / double(problem.time.size() - 1);
    factor = std::max(factor, std::size_t(std::ceil(0.5 / (*band * step) - 1e-9)));
  }
  factor_ = std::clamp<std::size_t>(factor, 1, problem.time.size());
  std::vector<Eigen::Triplet<double>> entries;
  std::size_t row = 0;
  for (const auto& o : problem.observations) {
    offsets_.push_back(row);
    windows_.push_back(windows_of(o, problem.time, factor_));
    const std::size_t base = problem.shape.at(o.condition, o.sensor, 0);
    for (const auto& w : windows_.back()) {
      for (std::size_t i = 0; i < w.index.size(); ++i) {
        const Stencil& s = problem.stencils[w.index[i]];
        for (std::size_t j = 0; j < s.index.size(); ++j)
          if (s.weight[j] != 0) entries.emplace_back(int(row), int(base + s.index[j]), w.weight[i] * s.weight[j]);
      }
      ++row;
    }
  }
  map_.resize(Eigen::Index(row), Eigen::Index(problem.shape.values()));
  map_.setFromTriplets(entries.begin(), entries.end());
}

Eigen::VectorXd Decimation::times() const {
  Eigen::VectorXd t = Eigen::VectorXd::Zero(map_.rows());
  Eigen::Index row = 0;
  for (const auto& series : windows_)
    for (const auto& w : series) t[row++] = w.time;
  return t;
}

Eigen::VectorXd Decimation::apply_record(std::size_t observation, std::span<const double> record) const {
  const auto& series = windows_[observation];
  Eigen::VectorXd y(Eigen::Index(series.size()));
  for (std::size_t k = 0; k < series.size(); ++k) {
    double sum = 0, share = 0;
    for (std::size_t i = 0; i < series[k].index.size(); ++i)
      if (const double v = record[series[k].index[i]]; std::isfinite(v)) sum += series[k].weight[i] * v, share += series[k].weight[i];
    y[Eigen::Index(k)] = share >= least_share ? sum / share : std::numeric_limits<double>::quiet_NaN();
  }
  return y;
}

std::vector<double> change_when_late(std::span<const double> history, std::span<const double> times) {
  expect(history.size() == times.size() && times.size() >= 2, "a history of two values or more, and their times");
  std::vector<double> change(history.size());
  for (std::size_t k = 0; k < history.size(); ++k) {
    const std::size_t before = k > 0 ? k - 1 : k, after = std::min(k + 1, history.size() - 1);
    change[k] = -(history[after] - history[before]) / (times[after] - times[before]);
  }
  return change;
}

Eigen::MatrixXd filtered_covariance(std::span<const Window> windows, std::span<const double> record_time, double time, double white, bool zeroed,
                                    double zero_time) {
  const auto n = Eigen::Index(windows.size());
  const bool coloured = time > 0 && white < 1;
  const auto decay = [&](double dt) { return coloured ? std::exp(-std::abs(dt) / time) : 0.0; };
  const double share = coloured ? 1 - white : 0, rest = 1 - share;
  // exp(-(t - t') / time) is a product of one factor of each window where the windows do not overlap.
  Eigen::VectorXd forward(n), backward(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Window& w = windows[std::size_t(k)];
    forward[k] = backward[k] = 0;
    for (std::size_t i = 0; i < w.index.size() && coloured; ++i) {
      const double d = (record_time[w.index[i]] - w.time) / time;
      forward[k] += w.weight[i] * std::exp(d);
      backward[k] += w.weight[i] * std::exp(-d);
    }
  }
  Eigen::MatrixXd c(n, n);
  for (Eigen::Index a = 0; a < n; ++a)
    for (Eigen::Index b = a; b < n; ++b) {
      const Window &wa = windows[std::size_t(a)], &wb = windows[std::size_t(b)];
      double value = 0;
      if (wa.index.back() < wb.index.front()) {
        value = share * decay(wb.time - wa.time) * forward[a] * backward[b];
        if (!std::isfinite(value)) value = 0;  // a window far longer than the correlation time: exp underflows against overflow
      } else {
        for (std::size_t i = 0; i < wa.index.size(); ++i)
          for (std::size_t j = 0; j < wb.index.size(); ++j) {
            const double dt = record_time[wa.index[i]] - record_time[wb.index[j]];
            value += wa.weight[i] * wb.weight[j] * (share * decay(dt) + (wa.index[i] == wb.index[j] ? rest : 0.0));
          }
      }
      c(a, b) = c(b, a) = value;
    }
  if (zeroed) {
    Eigen::VectorXd with_zero(n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const Window& w = windows[std::size_t(k)];
      with_zero[k] = 0;
      for (std::size_t i = 0; i < w.index.size(); ++i) {
        const double dt = record_time[w.index[i]] - zero_time;
        with_zero[k] += w.weight[i] * (share * decay(dt) + (std::abs(dt) < 1e-12 ? rest : 0.0));
      }
    }
    c.rowwise() -= with_zero.transpose();
    c.colwise() -= with_zero;
    c.array() += 1;
  }
  return c;
}

}  // namespace calomel
