#include <fmt/format.h>

#include <cmath>

#include "forward/campaign/design.hpp"
#include "forward/surrogate/training.hpp"
#include "inverse/spe.hpp"
#include "inverse/spe/unit_box.hpp"

namespace calomel {

ScatteredData discrepancies(const Problem& problem, const Archive& archive, const Objective& objective, const SpeOptions& options, std::uint64_t seed,
                            std::size_t* excluded) {
  const auto split = split_runs(archive, options.validation_fraction, seed);
  if (excluded) *excluded = split.excluded;
  const auto& chebyshev = designs().get("chebyshev");
  const bool drawn_by_it = designs().get(archive.design).measure == chebyshev.measure;
  std::vector<std::size_t> used = split.train;
  used.insert(used.end(), split.test.begin(), split.test.end());
  ScatteredData data;
  data.units.resize(archive.theta.rows(), Eigen::Index(used.size()));
  data.values.resize(data.units.cols()), data.weights = Eigen::VectorXd::Ones(data.units.cols());
  const UnitBox box(bounds_of(problem.shape));
  for (std::size_t i = 0; i < used.size(); ++i) {
    (i < split.train.size() ? data.train : data.validation).push_back(i);
    const auto at = Eigen::Index(i), run = Eigen::Index(used[i]);
    data.units.col(at) = box.units(archive.theta.col(run));
    const Eigen::VectorXd history = archive.mean.col(run).cast<double>();
    const double cost = objective.cost(objective.value(score(problem, {history.data(), std::size_t(history.size())})));
    if (options.transform == "log" && !(cost > 0))
      throw InputError({.problem = fmt::format("the misfit \"{}\" is not positive at every run and has no logarithm", objective.name),
                        .key = "spe.transform",
                        .value = "\"log\"",
                        .suggestion = "take spe.transform = \"none\""});
    data.values[at] = transformed(options.transform, cost);
    if (!drawn_by_it) data.weights[at] = std::sqrt(chebyshev.density(data.units.col(at)) / design_density(archive.design, data.units.col(at)));
  }
  return data;
}

}  // namespace calomel
