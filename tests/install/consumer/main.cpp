// A program outside the project: reads a case, runs it at two points and compares the results.
#include <cstdio>

#include "forward/target/built_in_model.hpp"
#include "inverse/data/problem.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::vector<std::string> overrides{"geometry.element_size=0.004", "time.end=6e-5"};
  calomel::CaseFile file(argv[1], overrides);
  const auto forward = calomel::ForwardCase::read(file);
  const calomel::BuiltInModel model(forward);
  std::vector<double> theta;
  for (const auto& p : forward.parameters) theta.push_back(*p.nominal);
  const auto nominal = model.evaluate(theta);
  theta[0] *= 0.5;
  const auto other = model.evaluate(theta);
  double change = 0;
  for (std::size_t i = 0; i < nominal.mean.size(); ++i) change += (nominal.mean[i] - other.mean[i]) * (nominal.mean[i] - other.mean[i]);
  std::printf("%zu values, changed by %g\n", nominal.mean.size(), change);
  return nominal.ok && other.ok && change > 0 ? 0 : 1;
}
