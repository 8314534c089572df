#pragma once
#include <pagmo/population.hpp>
#include <string>

namespace calomel {

/// Self-adaptive evolution strategy: every individual carries a strategy vector, the sd of the mutation of each coordinate in
/// units of the box. An offspring is, with probability cxpb, the mean of two parents (Schwefel's intermediary crossover) in strategy
/// and takes each coordinate from one of them, then each coordinate mutates with probability mutpb (one always):
/// s_k <- s_k exp(tau' N + tau N_k), x_k <- x_k + s_k N_k, tau = 1 / sqrt(2 sqrt(d)), tau' = 1 / sqrt(2 d), s clipped to
/// [smallest, largest]; coordinates that leave the box are reflected. The best mu survive, of the offspring
/// (mu, lambda) or of parents and offspring (mu + lambda). Beyer and Schwefel 2002, Natural Computing 1, 3, sections 4.2 and 4.5.
/// cxpb and mutpb are those of the seed paper's library (Radaideh et al. 2021, NEORL), except that every offspring may mutate.
struct EvolutionStrategy {
  int generations = 100;
  unsigned seed = 1;
  double cxpb = 0.6;
  double mutpb = 0.8;
  double survivors = 0.25;  ///< mu / lambda
  bool plus = true;
  double first = 0.2, smallest = 1e-7, largest = 0.5;
  [[nodiscard]] pagmo::population evolve(pagmo::population population) const;
  void set_seed(unsigned s) { seed = s; }
  [[nodiscard]] std::string get_name() const { return "ES, self-adaptive"; }
};

}  // namespace calomel
