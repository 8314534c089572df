#include "uq/diagnosis/screening.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/log_sum.hpp"
#include "inverse/posterior/score_test.hpp"

namespace calomel {

namespace {

constexpr double scales_of_many[] = {1, 0.3, 0.1, 0.03};  ///< factors on the priors of a group of many numbers of one kind
constexpr int shapes_tried = 33;                          ///< values over the prior of a shape, because a frequency shows in a narrow stretch of it
constexpr double rounding = 1e-5;                         ///< relative to the histories: a smaller effect counts as none

/// The effect of a number at one strength.
struct Effect {
  std::size_t group, number;  ///< indices
  double strength;
  std::vector<double> shapes;  ///< values of the group's shapes
  Eigen::VectorXd change;      ///< change per unit of the number, (values); empty: nothing that shows
};

std::string label(const ParameterGroup& g) { return g.place.empty() ? g.name : g.name + " (" + g.place + ")"; }

/// Values of the shapes that are screened: the defaults, and each shape at its first values while the others keep theirs.
std::vector<std::vector<double>> shapes_of(const ParameterGroup& g) {
  std::vector<double> middle;
  for (const auto& s : g.shapes) middle.push_back(*s.parameter.nominal);
  std::vector<std::vector<double>> all;
  if (std::all_of(g.shapes.begin(), g.shapes.end(), [](const auto& s) { return s.strengths.empty(); })) all.push_back(middle);
  for (std::size_t k = 0; k < g.shapes.size(); ++k)
    for (const double value : g.shapes[k].strengths) {
      auto one = middle;
      one[k] = value;
      if (std::find(all.begin(), all.end(), one) == all.end()) all.push_back(std::move(one));
    }
  return all;
}

/// A point of the model with these numbers off, (n_parameters + added).
Eigen::VectorXd with_off(std::span<const double> theta, const std::vector<AddedParameter>& added) {
  Eigen::VectorXd all(Eigen::Index(theta.size() + added.size()));
  std::copy(theta.begin(), theta.end(), all.data());
  for (std::size_t k = 0; k < added.size(); ++k) all[Eigen::Index(theta.size() + k)] = *added[k].parameter.nominal;
  return all;
}

/// Columns side by side, all of one length.
Eigen::MatrixXd side_by_side(const std::vector<Eigen::VectorXd>& columns) {
  Eigen::MatrixXd all(columns.at(0).size(), Eigen::Index(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) all.col(Eigen::Index(i)) = columns[i];
  return all;
}

/// One screening, from the runs to the score tests.
class Screening {
 public:
  explicit Screening(const ScreeningInputs& in) : in_(in), mode_(in.fit.modes[0]), first_order_(*in.fit.posterior, mode_) {}

  ScreeningResult result() {
    measure_effects();
    for (std::size_t g = 0; g < in_.groups.size(); ++g) {
      if (!in_.includes(in_.groups[g])) continue;
      const std::size_t before = out_.candidates.size();
      screen_group(g);
      const std::string name = label(in_.groups[g]);
      const bool failed = std::any_of(out_.not_screened.begin(), out_.not_screened.end(), [&](const auto& s) { return s.label == name; });
      if (out_.candidates.size() == before && !failed) out_.not_screened.push_back({.label = name, .failure = {}});
    }
    keep_best_of_each();
    add_score_tests();
    return std::move(out_);
  }

 private:
  void measure_effects();
  void screen_group(std::size_t g);
  void screen_strength(std::size_t g, std::size_t strength, const std::vector<double>& shapes);
  void add_over_scales(ScreenedCandidate candidate);
  void keep_best_of_each();
  void add_score_tests();
  [[nodiscard]] ScreenedCandidate estimated(ScreenedCandidate candidate) const {
    candidate.directions.by_number = in_.fit.errors->grid().apply(candidate.effects);
    candidate.first_order = first_order_.estimate(candidate.directions);
    return candidate;
  }
  /// Adds a candidate, unless no compared value shows it, as of a gauge without a record.
  void add(ScreenedCandidate candidate) {
    candidate = estimated(std::move(candidate));
    if ((candidate.directions.by_number.array() != 0).any()) out_.candidates.push_back(std::move(candidate));
  }
  /// The part of a change that one gauge shows.
  [[nodiscard]] Eigen::VectorXd of_sensor(Eigen::VectorXd change, std::size_t sensor) const {
    const ModelShape& shape = in_.problem.shape;
    for (std::size_t c = 0; c < shape.conditions.size(); ++c)
      for (std::size_t s = 0; s < shape.sensors.size(); ++s)
        if (s != sensor) change.segment(Eigen::Index(shape.at(c, s, 0)), Eigen::Index(shape.times.size())).setZero();
    return change;
  }

  const ScreeningInputs& in_;
  const LocalMode& mode_;
  const FirstOrderModel first_order_;
  std::vector<Effect> effects_;
  ScreeningResult out_;
};

void Screening::measure_effects() {
  std::vector<AddedParameter> added;
  for (const auto& g : in_.groups) {
    if (!in_.includes(g)) continue;
    added.insert(added.end(), g.added.begin(), g.added.end());
    added.insert(added.end(), g.shapes.begin(), g.shapes.end());
  }
  const auto& theta = mode_.at.theta;
  const Eigen::VectorXd off = with_off(theta, added);
  std::vector<Eigen::VectorXd> columns{off};
  std::size_t at = theta.size();
  for (std::size_t g = 0; g < in_.groups.size(); ++g) {
    const ParameterGroup& group = in_.groups[g];
    if (!in_.includes(group)) continue;
    for (std::size_t k = 0; k < group.added.size(); ++k)
      for (const auto& shapes : shapes_of(group))
        for (const double strength : group.added[k].strengths) {
          columns.push_back(off);
          columns.back()[Eigen::Index(at + k)] = strength;
          for (std::size_t i = 0; i < shapes.size(); ++i) columns.back()[Eigen::Index(at + group.added.size() + i)] = shapes[i];
          effects_.push_back({g, k, strength, shapes, {}});
        }
    at += group.added.size() + group.shapes.size();
  }
  const auto records = in_.run(side_by_side(columns), std::vector<int>(columns.size(), in_.level), added);
  if (!records[0].done) throw NumericsError("the base model fails at its own mode: " + records[0].message);
  const Eigen::VectorXd zero = records[0].history();
  std::map<std::size_t, std::string> failed;
  for (std::size_t i = 0; i < effects_.size(); ++i) {
    const RunRecord& r = records[i + 1];
    Effect& e = effects_[i];
    if (!r.done) {
      failed.emplace(e.group, r.message);
      continue;
    }
    const Eigen::VectorXd change = r.history() - zero;
    if (change.norm() > rounding * zero.norm()) e.change = change / (e.strength - *in_.groups[e.group].added[e.number].parameter.nominal);
  }
  for (const auto& [group, message] : failed) out_.not_screened.push_back({.label = label(in_.groups[group]), .failure = message});
}

void Screening::screen_group(std::size_t g) {
  const ParameterGroup& group = in_.groups[g];
  std::size_t strengths = 0;
  for (const auto& a : group.added) strengths = std::max(strengths, a.strengths.size());
  for (const auto& shapes : shapes_of(group))
    for (std::size_t strength = 0; strength < strengths; ++strength) screen_strength(g, strength, shapes);
}

/// One candidate of a group, or one of each gauge: its numbers at the strength of this index, its shapes at these values.
void Screening::screen_strength(std::size_t g, std::size_t strength, const std::vector<double>& shapes) {
  const ParameterGroup& group = in_.groups[g];
  ScreenedCandidate candidate{.group = g};
  candidate.shapes = shapes;
  std::vector<const Effect*> taken;
  for (const auto& e : effects_) {
    if (e.group != g || e.shapes != shapes || e.change.size() == 0) continue;
    const auto& strengths = group.added[e.number].strengths;
    if (e.strength != strengths[std::min(strength, strengths.size() - 1)]) continue;
    taken.push_back(&e);
    candidate.numbers.push_back(e.number);
  }
  if (taken.empty()) return;
  candidate.effects.resize(taken[0]->change.size(), Eigen::Index(taken.size()));
  candidate.directions.prior_sd.resize(Eigen::Index(taken.size()));
  for (std::size_t i = 0; i < taken.size(); ++i) {
    candidate.effects.col(Eigen::Index(i)) = taken[i]->change;
    candidate.directions.prior_sd[Eigen::Index(i)] = prior_sd(group.added[taken[i]->number], taken[i]->strength);
  }
  if (group.linear) return add_over_scales(std::move(candidate));
  if (!group.by_sensor) return add(std::move(candidate));
  for (std::size_t s = 0; s < in_.problem.shape.sensors.size(); ++s) {
    ScreenedCandidate one = candidate;
    one.sensor = s;
    for (auto column : one.effects.colwise()) column = of_sensor(column, s);
    add(std::move(one));
  }
}

/// Adds a group of many numbers of one kind. Their common scale is not known, so that their evidence is the mean over a few scales.
void Screening::add_over_scales(ScreenedCandidate candidate) {
  const Eigen::VectorXd widest = candidate.directions.prior_sd;
  std::vector<ScreenedCandidate> scales;
  for (const double scale : scales_of_many) {
    candidate.directions.prior_sd = scale * widest;
    scales.push_back(estimated(candidate));
  }
  auto best = std::max_element(scales.begin(), scales.end(),
                               [](const auto& a, const auto& b) { return a.first_order.log_bayes_factor < b.first_order.log_bayes_factor; });
  std::vector<double> over_best;
  for (const auto& x : scales) over_best.push_back(x.first_order.log_bayes_factor - best->first_order.log_bayes_factor);
  best->selection_penalty = log_mean(over_best);
  best->first_order.log_bayes_factor += best->selection_penalty;
  out_.candidates.push_back(std::move(*best));
}

/// Keeps the best candidate of each group and gauge, and divides the evidence of a mechanism between the places on which it may act.
void Screening::keep_best_of_each() {
  auto& all = out_.candidates;
  const auto sort = [&] {
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first_order.log_bayes_factor > b.first_order.log_bayes_factor; });
  };
  sort();
  std::vector<ScreenedCandidate> best;
  for (auto& candidate : all)
    if (std::none_of(best.begin(), best.end(), [&](const auto& b) { return b.group == candidate.group && b.sensor == candidate.sensor; }))
      best.push_back(std::move(candidate));
  // The evidence of a mechanism that acts on one of n places is the mean over them; each place takes from it what those below it add.
  std::vector<double> left(best.size(), 0.0);
  for (std::size_t i = 0; i < best.size(); ++i) {
    std::vector<double> places;  // over this one
    for (std::size_t k = 0; k < best.size(); ++k)
      if (in_.groups[best[k].group].name == in_.groups[best[i].group].name)
        places.push_back(k >= i ? best[k].first_order.log_bayes_factor - best[i].first_order.log_bayes_factor : -std::numeric_limits<double>::infinity());
    left[i] = log_mean(places);
  }
  for (std::size_t i = 0; i < best.size(); ++i) {
    best[i].selection_penalty += left[i];
    best[i].first_order.log_bayes_factor += left[i];
  }
  all = std::move(best);
  sort();
}

void Screening::add_score_tests() {
  const PosteriorFit& fit = in_.fit;
  std::vector<MechanismDirections> tests;
  for (const auto& candidate : out_.candidates) {
    MechanismDirections t{.name = label(candidate, in_.groups, in_.problem.shape), .directions = candidate.effects};
    for (const std::size_t k : candidate.numbers) {
      t.keys.push_back(in_.groups[candidate.group].added[k].parameter.name);
      t.off.push_back(0);
    }
    tests.push_back(std::move(t));
  }
  const Decimation& grid = fit.errors->grid();
  const auto tested = score_tests(*fit.posterior, mode_.at, grid, tests, fit.posterior->emulator().residuals(grid.apply(fit.histories())));
  for (auto& candidate : out_.candidates)
    for (const auto& t : tested.mechanisms)
      if (t.name == label(candidate, in_.groups, in_.problem.shape)) candidate.p_value = t.p_value;
}

}  // namespace

std::vector<ParameterGroup> with_idle_numbers_as_shapes(std::vector<ParameterGroup> groups, const RunAdded& run, std::span<const double> theta) {
  std::vector<AddedParameter> added;
  for (const auto& g : groups) added.insert(added.end(), g.added.begin(), g.added.end());
  const Eigen::VectorXd off = with_off(theta, added);
  std::vector<Eigen::VectorXd> columns{off};
  std::size_t at = theta.size();
  for (const auto& g : groups)
    for (const auto& a : g.added) {
      for (const double strength : a.strengths) {
        if (g.added.size() < 2) continue;
        columns.push_back(off);
        columns.back()[Eigen::Index(at)] = strength;
      }
      ++at;
    }
  if (columns.size() == 1) return groups;
  const auto records = run(side_by_side(columns), std::vector<int>(columns.size(), 0), added);
  if (!records[0].done) return groups;
  const Eigen::VectorXd zero = records[0].history();
  std::size_t record = 1;
  for (auto& g : groups) {
    if (g.added.size() < 2) continue;
    std::vector<AddedParameter> deciding, idle;
    for (auto& a : g.added) {
      bool acts = false;
      for (std::size_t i = 0; i < a.strengths.size(); ++i, ++record)
        acts = acts || !records[record].done || (records[record].history() - zero).norm() > rounding * zero.norm();
      (acts ? deciding : idle).push_back(a);
    }
    if (deciding.empty()) continue;
    for (auto& a : idle) {
      a.strengths.clear();
      for (int i = 0; i < shapes_tried; ++i)
        a.strengths.push_back(std::clamp(Prior(a.parameter).quantile((i + 0.5) / shapes_tried), a.parameter.min, a.parameter.max));
      g.shapes.push_back(std::move(a));
    }
    g.added = std::move(deciding);
  }
  return groups;
}

ParameterGroup of_one_sensor(ParameterGroup group, const std::string& sensor) {
  expect(group.by_sensor, "a group that acts on each gauge alone has a part of each");
  group.by_sensor = false;
  group.sensor = sensor;
  group.place = sensor;
  for (auto& a : group.added) a.parameter.key.insert(a.parameter.key.rfind('.'), '.' + sensor);
  return group;
}

ScreeningResult screen_candidates(const ScreeningInputs& in) { return Screening(in).result(); }

std::string label(const ScreenedCandidate& candidate, const std::vector<ParameterGroup>& groups, const ModelShape& shape) {
  const ParameterGroup& group = groups[candidate.group];
  return candidate.sensor ? group.name + " of " + shape.sensors[*candidate.sensor] : label(group);
}

double prior_sd(const AddedParameter& a, double strength) {
  if (!a.share_of.empty()) return std::abs(strength - *a.parameter.nominal);  // its effect sets in at once, whatever the share
  return a.parameter.prior == "half_cauchy" ? strength : Prior(a.parameter).scale();
}

double implausibility(const AddedParameter& a, double value, double sd) {
  const Parameter& p = a.parameter;
  const double never = std::numeric_limits<double>::infinity();
  const auto slack = [sd](double bound) { return sd + 1e-9 * std::abs(bound); };
  if (value > p.max + slack(p.max) || value < p.min - slack(p.min)) return never;
  if (p.prior == "half_cauchy") return std::log10(1 + std::max(0.0, value) / *p.scale);
  if (p.prior == "lognormal" && !(value > 0)) return never;
  if (const auto deviation = prior_deviation(p, value)) return std::abs(*deviation);
  const double far = value > *p.nominal ? p.max - *p.nominal : *p.nominal - p.min;
  return far > 0 ? 2 * std::abs(value - *p.nominal) / far : 0;
}

}  // namespace calomel
