#include "apps/challenge/score.hpp"

#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <cmath>
#include <numeric>
#include <set>

#include "forward/mechanism/mechanism.hpp"

namespace calomel::challenge {

namespace {

constexpr double half_width_95 = 1.959963984540054;  ///< standard deviations
constexpr int reliability_bins = 10;

/// Relative standard deviations of the handbook priors (inverse/posterior/prior.cpp); another parameter's error counts as it is.
double handbook_sd(const std::string& parameter) {
  if (parameter == "density") return 0.015;
  if (parameter == "sound_speed") return 0.03;
  if (parameter == "tensile_cutoff") return 0.7;
  return 1;
}

/// Mechanisms of a name in a verdict: two of a pair.
std::set<std::string> parts_of(const std::string& name) {
  std::set<std::string> parts;
  for (std::size_t begin = 0; begin <= name.size();) {
    const auto plus = std::min(name.find('+', begin), name.size());
    parts.insert(name.substr(begin, plus - begin));
    begin = plus + 1;
  }
  return parts;
}

bool names_something(const Finding& f) { return f.verdict == VerdictKind::named || f.verdict == VerdictKind::ambiguous; }

/// Name that a ranking would give the truth.
std::string true_name(const Truth& t) {
  if (t.family == Family::none) return "none";
  return t.family == Family::outside ? "unknown" : join(t.mechanisms, "+");
}

std::string truth_label(const Truth& t) {
  if (t.family == Family::none) return "none";
  return text(t.family) + ' ' + (t.family == Family::outside ? join(t.effects, "+") : join(t.mechanisms, "+"));
}

std::string verdict_label(const Finding& f) { return calomel::text(f.verdict) + (f.mechanisms.empty() ? "" : ' ' + join(f.mechanisms, " or ")); }

bool faint(const JudgedCase& c) { return !c.truth.mechanisms.empty() && c.truth.strength < faint_below * c.noise_floor; }

/// Sum over all names of (probability - truth)^2: 0 for certainty of the truth, 2 for certainty of something else.
double brier_of(const JudgedCase& c) {
  std::map<std::string, double> claimed{{true_name(c.truth), 0}};
  for (const auto& r : c.finding.ranking) claimed[r.name] += r.probability;
  double sum = 0;
  for (const auto& [name, p] : claimed) sum += std::pow(p - (name == true_name(c.truth)), 2);
  return sum;
}

/// Whether a key is estimated by its reciprocal: one that is infinite where it is off (a low pass), unless it is a share of another number.
bool by_reciprocal(const std::string& mechanism, const std::string& key) {
  for (const auto& k : mechanisms().get(mechanism).keys)
    if (k.name == key && !std::isfinite(k.off) && k.shows_below.empty()) return true;
  return false;
}

/// The reciprocal with its deviation, to first order.
Interval reciprocal(const Interval& i) { return {1 / i.mean, i.sd / (i.mean * i.mean)}; }

/// Counts a 95 % interval, where there is one.
void count_interval(const Interval& i, double truth, Share& covered, double& square) {
  if (!std::isfinite(i.mean) || !(i.sd > 0) || !std::isfinite(truth)) return;
  const double deviation = (i.mean - truth) / i.sd;
  covered.add(std::abs(deviation) <= half_width_95);
  square += deviation * deviation;
}

double root_mean(double squares, std::size_t n) { return n > 0 ? std::sqrt(squares / double(n)) : 0; }

double median(std::vector<double> v) {
  if (v.empty()) return 0;
  std::sort(v.begin(), v.end());
  return 0.5 * (v[(v.size() - 1) / 2] + v[v.size() / 2]);
}

double mean(const std::vector<double>& v) { return v.empty() ? 0 : std::accumulate(v.begin(), v.end(), 0.0) / double(v.size()); }

void count_coverage(const std::vector<JudgedCase>& cases, Score& s) {
  double base = 0, all = 0, numbers = 0;
  for (const auto& c : cases) {
    const bool right = c.truth.family != Family::outside && outcome_of(c.truth, c.finding) == Outcome::right;
    for (const auto& [name, truth] : c.truth.parameters) {
      const auto found = c.finding.after.find(name);
      if (found == c.finding.after.end()) continue;
      count_interval(found->second, truth, s.base_covered_all, all);
      if (right) count_interval(found->second, truth, s.base_covered, base);
    }
    if (!right || c.finding.verdict != VerdictKind::named) continue;
    const auto entry = std::find_if(c.finding.ranking.begin(), c.finding.ranking.end(), [&](const Ranking& r) { return r.name == c.finding.mechanisms[0]; });
    if (entry == c.finding.ranking.end() || (!entry->gauge.empty() && entry->gauge != c.truth.gauge)) continue;  // another gauge's gain is another number
    for (const auto& [name, truth] : c.truth.numbers) {
      const auto dot = name.find('.');
      const std::string mechanism = name.substr(0, dot), key = name.substr(dot + 1);
      const bool of_gauge = !entry->gauge.empty() && entry->name == "sensor_response";  // in a pair its numbers go without the gauge
      const auto found = entry->numbers.find((of_gauge ? entry->gauge + '.' : "") + name);
      if (found == entry->numbers.end()) continue;
      const bool inverse = by_reciprocal(mechanism, key);
      count_interval(inverse ? reciprocal(found->second) : found->second, inverse ? 1 / truth : truth, s.numbers_covered, numbers);
    }
  }
  s.base_deviation = root_mean(base, s.base_covered.of);
  s.numbers_deviation = root_mean(numbers, s.numbers_covered.of);
}

void count_recovery(const std::vector<JudgedCase>& cases, Score& s) {
  std::size_t held = 0, compared = 0;
  double before_square = 0, after_square = 0;
  for (const auto& c : cases) {
    if (c.finding.verdict != VerdictKind::named) continue;
    if (std::isfinite(c.finding.heldout_before) && std::isfinite(c.finding.heldout_after)) {
      s.heldout_improved.add(c.finding.heldout_after < c.finding.heldout_before);
      s.heldout_before += c.finding.heldout_before;
      s.heldout_after += c.finding.heldout_after;
      ++held;
    }
    double before = 0, after = 0;
    bool any = false;
    for (const auto& [name, truth] : c.truth.parameters) {
      const auto b = c.finding.before.find(name), a = c.finding.after.find(name);
      if (b == c.finding.before.end() || a == c.finding.after.end() || !std::isfinite(b->second.mean) || !std::isfinite(a->second.mean) || truth == 0) continue;
      const double off_before = b->second.mean / truth - 1, off_after = a->second.mean / truth - 1;
      auto& e = s.base_errors[name];
      e.before += off_before * off_before;
      e.after += off_after * off_after;
      ++e.cases;
      before += std::pow(off_before / handbook_sd(name), 2);
      after += std::pow(off_after / handbook_sd(name), 2);
      ++compared;
      any = true;
    }
    if (!any) continue;
    s.base_nearer.add(after < before);
    before_square += before;
    after_square += after;
  }
  if (held > 0) {
    s.heldout_before /= double(held);
    s.heldout_after /= double(held);
  }
  for (auto& [name, e] : s.base_errors) {
    e.before = root_mean(e.before, e.cases);
    e.after = root_mean(e.after, e.cases);
  }
  s.error_before = root_mean(before_square, compared);
  s.error_after = root_mean(after_square, compared);
}

void count_probabilities(const std::vector<JudgedCase>& cases, Score& s) {
  for (int k = 0; k < reliability_bins; ++k) s.reliability.push_back({.low = double(k) / reliability_bins, .high = double(k + 1) / reliability_bins});
  for (const auto& c : cases) {
    const double b = brier_of(c);
    s.brier += b / double(cases.size());
    auto& [sum, n] = s.brier_by_family[text(c.truth.family)];
    sum += b;
    ++n;
    for (const auto& r : c.finding.ranking) {
      auto& bin = s.reliability[std::size_t(std::clamp(int(r.probability * reliability_bins), 0, reliability_bins - 1))];
      bin.claimed += r.probability;
      bin.came_true.add(r.name == true_name(c.truth));
    }
  }
  for (auto& [family, of] : s.brier_by_family) of.first /= double(of.second);
  for (auto& bin : s.reliability)
    if (bin.came_true.of > 0) bin.claimed /= double(bin.came_true.of);
}

void count_effort(const std::vector<JudgedCase>& cases, Score& s) {
  std::vector<double> runs, walls;
  for (const auto& c : cases) {
    runs.push_back(c.finding.runs);
    if (std::isfinite(c.finding.wall)) walls.push_back(c.finding.wall);
  }
  s.walls = walls.size();
  s.runs_mean = mean(runs);
  s.runs_median = median(runs);
  s.runs_most = *std::max_element(runs.begin(), runs.end());
  if (!walls.empty()) {
    s.wall_mean = mean(walls);
    s.wall_median = median(walls);
    s.wall_most = *std::max_element(walls.begin(), walls.end());
  }
}

GateResult gate_of(const std::string& name, const Share& share, double threshold, bool at_most) {
  GateResult g{.name = name,
               .value = share.share(),
               .bound = at_most ? share.bounds().upper : share.bounds().lower,
               .threshold = threshold,
               .at_most = at_most,
               .count = share.count,
               .of = share.of};
  if (share.of > 0) g.state = (at_most ? g.bound <= threshold : g.bound >= threshold) ? GateState::met : GateState::not_met;
  return g;
}

/// The gates of the proof, on one-sided 95 % bounds.
std::vector<GateResult> gates_of(const Score& s) {
  return {gate_of("false names where nothing is concealed", {s.none[Outcome::wrong], s.none.cases()}, 0.05, true),
          gate_of("wrong names outside the library", {s.outside[Outcome::wrong], s.outside.cases()}, 0.10, true),
          gate_of("singles named", {s.singles[Outcome::right], s.singles.cases()}, 0.85, false),
          {.name = "Brier score",
           .value = s.brier,
           .bound = s.brier,
           .threshold = 0.2,
           .of = s.cases,
           .share = false,
           .state = s.brier <= 0.2 ? GateState::met : GateState::not_met},
          gate_of("base parameters in their 95 % intervals", s.base_covered, 0.85, false),
          gate_of("held-out gauges improved by the name", s.heldout_improved, 0.80, false),
          gate_of("base parameters nearer the truth by the name", s.base_nearer, 0.50, false)};
}

}  // namespace

Bounds clopper_pearson(std::size_t successes, std::size_t trials, double confidence) {
  expect(successes <= trials && confidence > 0 && confidence < 1, "a share is of as many trials at least");
  const auto k = double(successes), n = double(trials);
  Bounds b;
  if (successes > 0) b.lower = boost::math::quantile(boost::math::beta_distribution<>(k, n - k + 1), 1 - confidence);
  if (successes < trials) b.upper = boost::math::quantile(boost::math::beta_distribution<>(k + 1, n - k), confidence);
  return b;
}

std::string text(Outcome outcome) {
  switch (outcome) {
    case Outcome::right:
      return "right";
    case Outcome::among:
      return "among";
    case Outcome::part:
      return "part";
    case Outcome::wrong:
      return "wrong";
    case Outcome::unknown:
      return "unknown";
    case Outcome::missed:
      return "missed";
  }
  return "";
}

Outcome outcome_of(const Truth& truth, const Finding& finding) {
  if (!names_something(finding)) {
    const bool none = finding.verdict == VerdictKind::none;
    if (truth.family == Family::outside) return Outcome::right;
    if (truth.family == Family::none) return none ? Outcome::right : Outcome::unknown;
    return none ? Outcome::missed : Outcome::unknown;
  }
  const std::set<std::string> concealed(truth.mechanisms.begin(), truth.mechanisms.end());
  bool whole = false, any = false;
  for (const auto& name : finding.mechanisms) {
    const auto parts = parts_of(name);
    whole |= parts == concealed;
    any |= std::any_of(parts.begin(), parts.end(), [&](const std::string& p) { return concealed.contains(p); });
  }
  if (whole) return finding.verdict == VerdictKind::named ? Outcome::right : Outcome::among;
  return any ? Outcome::part : Outcome::wrong;
}

std::size_t Tally::cases() const { return std::accumulate(count.begin(), count.end(), std::size_t{0}); }

Score score_of(const std::vector<JudgedCase>& cases) {
  expect(!cases.empty(), "a score is of one case at least");
  Score s;
  s.cases = cases.size();
  for (const auto& c : cases) {
    const Outcome outcome = outcome_of(c.truth, c.finding);
    ++s.confusion[truth_label(c.truth)][verdict_label(c.finding)];
    s.unsettled += !c.finding.settled;
    s.below_noise += faint(c);
    Tally* tally = nullptr;
    switch (c.truth.family) {
      case Family::none:
        tally = &s.none;
        break;
      case Family::single:
        tally = &s.singles;
        break;
      case Family::pair:
        tally = &s.pairs;
        break;
      case Family::outside:
        tally = &s.outside;
        break;
      case Family::sensor:
        tally = &s.sensors;
        break;
    }
    ++(faint(c) ? s.faint : *tally).count[std::size_t(outcome)];
    if (c.truth.family == Family::sensor && outcome == Outcome::right)
      s.right_gauge.add(std::any_of(c.finding.ranking.begin(), c.finding.ranking.end(),
                                    [&](const Ranking& r) { return r.name == c.finding.mechanisms[0] && r.gauge == c.truth.gauge; }));
  }
  count_probabilities(cases, s);
  count_coverage(cases, s);
  count_recovery(cases, s);
  count_effort(cases, s);
  s.gates = gates_of(s);
  return s;
}

}  // namespace calomel::challenge
