#include "apps/left_out.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "apps/unknowns.hpp"
#include "base/parallel.hpp"
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

namespace {

constexpr double part_of_range = 0.25;
constexpr double rounding = 1e-5;  ///< of the histories: less is what single precision leaves
constexpr double greatest_cost = 4;  ///< over the base model

/// One secant: the model with a mechanism's key at either value.
struct Secant {
  std::size_t mechanism = 0;
  const MechanismKey* key = nullptr;
  double off = 0;            ///< of the key in this case
  double low = 0, high = 0;  ///< of the key; low is its off value where that has one side
};

Secant secant_of(std::size_t mechanism, const MechanismKey& key, double off) {
  Secant s{.mechanism = mechanism, .key = &key, .off = off, .low = off, .high = key.low + part_of_range * (key.high - key.low)};
  if (std::isfinite(off)) {
    if (off >= key.low) s.high = off + part_of_range * (key.high - off);
    if (off > key.low) s.low = off - part_of_range * (off - key.low);
  }
  return s;
}

/// An infinite value stands for none: such keys are counted by their inverse.
double coordinate(const MechanismKey& key, double value) { return std::isfinite(key.off) ? value : 1 / value; }

}  // namespace

std::vector<LeftOut> left_out_directions(const BuiltInModel& model, std::span<const double> theta, int threads) {
  const auto& own = model.forward_case();
  std::vector<const Registry<MechanismEntry>::Row*> rows;
  for (const auto& row : mechanisms().rows()) {
    const bool enabled = std::any_of(own.mechanisms.begin(), own.mechanisms.end(), [&](const auto& m) { return m.name == row.name; });
    if (!enabled && row.entry.built() && row.entry.cost <= greatest_cost) rows.push_back(&row);
  }
  std::vector<Secant> secants;
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const auto& key : rows[i]->entry.keys)
      if (key.decides) secants.push_back(secant_of(i, key, own.off_value(key)));

  std::vector<std::vector<double>> means(2 * secants.size());
  parallel_for(means.size(), threads, [&](std::size_t i) {
    const Secant& s = secants[i / 2];
    const auto& row = *rows[s.mechanism];
    means[i] = mean_of_changed(model, theta, [&](ForwardCase& c) {
      EnabledMechanism m{row.name, &row.entry, MechanismValues(row.entry.keys)};
      *m.values.find(s.key->name) = i % 2 == 0 ? s.low : s.high;
      c.mechanisms.push_back(std::move(m));
    });
  });

  std::vector<LeftOut> out;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    LeftOut l{.name = rows[i]->name, .like_the_mesh = rows[i]->entry.like_the_mesh};
    for (std::size_t k = 0; k < secants.size(); ++k) {
      if (secants[k].mechanism != i || means[2 * k].empty() || means[2 * k + 1].empty()) continue;
      const auto vector = [](const std::vector<double>& v) { return Eigen::Map<const Eigen::VectorXd>(v.data(), Eigen::Index(v.size())); };
      const auto& key = *secants[k].key;
      const Eigen::VectorXd change = vector(means[2 * k + 1]) - vector(means[2 * k]);
      if (!(change.norm() > rounding * vector(means[2 * k]).norm())) continue;  // it cannot show here
      const bool finite = std::isfinite(secants[k].off);
      l.keys.push_back(finite ? key.name : "1/" + key.name), l.off.push_back(finite ? secants[k].off : 0);
      l.directions.conservativeResize(change.size(), Eigen::Index(l.keys.size()));
      l.directions.rightCols(1) = change / (coordinate(key, secants[k].high) - coordinate(key, secants[k].low));
    }
    if (!l.keys.empty()) out.push_back(std::move(l));
  }
  return out;
}

}  // namespace calomel
