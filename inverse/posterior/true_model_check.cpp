#include "inverse/posterior/true_model_check.hpp"

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>

namespace calomel {

namespace {

constexpr double least_p_of_check = 1e-3;

}  // namespace

TrueModelCheck check_by_true_model(const PosteriorInputs& in, const PosteriorFit& fit, const Eigen::MatrixXd& draws, int coarse, int fine) {
  const LogPosterior& posterior = *fit.posterior;
  const MultilevelRegression& emulator = posterior.emulator();
  const Eigen::Index d = posterior.box().size();
  if (in.levels < 2) {
    fine += coarse;
    coarse = 0;
  }
  Eigen::MatrixXd thetas(d, coarse + fine);
  std::vector<int> level;
  for (int i = 0; i < coarse + fine; ++i) {
    const Eigen::VectorXd u = i == 0 || draws.cols() == 0 ? fit.modes[0].at.u : Eigen::VectorXd(draws.col(i % draws.cols()));
    const auto t = posterior.box().theta(u);
    thetas.col(i) = Eigen::Map<const Eigen::VectorXd>(t.data(), d);
    level.push_back(i < fine ? 0 : 1);
  }
  const auto records = in.run(thetas, level);

  const Decimation& grid = fit.errors->grid();
  const double noise_square = fit.noise.trace();
  const double independent = std::pow(noise_square, 2) / fit.noise.squaredNorm();  // Satterthwaite (1946): of the sum of squares

  TrueModelCheck out;
  double sum = 0, shift = 0;
  int done = 0, shifts = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const auto column = thetas.col(Eigen::Index(i));
    CheckedRun r{.theta = {column.data(), column.data() + d}, .level = level[i], .done = records[i].done};
    if (r.done) {
      const Eigen::VectorXd u = posterior.box().u(r.theta), x = emulator.level_features(u, r.level);
      const Eigen::VectorXd run = grid.apply(records[i].history());
      const Eigen::VectorXd difference = run - fit.coefficients * x;
      const double promised = emulator.variance(x) + emulator.noise_ratio()[std::size_t(r.level)];
      r.distance = difference.norm() / run.norm();
      r.score = difference.squaredNorm() / (promised * noise_square);
      sum += r.score;
      ++done;
      if (r.level == 0) {
        const double variance = emulator.variance(x);  // of the same mesh, so that the two differ by the run alone
        shift += std::pow(posterior.log_likelihood_of(run, variance) - posterior.log_likelihood_of(fit.coefficients * x, variance), 2);
        ++shifts;
      }
    }
    out.runs.push_back(std::move(r));
  }
  out.done = done;
  if (done == 0) return out;
  // The noise that is promised is an estimate itself, so the mean square has Fisher's F distribution.
  const boost::math::fisher_f expected(independent * done, independent * emulator.freedom());
  out.score = sum / done;
  out.score_sd = std::sqrt(2 / (independent * done) + 2 / (independent * emulator.freedom()));
  out.p_value = boost::math::cdf(boost::math::complement(expected, out.score));
  if (shifts > 0) out.log_likelihood_shift = std::sqrt(shift / shifts);
  out.holds = out.p_value > least_p_of_check;
  return out;
}

}  // namespace calomel
