// Time and optimal value of the l1 solver beside scikit-learn's on the same matrices in one run: Chebyshev designs of the seed paper's size.
//
//   bench_lasso [PYTHON]      PYTHON has scikit-learn; without it our own column is printed alone
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "forward/campaign/design.hpp"
#include "forward/surrogate/lasso.hpp"
#include "forward/surrogate/polynomial_basis.hpp"

using namespace calomel;

namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

int main(int argc, char** argv) {
  const auto raw = std::filesystem::temp_directory_path() / fmt::format("lasso_{}.raw", std::filesystem::hash_value(std::filesystem::current_path()));
  for (const auto& space :
       {PolynomialSpace{"total_degree", 10}, PolynomialSpace{"total_degree", 14}, PolynomialSpace{"total_degree", 18}, PolynomialSpace{"tensor_product", 11}}) {
    const auto units = chebyshev_points(3, 480, 1);
    const Eigen::MatrixXd A = basis_matrix(space.degrees(3), units);
    Eigen::VectorXd b(480);
    for (Eigen::Index i = 0; i < 480; ++i)
      b[i] = 5 + 40 * std::abs(units(0, i) * units(1, i) - 0.3) + 8 * std::sin(9 * units(2, i)) * units(0, i) + 2 * std::cos(37.0 * double(i * i % 480));
    const Lasso lasso(A, b);
    const std::vector<double> lambdas = descending(0.1 * lasso.lambda_max(), 1e-3 * lasso.lambda_max(), 5);
    const double began = now();
    const auto fits = lasso.path(lambdas);
    const double seconds = now() - began;
    fmt::print("{} ({} x {})  five lambdas from 0.1 to 0.001 lambda_max\n  here          {:8.3f} s  optimum at the last {:.12g}, gap {:.1e}, {} terms\n",
               space.name(), A.rows(), A.cols(), seconds, fits.back().objective, fits.back().gap, fits.back().nonzero);
    std::fflush(stdout);
    if (argc < 2) continue;
    {
      std::ofstream file(raw, std::ios::binary);
      file.write(reinterpret_cast<const char*>(A.data()), std::streamsize(A.size() * sizeof(double)));
      file.write(reinterpret_cast<const char*>(b.data()), std::streamsize(b.size() * sizeof(double)));
      file.write(reinterpret_cast<const char*>(lambdas.data()), std::streamsize(lambdas.size() * sizeof(double)));
    }
    const std::string command = fmt::format("{} {}/tests/bench/lasso_speed.py {} {} {}", argv[1], CALOMEL_SOURCE_DIR, raw.string(), A.rows(), A.cols());
    if (std::system(command.c_str()) != 0) fmt::print("  scikit-learn could not be asked\n");
  }
  std::filesystem::remove(raw);
}
