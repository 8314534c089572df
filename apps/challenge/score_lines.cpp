// The score for people, and as JSON.
#include <fmt/format.h>

#include <algorithm>

#include "apps/challenge/score.hpp"
#include "base/json.hpp"

namespace calomel::challenge {

namespace {

std::string percent(double x) { return fmt::format("{:.1f} %", 100 * x); }

/// "12 of 60, 20.0 % (95 % bounds 12.0 % and 30.3 %)"
std::string share_text(const Share& s) {
  if (s.of == 0) return "no case";
  const Bounds b = s.bounds();
  return fmt::format("{} of {}, {} (95 % bounds {} and {})", s.count, s.of, percent(s.share()), percent(b.lower), percent(b.upper));
}

std::string state_text(GateState state) { return state == GateState::met ? "met" : state == GateState::not_met ? "NOT MET" : "no case"; }

void add_confusion(const Score& s, std::vector<std::string>& lines) {
  std::size_t width = 5;
  for (const auto& [truth, found] : s.confusion) width = std::max(width, truth.size());
  lines.push_back(fmt::format("{:<{}}  {:>5}  {:>5}  {:>7}  names", "truth", width, "cases", "none", "unknown"));
  for (const auto& [truth, found] : s.confusion) {
    std::size_t cases = 0, none = 0, unknown = 0;
    std::string names;
    for (const auto& [verdict, n] : found) {
      cases += n;
      if (verdict == "none")
        none += n;
      else if (verdict == "unknown")
        unknown += n;
      else
        names += fmt::format("{}{} {}", names.empty() ? "" : ", ", n, verdict.starts_with("named ") ? verdict.substr(6) : verdict);
    }
    lines.push_back(fmt::format("{:<{}}  {:>5}  {:>5}  {:>7}  {}", truth, width, cases, none, unknown, names.empty() ? "-" : names));
  }
}

std::string tally_line(const std::string& what, const Tally& t) {
  return fmt::format("{:<28} {:>4} cases: {} right, {} among others, {} in part, {} wrong, {} unknown, {} missed", what, t.cases(), t[Outcome::right],
                     t[Outcome::among], t[Outcome::part], t[Outcome::wrong], t[Outcome::unknown], t[Outcome::missed]);
}

Json share_json(const Share& s) {
  const Bounds b = s.bounds();
  return {{"count", s.count}, {"of", s.of}, {"share", s.of > 0 ? Json(s.share()) : Json()}, {"lower", b.lower}, {"upper", b.upper}};
}

Json tally_json(const Tally& t) {
  Json json{{"cases", t.cases()}};
  for (std::size_t k = 0; k < outcome_count; ++k) json[text(Outcome(k))] = t.count[k];
  return json;
}

}  // namespace

std::vector<std::string> score_lines(const Score& s) {
  std::vector<std::string> lines{fmt::format("{} cases", s.cases), ""};
  add_confusion(s, lines);
  lines.insert(lines.end(), {"", tally_line("nothing concealed", s.none), tally_line("one mechanism", s.singles), tally_line("two mechanisms", s.pairs),
                             tally_line("a fault of one gauge", s.sensors), tally_line("outside the library", s.outside),
                             tally_line(fmt::format("below {:.0f} noise floors", faint_below), s.faint), "",
                             "the right gauge, where its fault is named: " + share_text(s.right_gauge)});
  if (s.unsettled > 0) lines.push_back(fmt::format("not to be trusted, for a fit on which they hang did not settle: {}", s.unsettled));

  lines.insert(lines.end(), {"", fmt::format("Brier score {:.3f} (0: certain of the truth, 2: certain of something else)", s.brier)});
  for (const auto& [family, of] : s.brier_by_family) lines.push_back(fmt::format("  {:<8} {:.3f} over {} cases", family, of.first, of.second));
  lines.push_back("claimed probability, and how often it came true:");
  for (const auto& b : s.reliability)
    if (b.came_true.of > 0) lines.push_back(fmt::format("  {:.1f} to {:.1f}: claimed {:.3f}, came true {}", b.low, b.high, b.claimed, share_text(b.came_true)));

  lines.insert(lines.end(), {"", "base parameters in their 95 % intervals, where the verdict is right: " + share_text(s.base_covered),
                             "                                        over all cases: " + share_text(s.base_covered_all),
                             "the mechanism's numbers in their 95 % intervals, where it is named rightly: " + share_text(s.numbers_covered),
                             fmt::format("distance from the truth in reported standard deviations, root mean square (1 where they are right): base parameters "
                                         "{:.2f}, mechanism's numbers {:.2f}",
                                         s.base_deviation, s.numbers_deviation),
                             "held-out gauges improved by the name: " + share_text(s.heldout_improved)});
  if (s.heldout_improved.of > 0) lines.push_back(fmt::format("  their nrmse, mean: {:.4f} before, {:.4f} after", s.heldout_before, s.heldout_after));
  lines.push_back("base parameters nearer the truth by the name: " + share_text(s.base_nearer));
  if (s.base_nearer.of > 0) {
    lines.push_back(fmt::format("  all, in the handbook's standard deviations: {:.2f} before, {:.2f} after (root mean square)", s.error_before, s.error_after));
    for (const auto& [name, e] : s.base_errors)
      lines.push_back(fmt::format("  {}: {} before, {} after, over {} cases", name, percent(e.before), percent(e.after), e.cases));
  }
  lines.push_back(fmt::format("runs of the true model a diagnosis: mean {:.0f}, median {:.0f}, at most {:.0f}", s.runs_mean, s.runs_median, s.runs_most));
  if (s.walls > 0)
    lines.push_back(fmt::format("time a diagnosis: mean {:.0f} s, median {:.0f} s, at most {:.0f} s (known for {} of {})", s.wall_mean, s.wall_median,
                                s.wall_most, s.walls, s.cases));

  lines.insert(lines.end(), {"", "gates, on exact one-sided 95 % bounds:"});
  for (const auto& g : s.gates) {
    const std::string demand = g.at_most ? "at most" : "at least";
    if (g.share)
      lines.push_back(fmt::format("  {:<46} {:>9}  bound {:>7}, {} {:.0f} %: {}", g.name, g.of > 0 ? fmt::format("{} of {}", g.count, g.of) : "-",
                                  percent(g.bound), demand, 100 * g.threshold, state_text(g.state)));
    else
      lines.push_back(fmt::format("  {:<46} {:>9.3f}  {} {:.1f}: {}", g.name, g.value, demand, g.threshold, state_text(g.state)));
  }
  return lines;
}

Json score_json(const Score& s, const std::vector<JudgedCase>& cases) {
  Json confusion = Json::object();
  for (const auto& [truth, found] : s.confusion)
    for (const auto& [verdict, n] : found) confusion[truth][verdict] = n;
  Json families = Json::object(), reliability = Json::array(), errors = Json::object(), gates = Json::array(), list = Json::array();
  for (const auto& [family, of] : s.brier_by_family) families[family] = {{"brier", of.first}, {"cases", of.second}};
  for (const auto& b : s.reliability)
    reliability.push_back(
        {{"low", b.low}, {"high", b.high}, {"claimed", b.came_true.of > 0 ? Json(b.claimed) : Json()}, {"came_true", share_json(b.came_true)}});
  for (const auto& [name, e] : s.base_errors) errors[name] = {{"before", e.before}, {"after", e.after}, {"cases", e.cases}};
  for (const auto& g : s.gates) {
    Json gate{
        {"name", g.name}, {"value", g.of > 0 ? Json(g.value) : Json()}, {"bound", g.bound}, {g.at_most ? "at_most" : "at_least", g.threshold}, {"of", g.of}};
    if (g.share) gate["count"] = g.count;
    gate["met"] = g.state == GateState::no_case ? Json() : Json(g.state == GateState::met);
    gates.push_back(std::move(gate));
  }
  for (const auto& c : cases) {
    Json judged = judged_json(c);
    judged["outcome"] = text(outcome_of(c.truth, c.finding));
    list.push_back(std::move(judged));
  }
  return {
      {"cases", s.cases},
      {"below_noise", s.below_noise},
      {"faint_below_noise_floors", faint_below},
      {"unsettled", s.unsettled},
      {"confusion", confusion},
      {"outcomes",
       {{"none", tally_json(s.none)},
        {"single", tally_json(s.singles)},
        {"pair", tally_json(s.pairs)},
        {"sensor", tally_json(s.sensors)},
        {"outside", tally_json(s.outside)},
        {"below_noise", tally_json(s.faint)}}},
      {"right_gauge", share_json(s.right_gauge)},
      {"brier", s.brier},
      {"brier_by_family", families},
      {"reliability", reliability},
      {"coverage",
       {{"base_parameters", share_json(s.base_covered)},
        {"base_parameters_all_cases", share_json(s.base_covered_all)},
        {"mechanism_numbers", share_json(s.numbers_covered)},
        {"base_pull_rms", s.base_deviation},
        {"mechanism_pull_rms", s.numbers_deviation}}},
      {"heldout", {{"improved", share_json(s.heldout_improved)}, {"nrmse_before", s.heldout_before}, {"nrmse_after", s.heldout_after}}},
      {"base_parameters",
       {{"nearer", share_json(s.base_nearer)}, {"rms_before_handbook_sd", s.error_before}, {"rms_after_handbook_sd", s.error_after}, {"relative_rms", errors}}},
      {"effort",
       {{"runs", {{"mean", s.runs_mean}, {"median", s.runs_median}, {"most", s.runs_most}}},
        {"wall_s", {{"mean", s.wall_mean}, {"median", s.wall_median}, {"most", s.wall_most}, {"cases", s.walls}}}}},
      {"gates", gates},
      {"list", list}};
}

}  // namespace calomel::challenge
