#include "uq/convergence/assess.hpp"

#include <algorithm>
#include <cmath>

#include "base/json.hpp"
#include "base/not_finite.hpp"
#include "uq/convergence/diagnostics.hpp"

namespace calomel {

namespace {

double sd(std::span<const double> x) {
  const double m = mean_of(x);
  double s = 0;
  for (const double v : x) s += (v - m) * (v - m);
  return std::sqrt(s / double(x.size() - 1));
}

/// Correlation over all draws, each chain about its own mean, so that it describes the shape and not where chains are.
double correlation_within(ChainDraws a, ChainDraws b) {
  double aa = 0;
  double bb = 0;
  double ab = 0;
  for (std::size_t c = 0; c < a.chains; ++c) {
    const auto x = a.values.subspan(c * a.draws(), a.draws());
    const auto y = b.values.subspan(c * b.draws(), b.draws());
    const double mx = mean_of(x);
    const double my = mean_of(y);
    for (std::size_t i = 0; i < x.size(); ++i) {
      aa += (x[i] - mx) * (x[i] - mx);
      bb += (y[i] - my) * (y[i] - my);
      ab += (x[i] - mx) * (y[i] - my);
    }
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

ParameterSummary summary_of(const std::string& name, ChainDraws x) {
  const bool finite = std::all_of(x.values.begin(), x.values.end(), [](double v) { return std::isfinite(v); });
  ParameterSummary s{.name = name, .mean = nan, .sd = nan, .q05 = nan, .q50 = nan, .q95 = nan};
  if (finite && x.values.size() > 1) {
    s.mean = mean_of(x.values);
    s.sd = sd(x.values);
    s.q05 = quantile(x.values, 0.05);
    s.q50 = quantile(x.values, 0.5);
    s.q95 = quantile(x.values, 0.95);
  }
  s.r_hat = split_r_hat(x);
  s.ess_bulk = ess_bulk(x);
  s.ess_tail = ess_tail(x);
  s.mcse_mean = mcse_mean(x);
  s.mcse_sd = mcse_sd(x);
  s.mcse_q05 = mcse_quantile(x, 0.05);
  s.mcse_q50 = mcse_quantile(x, 0.5);
  s.mcse_q95 = mcse_quantile(x, 0.95);
  return s;
}

/// The factor by which a parameter misses the limits: 1 or less is within them; infinite where a diagnostic is undefined.
double lack(const ParameterSummary& s, const ConvergenceLimits& limits) {
  const auto ratio = [](double x) { return std::isnan(x) ? INFINITY : x; };
  return std::max({ratio((s.r_hat - 1) / (limits.r_hat - 1)), ratio(limits.ess / s.ess_bulk), ratio(limits.ess / s.ess_tail)});
}

bool within(const ParameterSummary& s, const ConvergenceLimits& limits) {
  return s.r_hat < limits.r_hat && s.ess_bulk >= limits.ess && s.ess_tail >= limits.ess;
}

/// The chains whose draws are all equal. Where there are many other chains, R-hat does not show them.
std::vector<std::size_t> still_chains(ChainDraws x) {
  std::vector<std::size_t> still;
  for (std::size_t c = 0; c < x.chains; ++c)
    if (const auto v = x.values.subspan(c * x.draws(), x.draws()); v.size() > 1 && std::all_of(v.begin(), v.end(), [&](double u) { return u == v[0]; }))
      still.push_back(c);
  return still;
}

/// Two groups of chains with a gap between them that no chain crosses.
struct Groups {
  std::vector<std::size_t> low;
  std::vector<std::size_t> high;
  double low_at = 0;   ///< mean of the lower chains' means
  double high_at = 0;  ///< mean of the higher chains' means
};
std::optional<Groups> separate_groups(ChainDraws x) {
  struct Chain {
    std::size_t number;
    double mean, q05, q95;
  };
  std::vector<Chain> chains;
  for (std::size_t c = 0; c < x.chains; ++c) {
    const auto v = x.values.subspan(c * x.draws(), x.draws());
    chains.push_back({c, mean_of(v), quantile(v, 0.05), quantile(v, 0.95)});
  }
  std::sort(chains.begin(), chains.end(), [](const Chain& a, const Chain& b) { return a.mean < b.mean; });
  for (std::size_t k = 1; k < chains.size(); ++k) {
    const auto highest = std::max_element(chains.begin(), chains.begin() + std::ptrdiff_t(k), [](auto& a, auto& b) { return a.q95 < b.q95; });
    const auto lowest = std::min_element(chains.begin() + std::ptrdiff_t(k), chains.end(), [](auto& a, auto& b) { return a.q05 < b.q05; });
    if (lowest->q05 <= highest->q95) continue;
    Groups g;
    for (std::size_t i = 0; i < chains.size(); ++i) {
      (i < k ? g.low : g.high).push_back(chains[i].number);
      (i < k ? g.low_at : g.high_at) += chains[i].mean / double(i < k ? k : chains.size() - k);
    }
    for (auto* list : {&g.low, &g.high}) std::sort(list->begin(), list->end());
    return g;
  }
  return std::nullopt;
}

/// Whether at least three chains in four move one way throughout: the means of their thirds rise or fall, by more than three standard deviations in all.
bool drifts(ChainDraws x) {
  std::size_t drifting = 0;
  for (std::size_t c = 0; c < x.chains; ++c) {
    const auto v = x.values.subspan(c * x.draws(), x.draws());
    const std::size_t third = v.size() / 3;
    if (third < 2) return false;
    const auto first = v.first(third);
    const auto last = v.last(third);
    const double a = mean_of(first);
    const double b = mean_of(v.subspan(third, third));
    const double e = mean_of(last);
    drifting += (b - a) * (e - b) > 0 && std::abs(e - a) > 3 * std::min(sd(first), sd(last));
  }
  return 4 * drifting >= 3 * x.chains;
}

constexpr double many_divergences = 0.001;  ///< share of diverging trajectories above which they are the likely cause
constexpr double many_cut = 0.1;            ///< likewise of trajectories that were ended early
constexpr double mostly_refused = 0.2;      ///< acceptance of the true model below which the emulator disagrees with it
constexpr double hardly_moving = 0.05;      ///< acceptance below which the proposal does not fit the density
constexpr double narrow = 0.95;             ///< correlation of a narrow ridge
constexpr double nearly_mixed = 1.05;       ///< R-hat below which longer chains are enough

/// Chains whose energies change too slowly.
std::vector<std::size_t> slow_energies(const SamplingFacts& facts, const ConvergenceLimits& limits) {
  std::vector<std::size_t> chains;
  for (std::size_t c = 0; c < facts.e_bfmi.size(); ++c)
    if (facts.e_bfmi[c] < limits.e_bfmi) chains.push_back(c);
  return chains;
}

/// The finding about slow energies. low: the chains concerned.
ConvergenceFinding slow_energy_finding(ConvergenceFinding f, const std::vector<std::size_t>& low, const SamplingFacts& facts) {
  f.state = ChainState::slow_energies;
  f.chains = low;
  f.e_bfmi = facts.e_bfmi[low[0]];
  return f;
}

/// The parameter whose draws correlate most strongly with those of `worst`, and that correlation; `worst` itself and 0 where it is alone.
std::pair<std::size_t, double> partner_of(const Draws& draws, std::size_t worst, ChainDraws x) {
  std::size_t partner = worst;
  double strongest = 0;
  for (std::size_t k = 0; k < draws.names.size(); ++k) {
    if (k == worst) continue;
    const auto other = draws.of(k);
    if (const double r = correlation_within(x, {other, draws.chains}); std::abs(r) > std::abs(strongest)) {
      strongest = r;
      partner = k;
    }
  }
  return {partner, strongest};
}

/// The finding that holds whatever the cause is.
ConvergenceFinding common_finding(const Draws& draws, const SamplingFacts& facts) {
  return {.draws = draws.draws, .walkers = draws.walkers > 1, .thin = facts.thin, .transitions = facts.transitions, .remedies = facts.remedies};
}

/// The likely cause that the parameter `worst` with the summary `s` is not known.
ConvergenceFinding cause(const Draws& draws, std::size_t worst, const ParameterSummary& s, const SamplingFacts& facts, const ConvergenceLimits& limits) {
  const auto values = draws.of(worst);
  const ChainDraws x{values, draws.chains, draws.walkers};
  ConvergenceFinding f = common_finding(draws, facts);
  const auto found = [&](ChainState state) {
    f.state = state;
    return f;
  };
  if (draws.draws < 4) return found(ChainState::short_chains);
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) return found(ChainState::not_finite);
  if (std::all_of(values.begin(), values.end(), [&](double v) { return v == values[0]; })) {
    f.value = values[0];
    return found(ChainState::constant);
  }
  if (auto still = still_chains(x); !still.empty()) {
    f.chains = std::move(still);
    return found(ChainState::still_chains);
  }
  if (s.r_hat >= limits.r_hat && drifts(x)) return found(ChainState::drift);
  if (s.r_hat >= limits.r_hat)
    if (auto g = separate_groups(x)) {
      f.chains = std::move(g->low);
      f.others = std::move(g->high);
      f.low_at = g->low_at;
      f.high_at = g->high_at;
      return found(ChainState::separate_modes);
    }
  const double kept = double(std::max<std::size_t>(1, facts.transitions));
  if (double(facts.divergences) > many_divergences * kept) return found(ChainState::divergences);
  if (double(facts.cut) > many_cut * kept) {
    f.share = double(facts.cut) / kept;
    return found(ChainState::cut_trajectories);
  }
  // Effective sizes grow with the draws; R-hat - 1 of many chains that are short falls with them.
  const double least = std::max(1.0, std::min(s.ess_bulk, s.ess_tail));
  const double lacking = std::max(limits.ess / least, (s.r_hat - 1) / (limits.r_hat - 1));
  f.needed_draws = 1.2 * lacking * double(draws.draws);
  const double step = f.needed_draws < 1000 ? 100 : 1000;
  f.suggested_draws = std::ceil(f.needed_draws / step) * step;
  if (!facts.remedies.correlation_key.empty()) {
    f.suggested_draws = std::max(f.suggested_draws, 2 * double(draws.draws));
    return found(ChainState::common_ancestors);
  }
  if (facts.acceptance) f.share = *facts.acceptance;
  if (!facts.remedies.emulator_only.empty() && facts.acceptance && *facts.acceptance < mostly_refused) return found(ChainState::emulator_disagrees);
  if (facts.acceptance && *facts.acceptance < hardly_moving) return found(ChainState::refused_proposals);
  if (const auto [partner, strongest] = partner_of(draws, worst, x); std::abs(strongest) > narrow) {
    f.partner = draws.names[partner];
    f.correlation = strongest;
    return found(ChainState::ridge);
  }
  if (const auto low = slow_energies(facts, limits); !low.empty()) return slow_energy_finding(f, low, facts);
  if (s.r_hat < limits.r_hat && s.ess_bulk >= limits.ess) return found(ChainState::rare_tails);
  if (s.ess_bulk >= limits.ess && s.ess_tail >= limits.ess) return found(ChainState::start_remembered);
  if (s.r_hat < nearly_mixed) return found(ChainState::few_draws);
  f.draws_per_independent = double(draws.chains * draws.draws) / least;
  return found(ChainState::slow_mixing);
}

}  // namespace

Convergence assess(const Draws& draws, const SamplingFacts& facts, const ConvergenceLimits& limits) {
  expect(!draws.names.empty() && draws.chains > 0 && draws.values.size() == draws.chains * draws.draws * draws.names.size(),
         "draws have the size of their names");
  Convergence c;
  std::optional<std::size_t> still;  // the first parameter with a chain that has not moved
  for (std::size_t k = 0; k < draws.names.size(); ++k) {
    const auto values = draws.of(k);
    c.parameters.push_back(summary_of(draws.names[k], {values, draws.chains, draws.walkers}));
    if (!still && !still_chains({values, draws.chains, draws.walkers}).empty()) still = k;
  }
  const auto worst =
      std::max_element(c.parameters.begin(), c.parameters.end(), [&](const auto& a, const auto& b) { return lack(a, limits) < lack(b, limits); });
  c.parameter = worst->name;
  c.e_bfmi = facts.e_bfmi;
  c.divergences = facts.divergences;
  const bool known = std::all_of(c.parameters.begin(), c.parameters.end(), [&](const auto& s) { return within(s, limits); });
  const auto slow = slow_energies(facts, limits);
  c.converged = known && slow.empty() && !still;
  c.finding = common_finding(draws, facts);
  if (!known) {
    c.finding = cause(draws, std::size_t(worst - c.parameters.begin()), *worst, facts, limits);
  } else if (still) {
    c.parameter = c.parameters[*still].name;
    c.finding = cause(draws, *still, c.parameters[*still], facts, limits);
  } else if (!slow.empty()) {
    c.finding = slow_energy_finding(c.finding, slow, facts);
  } else {
    c.finding.state = ChainState::converged;
  }
  return c;
}

Json convergence_json(const Convergence& convergence, const std::string& message) {
  const auto number = [](double x) { return std::isfinite(x) ? Json(x) : Json(); };
  Json parameters = Json::array();
  for (const auto& s : convergence.parameters)
    parameters.push_back({{"name", s.name},
                          {"mean", number(s.mean)},
                          {"sd", number(s.sd)},
                          {"q05", number(s.q05)},
                          {"q50", number(s.q50)},
                          {"q95", number(s.q95)},
                          {"r_hat", number(s.r_hat)},
                          {"ess_bulk", number(s.ess_bulk)},
                          {"ess_tail", number(s.ess_tail)},
                          {"mcse_mean", number(s.mcse_mean)},
                          {"mcse_sd", number(s.mcse_sd)},
                          {"mcse_q05", number(s.mcse_q05)},
                          {"mcse_q50", number(s.mcse_q50)},
                          {"mcse_q95", number(s.mcse_q95)}});
  Json json{{"parameters", parameters}, {"converged", convergence.converged}, {"message", message}};
  if (convergence.e_bfmi.empty()) return json;
  json["divergences"] = convergence.divergences;
  json["e_bfmi"] = Json::array();
  for (const double e : convergence.e_bfmi) json["e_bfmi"].push_back(number(e));
  return json;
}

}  // namespace calomel
