#include "inverse/spe/adaptive_space.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "inverse/spe/lasso_system.hpp"

namespace calomel {

namespace {

using Term = std::vector<int>;
using Terms = std::set<Term>;  // in lexicographic order

constexpr double bulk = 0.5;  // share of the margin's indicator that joins in a round

Eigen::MatrixXi matrix_of(const Terms& terms, std::size_t d) {
  Eigen::MatrixXi m(Eigen::Index(d), Eigen::Index(terms.size()));
  Eigen::Index j = 0;
  for (const auto& t : terms) m.col(j++) = Eigen::Map<const Eigen::VectorXi>(t.data(), Eigen::Index(d));
  return m;
}

bool admissible(const Terms& terms, Term t) {
  for (auto& degree : t) {
    if (degree == 0) continue;
    --degree;
    if (!terms.contains(t)) return false;
    ++degree;
  }
  return true;
}

/// Admissible neighbours with the squared weight of their heaviest predecessor, heaviest first; equal ones by their degrees.
std::vector<std::pair<double, Term>> margin_of(const Terms& terms, const Eigen::VectorXd& z) {
  std::map<Term, double> margin;
  Eigen::Index j = 0;
  for (const auto& t : terms) {
    const double weight = z[j] * z[j];
    for (std::size_t k = 0; k < t.size(); ++k) {
      Term next = t;
      ++next[k];
      if (terms.contains(next) || !admissible(terms, next)) continue;
      auto& w = margin[next];
      w = std::max(w, j == 0 ? 0.0 : weight);  // the constant contains no information on directions
    }
    ++j;
  }
  std::vector<std::pair<double, Term>> out;
  for (const auto& [term, weight] : margin) out.emplace_back(weight, term);
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  return out;
}

/// The heaviest of the margin until `bulk` of its weight has joined; all of it where it has none.
void enlarge(Terms& terms, const std::vector<std::pair<double, Term>>& margin, std::size_t most_terms) {
  double whole = 0, joined = 0;
  for (const auto& [weight, term] : margin) whole += weight;
  for (const auto& [weight, term] : margin) {
    if (terms.size() >= most_terms || (whole > 0 && joined >= bulk * whole)) return;
    terms.insert(term);
    joined += weight;
  }
}

}  // namespace

Eigen::MatrixXi adaptive_degrees(const ScatteredData& data, int rounds, std::size_t most_terms, bool penalise_constant, int folds, std::uint64_t seed) {
  const auto d = std::size_t(data.units.rows());
  Terms terms{Term(d, 0)};
  for (std::size_t k = 0; k < d; ++k) {
    Term linear(d, 0);
    linear[k] = 1;
    terms.insert(linear);
  }
  Eigen::MatrixXi best;
  double least = 0;
  for (int round = 0;; ++round) {
    const Eigen::MatrixXi degrees = matrix_of(terms, d);
    const LassoSystem system(degrees, data, penalise_constant);
    const LambdaChoice choice = system.by_cross_validation(folds, seed);
    if (best.size() == 0 || choice.error < least) {
      best = degrees;
      least = choice.error;
    }
    if (round == rounds || terms.size() >= most_terms) return best;
    enlarge(terms, margin_of(terms, system.lasso(data.train).path(std::vector<double>{choice.lambda}).at(0).z), most_terms);
  }
}

}  // namespace calomel
