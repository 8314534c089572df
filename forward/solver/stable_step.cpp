#include "forward/solver/stable_step.hpp"

#include <cmath>

#include "base/linear_algebra.hpp"
#include "base/random.hpp"

namespace calomel {

double stable_time_step(double eigenvalue, double beta) {
  const double omega = std::sqrt(eigenvalue), xi = 0.5 * beta * omega;
  return 2 / omega * (std::sqrt(1 + xi * xi) - xi);
}

double mass_damped_time_step(double step, double mass_damping) { return step * std::sqrt(0.5 * (1 + std::exp(-mass_damping * step))); }

namespace {

/// Greatest Ritz value of a Lanczos process so far, raised by its residual, and that residual relative to it.
struct Ritz {
  double value = 0, residual = 1;
};

Ritz greatest_ritz(const std::vector<double>& diagonal, const std::vector<double>& off) {
  const auto k = Eigen::Index(diagonal.size());
  const auto eigen = tridiagonal_eigen(Eigen::Map<const Eigen::VectorXd>(diagonal.data(), k), Eigen::Map<const Eigen::VectorXd>(off.data(), k - 1));
  const double value = eigen.values(k - 1), residual = off.back() * std::abs(eigen.vectors(k - 1, k - 1));
  return {value + residual, residual / value};
}

/// a <- (a - c b) / d, each lane with its own numbers.
template <class R>
void combine(AlignedArray<R>& a, const std::vector<double>& c, const AlignedArray<R>& b, const std::vector<double>& d, std::size_t width, std::size_t stride) {
  const std::size_t rows = a.size() / width;
  for (std::size_t n = 0; n < rows; ++n)
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t l = 0; l < stride; ++l) {
        const std::size_t i = n * width + k * stride + l;
        a[i] = R((double(a[i]) - c[l] * double(b[i])) / d[l]);
      }
}

}  // namespace

template <class R>
double global_stable_step(const Run<R>& run, int threads, bool liquid_alone) {
  constexpr int most = 64, least = 12;
  constexpr double good_enough = 0.01;
  const std::size_t width = run.packed().width(), lanes = run.packed().stride(), size = run.row_count() * width;
  const std::vector<double> one(lanes, 1), zero(lanes, 0);
  AlignedArray<R> previous(size), current(size), next(size);
  RandomStream random(1, 0x57ab1e);
  for (std::size_t n = 0; n < run.row_count(); ++n)
    for (std::size_t k = 0; k < 3 * lanes; ++k) current[n * width + k] = R(random.uniform(-1, 1));
  run.apply_operator(current, next, threads, liquid_alone);  // into the space that symmetry and slip allow
  std::swap(current, next);
  const auto normalise = [&](AlignedArray<R>& x) {
    auto norm = run.dot(x, x);
    for (auto& s : norm) s = std::sqrt(s);
    combine(x, zero, x, norm, width, lanes);
    return norm;
  };
  normalise(current);

  std::vector<std::vector<double>> diagonal(lanes), off(lanes);
  double lambda = 0;
  for (int k = 0; k < most; ++k) {
    run.apply_operator(current, next, threads, liquid_alone);
    const auto a = run.dot(current, next);
    combine(next, a, current, one, width, lanes);
    if (k > 0) {
      std::vector<double> b;
      for (std::size_t l = 0; l < lanes; ++l) b.push_back(off[l].back());
      combine(next, b, previous, one, width, lanes);
    }
    auto norm = run.dot(next, next);
    for (auto& s : norm) s = std::sqrt(s);
    Ritz greatest;
    for (std::size_t l = 0; l < lanes; ++l) {
      diagonal[l].push_back(a[l]);
      off[l].push_back(norm[l]);
      const Ritz ritz = greatest_ritz(diagonal[l], off[l]);
      if (ritz.value > greatest.value) greatest = ritz;
    }
    lambda = greatest.value;
    if ((k + 1 >= least && greatest.residual < good_enough) || *std::min_element(norm.begin(), norm.end()) < 1e-12 * lambda) break;
    combine(next, zero, next, norm, width, lanes);
    std::swap(previous, current), std::swap(current, next);
  }
  return 2 / std::sqrt(lambda);
}

template double global_stable_step<float>(const Run<float>&, int, bool);
template double global_stable_step<double>(const Run<double>&, int, bool);

}  // namespace calomel
