#include "apps/report/sections/chains.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "apps/report/data/json_values.hpp"
#include "apps/report/data/quantities.hpp"
#include "apps/report/data/series.hpp"
#include "apps/report/data/density_curve.hpp"
#include "uq/convergence/diagnostics.hpp"

namespace calomel {

namespace {

constexpr std::size_t most_quantities = 6;
constexpr std::size_t most_chains = 16;
constexpr std::size_t trace_points = 300;
constexpr std::size_t bins = 20;
constexpr std::size_t prior_curve_points = 120;
constexpr double far_moved = 2;  ///< half widths of the prior above which a move is set in bold

const Parameter* parameter_of(const ReportInput& input, const std::string& name) {
  for (const auto& p : input.parameters)
    if (p.name == name) return &p;
  return nullptr;
}

std::optional<std::size_t> index_of(const Draws& draws, const std::string& name) {
  const auto at = std::find(draws.names.begin(), draws.names.end(), name);
  return at == draws.names.end() ? std::nullopt : std::optional(std::size_t(at - draws.names.begin()));
}

/// Half of the central 68.3 % interval. It is the standard deviation of a Gaussian, and it does not depend on the tails.
double half_width(const std::vector<double>& values) { return 0.5 * (quantile(values, 0.8413) - quantile(values, 0.1587)); }

/// Counts of the ranks among all draws, (chain, bin), of the first `shown` chains.
Json rank_counts(const std::vector<double>& values, std::size_t chains, std::size_t draws, std::size_t shown) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> rank(values.size());
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i + 1;
    while (end < order.size() && values[order[end]] == values[order[i]]) ++end;
    for (std::size_t k = i; k < end; ++k) rank[order[k]] = 0.5 * double(i + end - 1);  // equal draws share a rank
    i = end;
  }
  Json all = Json::array();
  for (std::size_t c = 0; c < std::min(chains, shown); ++c) {
    std::vector<int> count(bins, 0);
    for (std::size_t i = 0; i < draws; ++i) ++count[std::min(bins - 1, std::size_t(rank[c * draws + i] / double(values.size()) * double(bins)))];
    all.push_back(count);
  }
  return all;
}

/// The density over the central 99 % of the draws and a quarter of it to either side. It ends at the bounds of `p` when all draws lie within them, and at 0
/// when all draws are positive.
Json curve_json(const std::vector<double>& values, const Parameter* p) {
  const double inner_low = quantile(values, 0.005);
  const double inner_high = quantile(values, 0.995);
  const double room = 0.25 * (inner_high - inner_low) + 1e-12 * std::abs(inner_low) + 1e-300;
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  const bool bounded = p && *least >= p->min && *greatest <= p->max;
  const auto lower = bounded ? std::optional(p->min) : *least > 0 ? std::optional(0.0) : std::nullopt;
  const auto upper = bounded ? std::optional(p->max) : std::nullopt;
  const double low = lower ? std::max(*lower, inner_low - room) : inner_low - room;
  const double high = upper ? std::min(*upper, inner_high + room) : inner_high + room;
  Json density = Json::array();
  for (const double v : density_curve(values, low, high, lower, upper, prior_curve_points)) density.push_back(rounded(v, 4));
  return {{"span", {low, high}}, {"density", std::move(density)}};
}

bool finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace

std::vector<BrokenOff> broken_off(const Draws& draws) {
  constexpr double slice = 0.1;  // of the half width
  constexpr double share = 0.2;  // of the fullest slice
  std::vector<BrokenOff> out;
  for (std::size_t k = 0; k < draws.names.size(); ++k) {
    auto x = draws.of(k);
    if (x.size() < 1000 || !finite(x)) continue;
    std::sort(x.begin(), x.end());
    const double width = slice * half_width(x);
    if (!(width > 0)) continue;
    const auto within = [&](double low, double high) { return double(std::upper_bound(x.begin(), x.end(), high) - std::lower_bound(x.begin(), x.end(), low)); };
    double fullest = 0;
    for (double low = x.front(); low < x.back(); low += width) fullest = std::max(fullest, within(low, low + width));
    if (within(x.front(), x.front() + width) > share * fullest) out.push_back({draws.names[k], x.front()});
    if (within(x.back() - width, x.back()) > share * fullest) out.push_back({draws.names[k], x.back()});
  }
  return out;
}

bool informed(const std::string& name, const Study& study, const ReportInput& input) {
  const Parameter* p = parameter_of(input, name);
  return !p || p->prior != "uniform" || (study.sample && text_at(*study.sample, "product") == "physical");
}

std::vector<std::size_t> shown_quantities(const Draws& draws, const ReportInput& input) {
  std::vector<std::size_t> list;
  const auto add = [&](std::size_t k) {
    if (list.size() < most_quantities && std::find(list.begin(), list.end(), k) == list.end() && !draws.of(k).empty() && finite(draws.of(k))) list.push_back(k);
  };
  for (const auto& p : input.parameters)
    if (const auto k = index_of(draws, p.name)) add(*k);
  for (std::size_t k = 0; k < draws.names.size(); ++k) add(k);
  return list;
}

Json chains_json(const Study& study, const ReportInput& input) {
  if (!study.posterior || study.posterior->values.empty()) return nullptr;
  const Draws& draws = *study.posterior;
  const std::size_t step = stride(draws.draws, trace_points);
  const std::size_t drawn = std::min(draws.chains, most_chains);
  Json quantities = Json::array();
  Json iterations = Json::array();
  Json deviations = Json::array();
  for (std::size_t i = 0; i < draws.draws; i += step) iterations.push_back(i);
  const double expected = double(draws.draws) / double(bins);
  for (const std::size_t k : shown_quantities(draws, input)) {
    const auto values = draws.of(k);
    const double ess = ess_bulk({values, draws.chains, draws.walkers});
    const double r_hat = split_r_hat({values, draws.chains, draws.walkers});
    Json trace = Json::array();
    for (std::size_t c = 0; c < drawn; ++c) {
      Json line = Json::array();
      for (std::size_t i = 0; i < draws.draws; i += step) line.push_back(rounded(draws.at(c, i, k), 6));
      trace.push_back(std::move(line));
    }
    const double tau = std::isfinite(ess) && ess > 0 ? std::max(1.0, double(values.size()) / ess) : 1;
    deviations.push_back(rounded(2 * std::sqrt(expected * (1 - 1 / double(bins)) * tau), 4));
    quantities.push_back({{"label", parameter_label(input, draws.names[k])},
                          {"r_hat", rounded(r_hat, 5)},
                          {"ess", rounded(std::round(ess), 6)},
                          {"trace", std::move(trace)},
                          {"ranks", rank_counts(values, draws.chains, draws.draws, drawn)}});
  }
  return {{"quantities", std::move(quantities)},
          {"iterations", std::move(iterations)},
          {"chains", drawn},
          {"of", draws.chains},
          {"bins", bins},
          {"expected", expected},
          {"spread", std::move(deviations)}};
}

Table prior_table(const Study& study, const ReportInput& input) {
  Table t{.id = "posterior_priors", .caption = "What was known before the records, and after them. Half width: half of what 68 % of the draws lie between."};
  if (!study.prior || !study.posterior) return t;
  t.columns = {{"parameter", "Parameter", 4, true},
               {"prior_median", "Median before", 5},
               {"prior_half_width", "Half width before", 3},
               {"posterior_median", "Median after", 5},
               {"posterior_half_width", "Half width after", 3},
               {"narrower", "Times narrower", 3},
               {"moved", "Moved by [half widths before]", -1}};
  for (std::size_t k = 0; k < study.prior->names.size(); ++k) {
    const auto name = study.prior->names[k];
    const auto at = index_of(*study.posterior, name);
    if (!at) continue;
    const auto before = study.prior->of(k);
    const auto after = study.posterior->of(*at);
    if (before.empty() || after.empty() || !finite(before) || !finite(after)) continue;
    const double wide = half_width(before);
    const double narrow = half_width(after);
    const double moved = (quantile(after, 0.5) - quantile(before, 0.5)) / wide;
    t.rows.push_back({parameter_label(input, name), quantile(before, 0.5), wide, quantile(after, 0.5), narrow,
                      narrow > 0 ? std::optional(wide / narrow) : std::nullopt,
                      informed(name, study, input) && wide > 0 ? Cell(moved, std::abs(moved) > far_moved) : Cell()});
  }
  return t;
}

Json priors_json(const Study& study, const ReportInput& input) {
  if (!study.prior || !study.posterior) return nullptr;
  Json panels = Json::array();
  for (const std::size_t k : shown_quantities(*study.posterior, input)) {
    const auto& name = study.posterior->names[k];
    const auto at = index_of(*study.prior, name);
    if (!at) continue;
    const auto before = study.prior->of(*at);
    const auto after = study.posterior->of(k);
    if (before.empty() || !finite(before)) continue;
    const Parameter* p = parameter_of(input, name);
    Json prior = curve_json(before, p);
    Json posterior = curve_json(after, p);
    const double low = std::min(prior["span"][0].get<double>(), posterior["span"][0].get<double>());
    const double high = std::max(prior["span"][1].get<double>(), posterior["span"][1].get<double>());
    panels.push_back({{"label", parameter_label(input, name)}, {"span", {low, high}}, {"prior", std::move(prior)}, {"posterior", std::move(posterior)}});
  }
  return panels.empty() ? Json() : Json{{"panels", std::move(panels)}};
}

}  // namespace calomel
