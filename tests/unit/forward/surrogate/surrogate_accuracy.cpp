/// Prints the held-out accuracy and the cost of every kind of surrogate on the analytic families; run by hand:
///   surrogate_accuracy [runs] [times] [epochs] [kinds...]
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "base/parallel.hpp"
#include "forward/surrogate/training.hpp"
#include "wave_family.hpp"

using namespace calomel;

int main(int argc, char** argv) {
  const std::size_t runs = argc > 1 ? std::size_t(std::atoi(argv[1])) : 150, times = argc > 2 ? std::size_t(std::atoi(argv[2])) : 500;
  std::vector<std::string> kinds;
  for (int i = 4; i < argc; ++i) kinds.emplace_back(argv[i]);
  if (kinds.empty()) kinds = surrogate_kinds().names();
  struct Family {
    const char* name;
    Archive archive;
  };
  const Family families[] = {{"oscillation", damped_oscillations(runs, 4, 200, 7)},
                             {"c +-10 %", mimic_records(runs, 12, times, 12000, 1300, 1600, 7)},
                             {"c 1000..2000", mimic_records(runs, 12, times, 8000, 1000, 2000, 7)},
                             {"c 500..3000", mimic_records(runs, 12, times, 1350, 500, 3000, 7)},
                             {"c 100..10000", mimic_records(runs, 12, times, 1350, 100, 10000, 7)}};
  std::printf("%-14s %-22s %8s %8s %10s %7s %8s %6s %9s %9s\n", "family", "kind", "R2", "R2train", "mae", "var", "train s", "modes", "40 pts ms",
              "gradient ms");
  for (const auto& family : families)
    for (const auto& kind : kinds) {
      SurrogateOptions options;
      options.kind = kind;
      if (argc > 3) options.epochs = std::atoi(argv[3]);
      SurrogateSummary s;
      const auto surrogate = train_surrogate(options, family.archive, 1, default_threads(), s);
      const Eigen::MatrixXd batch = family.archive.theta.leftCols(std::min<Eigen::Index>(40, family.archive.theta.cols()));
      using Clock = std::chrono::steady_clock;
      const auto t0 = Clock::now();
      for (int i = 0; i < 5; ++i) (void)surrogate->means(batch, default_threads());
      const auto t1 = Clock::now();
      const std::vector<double> weights(family.archive.shape.values(), 1.0);
      for (int i = 0; i < 5; ++i) (void)surrogate->vector_jacobian_product({batch.data(), 3}, weights);
      const auto t2 = Clock::now();
      const auto ms = [](auto d) { return std::chrono::duration<double, std::milli>(d).count() / 5; };
      std::printf("%-14s %-22s %8.4f %8.4f %10.3g %7.2f %8.2f %6d %9.2f %9.2f\n", family.name, kind.c_str(), s.test.r2, s.train.r2, s.test.mae,
                  s.variance_ratio, s.train_seconds, s.record.modes, ms(t1 - t0), ms(t2 - t1));
      std::fflush(stdout);
    }
}
