#include "apps/unknowns.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"

namespace calomel {

namespace {

constexpr double young_secant = 0.02;
const std::string young_key = "material.steel.young";

}  // namespace

std::vector<double> mean_of_changed(const BuiltInModel& model, std::span<const double> theta, const std::function<void(ForwardCase&)>& change) {
  ForwardCase c = model.forward_case();
  change(c);
  try {
    Prediction p = BuiltInModel(std::move(c), model.ensemble(), 1).evaluate(theta);
    return p.ok ? std::move(p.mean) : std::vector<double>{};
  } catch (const InputError&) {  // a gauge off the target, a source that the modelled part cannot show
    return {};
  }
}

Eigen::MatrixXd unknown_directions(const BuiltInModel& model, std::span<const double> theta, const UnknownOptions& options, int threads) {
  const ModelShape& shape = model.shape();
  const ForwardCase& own = model.forward_case();
  const double young = own.number(young_key);
  const double shift = std::max(options.gauge_place_sd, 0.5 * own.geometry.resolved().element_size.value_or(0));
  const auto stiffen = [&](double factor) { return [=](ForwardCase& c) { c.set_number(young_key, factor * young); }; };
  const auto move = [&](double sign) {
    return [=](ForwardCase& c) {
      for (auto& s : c.sensors)
        for (std::size_t i = 0; i < 3; ++i) s.position[i] += sign * shift * s.direction[i] / std::hypot(s.direction[0], s.direction[1], s.direction[2]);
    };
  };
  const std::vector<std::function<void(ForwardCase&)>> changes{stiffen(1 + young_secant), stiffen(1 - young_secant), move(1), move(-1)};
  std::vector<std::vector<double>> means(changes.size());
  parallel_for(changes.size(), threads, [&](std::size_t i) { means[i] = mean_of_changed(model, theta, changes[i]); });

  const auto sensors = Eigen::Index(shape.sensors.size()), times = Eigen::Index(shape.times.size());
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(Eigen::Index(shape.values()), 1 + sensors);
  const auto vector = [](const std::vector<double>& v) { return Eigen::Map<const Eigen::VectorXd>(v.data(), Eigen::Index(v.size())); };
  const bool sought = std::any_of(shape.parameters.begin(), shape.parameters.end(), [](const Parameter& p) { return p.key == young_key; });
  if (!sought && !means[0].empty() && !means[1].empty()) directions.col(0) = options.young_sd / (2 * young_secant) * (vector(means[0]) - vector(means[1]));
  if (!means[2].empty() && !means[3].empty()) {
    const Eigen::VectorXd by_place = options.gauge_place_sd / (2 * shift) * (vector(means[2]) - vector(means[3]));
    for (std::size_t c = 0; c < shape.conditions.size(); ++c)
      for (Eigen::Index s = 0; s < sensors; ++s) {
        const auto at = Eigen::Index(shape.at(c, std::size_t(s), 0));
        directions.col(1 + s).segment(at, times) = by_place.segment(at, times);
      }
  }
  return directions;
}

}  // namespace calomel
