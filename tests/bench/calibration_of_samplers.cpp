/// Simulation-based calibration of every sampler on a conjugate model (tests/unit/uq/sampler/calibration.hpp): whether ranks of the truth among posterior draws
/// are uniform, and as the control the same without the Jacobian of ln s.
///   bench_calibration [replications, 1000] [seed, 1]
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>

#include "tests/unit/uq/sampler/calibration.hpp"

using namespace calomel;
using namespace calomel::testing;

int main(int argc, char** argv) {
  const std::size_t replications = argc > 1 ? std::size_t(std::strtoull(argv[1], nullptr, 10)) : 1000;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  fmt::print("{} replications, {} draws each; probability of a histogram as uneven, 20 and 5 bins\n\n", replications, calibration_draws);
  fmt::print("| sampler | mu, 20 | mu, 5 | ln s, 20 | ln s, 5 | control, ln s, 20 | s |\n|---|---|---|---|---|---|---|\n");
  for (const auto& kind : samplers().names()) {
    const auto began = std::chrono::steady_clock::now();
    const auto ranks = calibration_ranks(kind, replications, seed);
    const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    const auto control = calibration_ranks(kind, replications, seed, false);
    fmt::print("| {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.0e} | {:.1f} |\n", kind, uniformity(ranks[0], 20), uniformity(ranks[0], 5),
               uniformity(ranks[1], 20), uniformity(ranks[1], 5), uniformity(control[1], 20), s);
  }
  return 0;
}
