// The densities of tests/verification/reference_posteriors.hpp behind plain functions, so that programs in other languages sample the same compiled code:
// emcee_chains.py.
#include <memory>
#include <vector>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/verification/reference_posteriors.hpp"

namespace {

struct Opened {
  std::unique_ptr<calomel::LogDensity> density;
  std::size_t evaluations = 0;
};

}  // namespace

extern "C" {

/// The posterior `name` with the data of `file`; closed by the end of the process.
void* open_posterior(const char* name, const char* file) {
  const auto& p = calomel::testing::reference_posterior(name);
  return new Opened{p.make(calomel::read_json(file)["data"], calomel::testing::Jacobian::kept)};
}
int dimension(const void* opened) { return int(static_cast<const Opened*>(opened)->density->dimension()); }
int quantities(const void* opened) { return int(static_cast<const Opened*>(opened)->density->quantities().size()); }
/// x: (n, d); values: (n).
void log_densities(void* opened, const double* x, int n, double* values) {
  auto& o = *static_cast<Opened*>(opened);
  const std::size_t d = o.density->dimension();
  for (std::size_t i = 0; i < std::size_t(n); ++i) values[i] = o.density->log_density({x + i * d, d});
  o.evaluations += std::size_t(n);
}
/// Evaluations by log_densities.
double evaluations(const void* opened) { return double(static_cast<const Opened*>(opened)->evaluations); }
/// x: (n, d); q: (n, quantities).
void constrain(const void* opened, const double* x, int n, double* q) {
  const auto& density = *static_cast<const Opened*>(opened)->density;
  const std::size_t d = density.dimension(), m = density.quantities().size();
  for (std::size_t i = 0; i < std::size_t(n); ++i) density.constrain({x + i * d, d}, {q + i * m, m});
}
}
