#include "uq/convergence/assess.hpp"

#include <fmt/format.h>

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

/// Correlation over all draws, each chain about its own mean: of the shape, not of where chains stand.
double correlation_within(ChainDraws a, ChainDraws b) {
  double aa = 0, bb = 0, ab = 0;
  for (std::size_t c = 0; c < a.chains; ++c) {
    const auto x = a.values.subspan(c * a.draws(), a.draws()), y = b.values.subspan(c * b.draws(), b.draws());
    const double mx = mean_of(x), my = mean_of(y);
    for (std::size_t i = 0; i < x.size(); ++i) aa += (x[i] - mx) * (x[i] - mx), bb += (y[i] - my) * (y[i] - my), ab += (x[i] - mx) * (y[i] - my);
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

ParameterSummary summary_of(const std::string& name, ChainDraws x) {
  const bool finite = std::all_of(x.values.begin(), x.values.end(), [](double v) { return std::isfinite(v); });
  ParameterSummary s{.name = name, .mean = nan, .sd = nan, .q05 = nan, .q50 = nan, .q95 = nan};
  if (finite && x.values.size() > 1)
    s.mean = mean_of(x.values), s.sd = sd(x.values), s.q05 = quantile(x.values, 0.05), s.q50 = quantile(x.values, 0.5), s.q95 = quantile(x.values, 0.95);
  s.r_hat = split_r_hat(x), s.ess_bulk = ess_bulk(x), s.ess_tail = ess_tail(x);
  s.mcse_mean = mcse_mean(x), s.mcse_sd = mcse_sd(x);
  s.mcse_q05 = mcse_quantile(x, 0.05), s.mcse_q50 = mcse_quantile(x, 0.5), s.mcse_q95 = mcse_quantile(x, 0.95);
  return s;
}

/// By how much a parameter misses the limits; 1 or less is within, infinite where there is no answer.
double lack(const ParameterSummary& s, const ConvergenceLimits& limits) {
  const auto ratio = [](double x) { return std::isnan(x) ? INFINITY : x; };
  return std::max({ratio((s.r_hat - 1) / (limits.r_hat - 1)), ratio(limits.ess / s.ess_bulk), ratio(limits.ess / s.ess_tail)});
}

bool within(const ParameterSummary& s, const ConvergenceLimits& limits) {
  return s.r_hat < limits.r_hat && s.ess_bulk >= limits.ess && s.ess_tail >= limits.ess;
}

std::string numbers(const ParameterSummary& s) {
  return fmt::format("R-hat {:.4f}, effective sample sizes {:.0f} in the bulk and {:.0f} in the tails", s.r_hat, s.ess_bulk, s.ess_tail);
}

/// "1, 3 and 4", counted from 1; of many the first few and how many more: walkers of an ensemble count in hundreds.
std::string chain_numbers(const std::vector<std::size_t>& chains) {
  constexpr std::size_t told = 8, first = 3;
  std::string s;
  if (chains.size() > told) return fmt::format("{}, {}, {} and {} more", chains[0] + 1, chains[1] + 1, chains[2] + 1, chains.size() - first);
  for (std::size_t i = 0; i < chains.size(); ++i) s += (i == 0 ? "" : i + 1 == chains.size() ? " and " : ", ") + std::to_string(chains[i] + 1);
  return s;
}

/// Chains in which all draws are one. Many others hide them from R-hat.
std::vector<std::size_t> still_chains(ChainDraws x) {
  std::vector<std::size_t> still;
  for (std::size_t c = 0; c < x.chains; ++c)
    if (const auto v = x.values.subspan(c * x.draws(), x.draws()); v.size() > 1 && std::all_of(v.begin(), v.end(), [&](double u) { return u == v[0]; }))
      still.push_back(c);
  return still;
}

/// Two groups of chains with a gap between them that no chain crosses.
struct Groups {
  std::vector<std::size_t> low, high;
  double low_at = 0, high_at = 0;  ///< mean of the chains' means
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

/// Whether at least three chains in four go one way throughout: the means of their thirds rise or fall, by more than three deviations in all.
bool drifts(ChainDraws x) {
  std::size_t drifting = 0;
  for (std::size_t c = 0; c < x.chains; ++c) {
    const auto v = x.values.subspan(c * x.draws(), x.draws());
    const std::size_t third = v.size() / 3;
    if (third < 2) return false;
    const auto first = v.first(third), last = v.last(third);
    const double a = mean_of(first), b = mean_of(v.subspan(third, third)), e = mean_of(last);
    drifting += (b - a) * (e - b) > 0 && std::abs(e - a) > 3 * std::min(sd(first), sd(last));
  }
  return 4 * drifting >= 3 * x.chains;
}

constexpr double telling_share = 0.001;  ///< of trajectories that diverge, from which on they are the likely cause

/// Chains whose energies change too slowly.
std::vector<std::size_t> slow_energies(const SamplingFacts& facts, const ConvergenceLimits& limits) {
  std::vector<std::size_t> chains;
  for (std::size_t c = 0; c < facts.e_bfmi.size(); ++c)
    if (facts.e_bfmi[c] < limits.e_bfmi) chains.push_back(c);
  return chains;
}

std::string slow_energy_sentence(const std::vector<std::size_t>& low, const SamplingFacts& facts, const std::string& name) {
  return fmt::format(
      "the energy changes too slowly in {} {} (E-BFMI {:.2f}), so that the tails are told by diffusion alone: they are heavy, or there is a funnel, and {} is "
      "the parameter known "
      "worst; infer it on a logarithmic scale or give it a prior that bounds it",
      low.size() > 1 ? "chains" : "chain", chain_numbers(low), facts.e_bfmi[low[0]], name);
}

std::string cause(const Draws& draws, std::size_t worst, const ParameterSummary& s, const SamplingFacts& facts, const ConvergenceLimits& limits) {
  const auto values = draws.of(worst);
  const ChainDraws x{values, draws.chains, draws.walkers};
  const std::string& name = s.name;
  if (draws.draws < 4) return fmt::format("{} cannot be judged by {} draws a chain; set sampler.draws to some thousands", name, draws.draws);
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
    return fmt::format(
        "{} has draws that are not finite, so the density or its transformation is wrong there; look at them in posterior.nc and narrow the bounds of {}", name,
        name);
  if (std::all_of(values.begin(), values.end(), [&](double v) { return v == values[0]; }))
    return fmt::format(
        "{} has not moved: all draws are {:g}, because every proposal was refused; start from the covariance of calibrate --method map, or raise "
        "sampler.warmup",
        name, values[0]);
  if (const auto still = still_chains(x); !still.empty())
    return fmt::format(
        "{} has not moved in {} {} (R-hat {:.3f}), while other chains did; those started where proposals are refused, so lower sampler.dispersion or raise "
        "sampler.warmup",
        name, still.size() > 1 ? "chains" : "chain", chain_numbers(still), s.r_hat);
  if (s.r_hat >= limits.r_hat && drifts(x))
    return fmt::format(
        "{} still drifts in one direction in most chains ({}), so the warm-up ended before they had arrived; double sampler.warmup, or start from the mode and "
        "covariance of calibrate --method map",
        name, numbers(s));
  if (s.r_hat >= limits.r_hat)
    if (const auto g = separate_groups(x))
      return fmt::format(
          "{} lies near {:.5g} in {} {} and near {:.5g} in {} {}, and no chain goes from one to the other (R-hat {:.2f}): two modes, whose weights these draws "
          "do not tell; "
          "compare the modes (calibrate --method map lists other optima) and narrow the bounds or the prior of {} to the one that is meant",
          name, g->low_at, g->low.size() > 1 ? "chains" : "chain", chain_numbers(g->low), g->high_at, g->high.size() > 1 ? "chains" : "chain",
          chain_numbers(g->high), s.r_hat, name);
  const double kept = double(std::max<std::size_t>(1, facts.transitions));
  if (double(facts.divergences) > telling_share * kept)
    return fmt::format(
        "{} is not known ({}) and {} of {} trajectories diverged: the density bends more sharply somewhere than their steps can follow, as in a funnel, or "
        "ends at an edge; "
        "raise sampler.nuts.target to 0.95, or infer {} on a logarithmic scale",
        name, numbers(s), facts.divergences, facts.transitions, name);
  if (double(facts.cut) > 0.1 * kept)
    return fmt::format(
        "{} mixes slowly ({}) because {:.0f} % of the trajectories are ended by sampler.nuts.depth before they turn: scales differ more than the metric tells; "
        "double "
        "sampler.warmup, so that it is learnt, or raise sampler.nuts.depth",
        name, numbers(s), 100 * double(facts.cut) / kept);
  // Effective sizes grow with the draws; R-hat - 1 of many chains that are short falls with them.
  const double least = std::max(1.0, std::min(s.ess_bulk, s.ess_tail)), lacking = std::max(limits.ess / least, (s.r_hat - 1) / (limits.r_hat - 1));
  const double needed = 1.2 * lacking * double(draws.draws), step = needed < 1000 ? 100 : 1000, rounded = std::ceil(needed / step) * step;
  if (!facts.remedies.correlation_key.empty())
    return fmt::format(
        "{} is told differently by populations of particles ({}), which still have ancestors in common where they arrive; halve sampler.smc.correlation, so "
        "that they move more, and set "
        "sampler.draws = {:.0f}",
        name, numbers(s), std::max(rounded, 2 * double(draws.draws)));
  if (!facts.remedies.emulator_only.empty() && facts.acceptance && *facts.acceptance < 0.2)
    return fmt::format(
        "{} mixes slowly ({}) because the true model refuses {:.0f} % of what the emulator proposes: the two disagree there, or runs carry much numerical "
        "noise; give the emulator more runs "
        "(emulator.rounds), or take sampler.kind = \"dram\", whose check by the true model tells by how much they differ",
        name, numbers(s), 100 * (1 - *facts.acceptance));
  if (facts.acceptance && *facts.acceptance < 0.05)
    return fmt::format(
        "{} mixes slowly ({}) because only {:.1f} % of the transitions move: the frozen proposal does not fit the density; raise sampler.warmup, or start from "
        "the covariance of calibrate --method map",
        name, numbers(s), 100 * *facts.acceptance);
  std::size_t partner = worst;
  double strongest = 0;
  for (std::size_t k = 0; k < draws.names.size(); ++k)
    if (k != worst) {
      const auto other = draws.of(k);
      if (const double r = correlation_within(x, {other, draws.chains}); std::abs(r) > std::abs(strongest)) strongest = r, partner = k;
    }
  if (std::abs(strongest) > 0.95)
    return fmt::format(
        "{} mixes slowly ({}) along the narrow ridge that it forms with {} (correlation {:.3f}); give one of the two a prior from elsewhere, or let the "
        "proposal learn the ridge: start from the covariance of calibrate --method map and double sampler.warmup",
        name, numbers(s), draws.names[partner], strongest);
  if (const auto low = slow_energies(facts, limits); !low.empty()) return slow_energy_sentence(low, facts, name);
  if (s.r_hat < limits.r_hat && s.ess_bulk >= limits.ess)
    return fmt::format(
        "{} visits its tails too seldom ({}): long tails or a funnel towards one end; look at its pairs in the report, and infer it on a logarithmic scale or "
        "bound it where values are impossible",
        name, numbers(s));
  if (s.ess_bulk >= limits.ess && s.ess_tail >= limits.ess)
    return fmt::format(
        "{} differs a little between {} ({}), each of which has draws enough: they have not forgotten where they began; double sampler.warmup and set "
        "sampler.draws = {:.0f}",
        name, draws.walkers > 1 ? "walkers" : "chains", numbers(s), rounded);
  if (s.r_hat < 1.05)
    return fmt::format("{} has too few independent draws ({}); at this rate {:.0f} draws a chain are enough: set sampler.draws = {:.0f}{}", name, numbers(s),
                       needed, rounded, facts.thin > 1 ? fmt::format(" (sampler.thin = {})", facts.thin) : "");
  return fmt::format(
      "{} differs between chains that overlap ({}): they mix too slowly for their length, one draw in {:.0f} being independent; double sampler.warmup, so that "
      "the proposal fits, and set sampler.draws = {:.0f}",
      name, numbers(s), double(draws.chains * draws.draws) / least, rounded);
}

}  // namespace

Convergence assess(const Draws& draws, const SamplingFacts& facts, const ConvergenceLimits& limits) {
  expect(!draws.names.empty() && draws.chains > 0 && draws.values.size() == draws.chains * draws.draws * draws.names.size(),
         "draws have the size of their names");
  Convergence c;
  std::optional<std::size_t> still;  // a parameter with a chain that has not moved
  for (std::size_t k = 0; k < draws.names.size(); ++k) {
    const auto values = draws.of(k);
    c.parameters.push_back(summary_of(draws.names[k], {values, draws.chains, draws.walkers}));
    if (!still && !still_chains({values, draws.chains, draws.walkers}).empty()) still = k;
  }
  const auto worst =
      std::max_element(c.parameters.begin(), c.parameters.end(), [&](const auto& a, const auto& b) { return lack(a, limits) < lack(b, limits); });
  c.parameter = worst->name;
  c.e_bfmi = facts.e_bfmi, c.divergences = facts.divergences;
  const bool known = std::all_of(c.parameters.begin(), c.parameters.end(), [&](const auto& s) { return within(s, limits); });
  const auto slow = slow_energies(facts, limits);
  c.converged = known && slow.empty() && !still;
  if (!known)
    c.message = cause(draws, std::size_t(worst - c.parameters.begin()), *worst, facts, limits);
  else if (still)
    c.parameter = c.parameters[*still].name, c.message = cause(draws, *still, c.parameters[*still], facts, limits);
  else if (!slow.empty())
    c.message = slow_energy_sentence(slow, facts, worst->name);
  else
    c.message = fmt::format("converged: {} is the least well known, with {}", worst->name, numbers(*worst));
  if (c.converged && facts.divergences > 0)
    c.message += fmt::format("; {} of {} trajectories diverged: draws may be missing where the density bends sharply, raise sampler.nuts.target to 0.95 to see",
                             facts.divergences, facts.transitions);
  return c;
}

Json convergence_json(const Convergence& convergence) {
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
  Json json{{"parameters", parameters}, {"converged", convergence.converged}, {"message", convergence.message}};
  if (convergence.e_bfmi.empty()) return json;
  json["divergences"] = convergence.divergences, json["e_bfmi"] = Json::array();
  for (const double e : convergence.e_bfmi) json["e_bfmi"].push_back(number(e));
  return json;
}

}  // namespace calomel
