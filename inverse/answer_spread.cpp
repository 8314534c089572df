#include "inverse/answer_spread.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/linear_algebra.hpp"
#include "inverse/calibration.hpp"
#include "inverse/prior.hpp"

namespace calomel {

namespace {

constexpr Eigen::Index fewest = 8;     ///< answers, for a covariance
constexpr std::size_t fewest_pairs = 6;  ///< to be judged by
constexpr double on_bound = 1e-3;      ///< of the interval
constexpr double worth_telling = 0.1;  ///< share of draws on a bound

std::string percent(double share) { return share < 1 ? fmt::format("{:.2g} %", 100 * share) : fmt::format("a factor of {:.2g}", 1 + share); }

}  // namespace

void summarise(AnswerSpread& s, const std::vector<Parameter>& parameters, const std::vector<double>& answer) {
  const auto n = Eigen::Index(parameters.size());
  if (s.answers.cols() < fewest) {
    s.sentence = fmt::format("no standard deviations: {} of {} drawn records led to an answer", s.answers.cols(), s.wanted);
    return;
  }
  const Eigen::VectorXd at = Eigen::Map<const Eigen::VectorXd>(answer.data(), n);
  const Eigen::MatrixXd off = s.answers.colwise() - at;
  s.covariance = s.inflation * off * off.transpose() / double(off.cols());
  s.log_sd = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::quiet_NaN());
  Eigen::VectorXd prior_sd(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto& p = parameters[std::size_t(k)];
    prior_sd[k] = Prior(p).scale();
    if (at[k] > 0 && s.answers.row(k).minCoeff() > 0) s.log_sd[k] = std::sqrt(s.inflation * (s.answers.row(k).array() / at[k]).log().square().mean());
  }
  s.at_bounds = 0;
  for (Eigen::Index i = 0; i < off.cols(); ++i) {
    bool bound = false;
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto& p = parameters[std::size_t(k)];
      const double share = (s.answers(k, i) - p.min) / (p.max - p.min);
      bound = bound || share < on_bound || share > 1 - on_bound;
    }
    s.at_bounds += bound;
  }
  Eigen::MatrixXd flat = s.covariance;
  flat.diagonal() += 1e-12 * prior_sd.cwiseAbs2();
  s.combinations = identify(parameters, answer, inverse(flat), s.covariance, prior_sd).combinations;
  std::string list;
  for (Eigen::Index k = 0; k < n; ++k) {
    const double sd = std::sqrt(s.covariance(k, k));
    list += fmt::format("{}{} {}", list.empty() ? "" : ", ", parameters[std::size_t(k)].name, at[k] != 0 ? percent(sd / std::abs(at[k])) : fmt::format("{:.2g}", sd));
  }
  for (const auto& c : s.combinations)
    if (c.name.starts_with("impedance")) list += fmt::format(", {} {}", c.name, percent(c.relative_sd));
  s.sentence = fmt::format("standard deviations by {} draws of the errors of records and model: {}", s.answers.cols(), list);
  if (double(s.at_bounds) > worth_telling * double(off.cols()))
    s.sentence += fmt::format("; {} of the draws end on a bound, without which these would be larger", s.at_bounds);
}

void widen(AnswerSpread& s, const std::vector<Parameter>& parameters, const std::vector<double>& answer, std::vector<FoundPair> pairs) {
  if (pairs.size() < fewest_pairs) return;
  const auto n = Eigen::Index(parameters.size());
  std::vector<double> squares;
  for (auto& p : pairs) {
    const Eigen::VectorXd e = Eigen::Map<const Eigen::VectorXd>(p.found.data(), n) - Eigen::Map<const Eigen::VectorXd>(p.theta.data(), n);
    p.squares = e.dot(solve_symmetric(s.covariance, e)), squares.push_back(p.squares);
  }
  std::sort(squares.begin(), squares.end());
  const std::size_t m = squares.size();
  const double ratio = 0.5 * (squares[(m - 1) / 2] + squares[m / 2]) / boost::math::median(boost::math::chi_squared(double(n)));
  s.pairs = std::move(pairs), s.inflation = std::max(1.0, ratio);
  summarise(s, parameters, answer);
  s.sentence += fmt::format("; the parameters of {} pairs of runs, each left out in turn, are found {:.2g} times as far off as the drawn deviations say (by the median)", s.pairs.size(), std::sqrt(ratio));
  if (s.inflation > 1) s.sentence += ", by which the drawn ones are widened: the mesh's error varies from place to place more than the pairs tell";
}


Json combinations_json(std::span<const Combination> combinations) {
  Json all = Json::array();
  for (const auto& c : combinations)
    all.push_back({{"name", c.name}, {"value", number(c.value)}, {"low", number(c.low)}, {"high", number(c.high)}, {"relative_sd", number(c.relative_sd)}});
  return all;
}

Json spread_json(const AnswerSpread& s, const std::vector<Parameter>& parameters) {
  Json j = Json::object();
  if (s.wanted == 0) return j;
  j["spread"] = {{"draws", s.wanted}, {"answers", Json::array()}, {"at_bounds", s.at_bounds}, {"sentence", s.sentence}, {"seconds", s.seconds}};
  if (!s.told()) return j;
  j["parameters"] = Json::array(), j["sd"] = Json::object(), j["log_sd"] = Json::object();
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const auto at = Eigen::Index(k);
    j["parameters"].push_back(parameters[k].name);
    j["sd"][parameters[k].name] = number(std::sqrt(s.covariance(at, at))), j["log_sd"][parameters[k].name] = number(s.log_sd[at]);
  }
  j["covariance"] = matrix_json(s.covariance);
  j["combinations"] = combinations_json(s.combinations);
  j["spread"]["answers"] = matrix_json(s.answers.transpose());
  j["spread"]["left_out_pairs"] = {{"inflation", s.inflation}, {"pairs", Json::array()}};
  for (const auto& p : s.pairs) {
    Json pair{{"theta", Json::object()}, {"found", Json::object()}, {"squared_distance", number(p.squares)}};
    for (std::size_t k = 0; k < parameters.size(); ++k) pair["theta"][parameters[k].name] = number(p.theta[k]), pair["found"][parameters[k].name] = number(p.found[k]);
    j["spread"]["left_out_pairs"]["pairs"].push_back(std::move(pair));
  }
  j["spread"]["covariance_shares"] = Json::object();
  for (const auto& [source, share] : s.shares) j["spread"]["covariance_shares"][source] = number(share);
  return j;
}

FieldInfo draws_info() {
  return {.range = between(0, 1000),
          .doc = "drawn errors of records and model, to each of which the answer is sought anew: their spread is the reported covariance; at least 8, 0 reports none"};
}

}  // namespace calomel
