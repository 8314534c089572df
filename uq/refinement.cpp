#include "uq/refinement.hpp"

#include <algorithm>
#include <optional>

#include "forward/emulator/infill.hpp"
#include "uq/posterior_moments.hpp"

namespace calomel {

namespace {

constexpr std::uint64_t seeds_apart = 100000;
constexpr Eigen::Index draws_taken = 400;
constexpr double apart = 0.2;             ///< least distance in u between a draw and a run of the check, as between runs of an infill
constexpr double box_sds = 4;             ///< half width of a shrunk box in posterior standard deviations
constexpr double worth_shrinking = 0.75;  ///< greatest ratio of the new to the old width for which the box is shrunk
constexpr double narrowest = 0.4;         ///< least ratio of the widths in one refinement, because an emulator that does not hold misestimates the deviations

/// Draws u from the posterior, evenly spaced over its chains: (n_parameters, n).
Eigen::MatrixXd posterior_draws(const PosteriorFit& fit, std::uint64_t seed) {
  const LogPosterior& posterior = *fit.posterior;
  const auto found = modes_in_box(posterior, fit.modes, seed, 1);
  const Draws chains = short_chains(posterior, start_at_modes(posterior, fit.modes, found), seed).coordinates;
  const auto all = Eigen::Index(chains.chains * chains.draws);
  const Eigen::Index d = posterior.dimension();
  const Eigen::Index step = std::max<Eigen::Index>(1, all / draws_taken);
  Eigen::MatrixXd u(posterior.box().size(), (all + step - 1) / step);
  for (Eigen::Index i = 0; i < u.cols(); ++i) u.col(i) = posterior.point(Eigen::Map<const Eigen::VectorXd>(chains.values.data() + i * step * d, d)).u;
  return u;
}

/// n of the draws, evenly spaced in their order.
Eigen::MatrixXd evenly(const Eigen::MatrixXd& draws, Eigen::Index n) {
  std::vector<Eigen::Index> taken;
  for (Eigen::Index i = 0; i < n; ++i) taken.push_back((2 * i + 1) * draws.cols() / (2 * n));
  return draws(Eigen::all, taken);
}

Eigen::MatrixXd without_those_near(const Eigen::MatrixXd& draws, const std::vector<Eigen::VectorXd>& points) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < draws.cols(); ++i)
    if (std::none_of(points.begin(), points.end(), [&](const auto& p) { return (draws.col(i) - p).norm() < apart; })) kept.push_back(i);
  return draws(Eigen::all, kept);
}

/// The inputs of the next fit: all runs so far and the new ones, in a box no wider than the posterior needs.
struct Next {
  PosteriorInputs in;
  bool shrank_box = false;
};

Next next_inputs(const PosteriorInputs& in, const PosteriorFit& fit, const TrueModelCheck& check, std::uint64_t seed) {
  const EmulatorBox& box = fit.posterior->box();
  const Eigen::Index d = box.size();
  Next next{.in = in};
  next.in.seed = seed;
  next.in.known = fit.runs;
  next.in.known_dimension = in.parameters.size();
  const Eigen::MatrixXd draws = posterior_draws(fit, seed);

  // The runs of the check are stored by now, so that requesting them again makes no run.
  std::vector<Eigen::VectorXd> points;
  std::vector<int> level;
  for (const auto& r : check.runs) {
    points.push_back(box.u(r.theta));
    level.push_back(r.level);
  }
  const Eigen::MatrixXd free = without_those_near(draws, points);
  if (free.cols() > 0) {
    const InfillPoints more = infill(fit.posterior->emulator(), free, in.emulator.round_coarse, in.emulator.round_fine);
    for (Eigen::Index i = 0; i < more.u.cols(); ++i) {
      points.push_back(more.u.col(i));
      level.push_back(more.level[std::size_t(i)]);
    }
  }
  Eigen::MatrixXd thetas(d, Eigen::Index(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::vector<double> theta = i < check.runs.size() ? check.runs[i].theta : box.theta(points[i]);
    thetas.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXd>(theta.data(), d);
  }
  auto records = in.run(thetas, level);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const auto at = thetas.col(Eigen::Index(i));
    next.in.known.push_back({{at.begin(), at.end()}, level[i], std::move(records[i])});
  }

  const Eigen::VectorXd sd =
      ((draws.colwise() - draws.rowwise().mean()).cwiseAbs2().rowwise().sum() / double(std::max<Eigen::Index>(1, draws.cols() - 1))).cwiseSqrt();
  const Eigen::VectorXd width = (box_sds * sd).cwiseMax(narrowest).cwiseMin(1.0);
  next.shrank_box = width.minCoeff() < worth_shrinking;
  const Eigen::VectorXd middle = Eigen::VectorXd::Zero(d);
  const auto centre = next.shrank_box ? fit.modes[0].at.theta : box.theta(middle);
  next.in.centre.assign(centre.begin(), centre.end());
  next.in.half_width.clear();
  for (Eigen::Index k = 0; k < d; ++k) {
    const Parameter& p = in.parameters[std::size_t(k)];
    const double half = p.coordinate(box.theta(Eigen::VectorXd::Unit(d, k))[std::size_t(k)]) - p.coordinate(box.theta(middle)[std::size_t(k)]);
    next.in.half_width.push_back(half * (next.shrank_box ? width[k] : 1.0));
  }
  return next;
}

}  // namespace

RefinedFit check_and_refine(const PosteriorInputs& in, PosteriorFit first, int most, const std::function<void(const TrueModelCheck&)>& checked,
                            const std::function<void(const PosteriorRound&)>& round_done) {
  RefinedFit out{.fit = std::move(first), .check = {}, .refinements = {}};
  std::optional<PosteriorInputs> now(in);  // it holds references and cannot be assigned
  for (int made = 0;; ++made) {
    const Eigen::Index checks = std::max(1, in.emulator.check_coarse + in.emulator.check_fine);
    out.check = check_by_true_model(*now, out.fit, evenly(posterior_draws(out.fit, now->seed ^ check_stream), checks), in.emulator.check_coarse,
                                    in.emulator.check_fine);
    if (checked) checked(out.check);
    const bool any = std::any_of(out.check.runs.begin(), out.check.runs.end(), [](const auto& r) { return r.done; });
    if (out.check.holds || !any || made == most) {
      out.ended = out.check.holds ? RefinementEnd::holds : !any ? RefinementEnd::unchecked : most == 0 ? RefinementEnd::none_allowed : RefinementEnd::limit;
      return out;
    }
    const std::size_t held = out.fit.runs.size();
    Next next = next_inputs(*now, out.fit, out.check, in.seed + seeds_apart * std::uint64_t(made + 1));
    PosteriorFit fit = fit_posterior(next.in, {.round_done = round_done, .go_on = {}});
    out.refinements.push_back({.check = std::move(out.check), .runs = int(fit.runs.size() - held), .shrank_box = next.shrank_box});
    fit.rounds.insert(fit.rounds.begin(), out.fit.rounds.begin(), out.fit.rounds.end());
    out.fit = std::move(fit);
    now.emplace(std::move(next.in));
  }
}

}  // namespace calomel
