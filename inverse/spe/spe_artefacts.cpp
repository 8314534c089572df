#include <algorithm>
#include <limits>

#include "base/provenance.hpp"
#include "inverse/spe/spe.hpp"

namespace calomel {

namespace {

Json fit(const PolynomialFit& f) { return {{"rrmse", number(f.rrmse)}, {"r2", number(f.r2)}}; }

Json choice(const LambdaChoice& c, double lambda_max) {
  return {{"lambda", number(c.lambda)}, {"fraction", number(c.lambda / lambda_max)}, {"mean_squared_error", number(c.error)}};
}

/// Smallest, mean and largest over the valid surrogates.
template <class Get>
Json range_of(const SpeSummary& s, const Get& get) {
  double low = std::numeric_limits<double>::infinity(), high = -low, sum = 0;
  int n = 0;
  for (const auto& p : s.surrogates)
    if (p.ok()) {
      low = std::min(low, get(p));
      high = std::max(high, get(p));
      sum += get(p);
      ++n;
    }
  return {{"min", number(low)}, {"mean", number(n > 0 ? sum / n : std::numeric_limits<double>::quiet_NaN())}, {"max", number(high)}};
}

Json surrogate(const SpeSummary& s, std::size_t i) {
  const auto& p = s.surrogates[i];
  Json j{{"name", p.space.name()},     {"space", p.space.kind}, {"order", p.space.order},       {"terms", p.terms},      {"lambda", p.lambda},
         {"lambda_max", p.lambda_max}, {"nonzero", p.nonzero},  {"duality_gap", number(p.gap)}, {"train", fit(p.train)}, {"validation", fit(p.validation)}};
  if (!p.ok()) {
    j["failure"] = p.failure;
    return j;
  }
  double best = std::numeric_limits<double>::infinity();
  int optima = 0;
  for (const auto& o : s.optima)
    if (o.surrogate == i) {
      ++optima;
      best = std::min(best, s.objective.cost(o.objective));
    }
  j["optima"] = optima;
  j["best"] = number(s.objective.cost(best));
  return j;
}

}  // namespace

Json spe_json(const SpeSummary& s, const Problem& problem, const CalibrationWords& words, const Provenance& provenance) {
  const auto& shape = problem.shape;
  Json own;
  own["runs"] = {{"used", s.runs_used}, {"excluded", s.runs_excluded},  {"added", s.runs_added},
                 {"train", s.n_train},  {"validation", s.n_validation}, {"design", s.design}};
  own["train_rrmse"] = range_of(s, [](const auto& p) { return p.train.rrmse; });
  own["validation_rrmse"] = range_of(s, [](const auto& p) { return p.validation.rrmse; });
  own["train_r2"] = range_of(s, [](const auto& p) { return p.train.r2; });
  own["validation_r2"] = range_of(s, [](const auto& p) { return p.validation.r2; });
  own["optima_left_out"] = s.optima_left_out;
  own["zoom"] = Json::array();
  for (const auto& z : s.zooms)
    own["zoom"].push_back(
        {{"low", named(shape.parameters, z.low)}, {"high", named(shape.parameters, z.high)}, {"runs", z.runs}, {"made", z.made}, {"best", number(z.best)}});
  own["modes"] = Json::array();
  own["lambda_choices"] = Json::array();
  own["surrogates"] = Json::array();
  own["optima"] = Json::array();
  for (const auto& m : s.modes)
    own["modes"].push_back(
        {{"theta", named(shape.parameters, m.theta)}, {"objective_surrogate", number(m.objective)}, {"density", m.density}, {"optima", m.optima}});
  for (const auto& c : s.spaces)
    own["lambda_choices"].push_back({{"name", c.space.name()},
                                     {"terms", c.terms},
                                     {"lambda_max", number(c.lambda_max)},
                                     {"validation", choice(c.validation, c.lambda_max)},
                                     {"cross_validation", choice(c.cross_validation, c.lambda_max)}});
  for (std::size_t i = 0; i < s.surrogates.size(); ++i) own["surrogates"].push_back(surrogate(s, i));
  for (const auto& o : s.optima)
    own["optima"].push_back(
        {{"surrogate", o.surrogate}, {"theta", named(shape.parameters, o.theta)}, {"objective", number(o.objective)}, {"trials", o.trials}});
  own["fit_s"] = s.fit_s;
  return calibration_json(s, problem, own, words, provenance);
}

void write_spe(const SpeSummary& s, const Problem& problem, const CalibrationWords& words, const Provenance& provenance, const std::filesystem::path& out_dir) {
  write_calibration("spe", s, problem, spe_json(s, problem, words, provenance), provenance, out_dir);
}

}  // namespace calomel
