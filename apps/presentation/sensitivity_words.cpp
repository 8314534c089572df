#include "apps/presentation/sensitivity_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "forward/campaign/total_runs.hpp"

namespace calomel {

namespace {

/// The shares of a total and how far to trust them.
std::string total_line(const QuantitySensitivity& q, const std::string& source, const std::string& note, const std::vector<Parameter>& parameters) {
  std::string line = fmt::format("sensitivity: {}{}:", q.name, q.condition.empty() ? "" : " of " + q.condition);
  if (!source.empty()) {
    line += fmt::format(" {:.3g} {} with sd {:.2g};", q.mean, q.unit, q.sd);
    for (std::size_t k = 0; k < parameters.size(); ++k)
      line += fmt::format("{} {} {:.3g} alone, {:.3g} with the others", k ? "," : "", parameters[k].name, q.sobol.first_order[k].value,
                          q.sobol.total_order[k].value);
    line += fmt::format("; by {}, left-out R2 {:.3f}", source, q.left_out_r2);
  }
  return line + (note.empty() ? "" : (source.empty() ? " " : "; ") + note);
}

}  // namespace

std::string evaluated_sentence(const KnownRuns* runs) {
  if (!runs) return "all by the model itself";
  const Eigen::Index all = runs->means.cols();
  Eigen::Index failed = 0;
  for (Eigen::Index i = 0; i < all; ++i) failed += !runs->means.col(i).allFinite();
  std::string s = "Sobol' indices and elementary effects are those of the surrogate, the polynomial is fitted to the campaign's runs of the model";
  if (failed > 0) s += fmt::format("; {} of its {} runs failed, and the surrogate still predicts there", failed, all);
  return s;
}

std::string sensitivity_doubt(const Sensitivity& s, bool upstream_trusted) {
  if (s.many_failed)
    return fmt::format(
        "{} of {} evaluations of the model failed, more than a fifth: the shares are of {} of {} rows of the design, those where the model has answers; narrow "
        "the bounds of the parameters to where it has",
        s.failed, s.evaluations, s.rows, s.design_rows);
  return upstream_trusted ? "" : "the campaign or the surrogate is not to be trusted: campaign.json and train.json give the reason";
}

std::string total_source(const QuantitySensitivity& q) {
  return q.polynomial_order ? fmt::format("a polynomial of order {} fitted to {} runs at pulse energy 1", *q.polynomial_order, q.runs) : "";
}

std::string share_note(const QuantitySensitivity& q, std::size_t parameters) {
  switch (q.finding) {
    case ShareFinding::reliable:
      return "";
    case ShareFinding::constant:
      return "it does not vary within these bounds, so that no parameter has a share";
    case ShareFinding::no_run:
      return "no run has it";
    case ShareFinding::same_in_all_runs:
      return fmt::format("it is {:.6g} {} in all {} runs: it does not vary within these bounds, so that no parameter has a share", q.mean, q.unit, q.runs);
    case ShareFinding::few_runs:
      return fmt::format("{} runs with it are too few for a polynomial of {} parameters, which takes {}", q.runs, parameters, q.needed_runs);
    case ShareFinding::poor_polynomial:
      return fmt::format("the polynomial does not follow the runs (left-out R2 {:.2f}), so that its shares say little", q.left_out_r2);
  }
  return "";
}

SensitivityWords sensitivity_words(const Sensitivity& s, std::size_t parameters, const KnownRuns* runs, bool upstream_trusted) {
  SensitivityWords words{.source = evaluated_sentence(runs), .doubt = sensitivity_doubt(s, upstream_trusted), .sources = {}, .notes = {}};
  for (const auto& q : s.quantities) {
    words.sources.push_back(total_source(q));
    words.notes.push_back(share_note(q, parameters));
  }
  return words;
}

std::vector<std::string> sensitivity_lines(const Sensitivity& s, const SensitivityWords& words, const std::vector<Parameter>& parameters) {
  const auto& whole = s.quantities.back();
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const auto& f = whole.sobol.first_order[k];
    const auto& t = whole.sobol.total_order[k];
    lines.push_back(fmt::format("sensitivity: {}: {:.3g} of the variance of all records alone ({:.3g} to {:.3g}), {:.3g} with the others ({:.3g} to {:.3g})",
                                parameters[k].name, f.value, f.low, f.high, t.value, t.low, t.high));
  }
  for (std::size_t i = 0; i < s.quantities.size(); ++i)
    if (std::any_of(std::begin(run_totals), std::end(run_totals), [&](const auto& t) { return s.quantities[i].name == t.name; }))
      lines.push_back(total_line(s.quantities[i], words.sources[i], words.notes[i], parameters));
  if (!words.doubt.empty()) lines.push_back("sensitivity: not to be trusted: " + words.doubt);
  lines.push_back(
      fmt::format("sensitivity: {} evaluations, {} failed; every gauge and time in sensitivity.nc, a table in sensitivity.csv", s.evaluations, s.failed));
  return lines;
}

}  // namespace calomel
