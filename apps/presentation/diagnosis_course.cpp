#include "apps/presentation/diagnosis_course.hpp"

#include <fmt/format.h>

#include <map>
#include <variant>

#include "apps/presentation/data_check_words.hpp"
#include "apps/presentation/fit_words.hpp"

namespace calomel {

namespace {

/// How the limit of runs ended a fit.
std::string run_limit_text(int limit) { return fmt::format("diagnosis.max_runs = {} ended its fit before it was done", limit); }

}  // namespace

std::string fit_status_text(const Alternative& a) {
  switch (a.status.kind) {
    case FitStatus::Kind::unremarkable:
      return {};
    case FitStatus::Kind::first_order:
      return "estimated to first order only";
    case FitStatus::Kind::linearised_run_failed:
      return "a run about the estimate of its numbers failed";
    case FitStatus::Kind::on_unsettled_fit:
      return "it is added to a fit that has not settled";
    case FitStatus::Kind::numbers_moved:
      return fmt::format("its numbers still moved after {} runs", a.runs);
    case FitStatus::Kind::stable:
      return fmt::format("evidence and numbers were stable from {} coarse and {} fine runs on", a.status.coarse, a.status.fine);
    case FitStatus::Kind::emulator:
      return settling_text(a.status.settling);
    case FitStatus::Kind::run_limit:
      return run_limit_text(a.status.run_limit);
    case FitStatus::Kind::failed:
      break;
  }
  return a.status.message;
}

namespace {

const char* no_effect_text = "none of its numbers changes the records by itself";

std::string skipped_text(const SkippedStep& s) {
  switch (s.kind) {
    case SkippedStep::Kind::mechanisms:
      return "the screening of mechanisms and all later steps: channels appear to be mixed up";
    case SkippedStep::Kind::no_effect:
      return s.name + ": " + no_effect_text;
    case SkippedStep::Kind::relinearisation:
      return fmt::format("{}: its effect was not linearised again, which takes {} runs; {} of diagnosis.max_runs = {} are made", s.name, s.runs, s.made,
                         s.limit);
    case SkippedStep::Kind::fit:
      return fmt::format("{}: its fit was not begun, which takes {} runs at first; {} of diagnosis.max_runs = {} are made", s.name, s.runs, s.made, s.limit);
    case SkippedStep::Kind::search_cut_short:
      return fmt::format("{}: diagnosis.max_runs = {} ended a search for its fit; the best fit that was found is reported", s.name, s.limit);
    case SkippedStep::Kind::missing_terms:
      return fmt::format("the terms that describe the missing effect: they take {} runs, and diagnosis.term_runs is {}", s.runs, s.limit);
    case SkippedStep::Kind::fit_ended:
      return s.name + ": " + (s.message.empty() ? run_limit_text(s.limit) : s.message);
    case SkippedStep::Kind::screening_failed:
      break;
  }
  return s.name + ": " + s.message;
}

/// Terms that were not screened, counted by the reason, and a run with the terms that failed.
std::vector<std::string> skipped_terms(const MissingTerms& m) {
  std::map<std::string, std::size_t> reasons;
  for (const auto& term : m.not_screened) ++reasons[term.failure.value_or(no_effect_text)];
  std::vector<std::string> all;
  for (const auto& [reason, count] : reasons)
    all.push_back(fmt::format("the terms that describe the missing effect: {} of {} were not screened: {}", count, m.offered, reason));
  if (m.run_failure) all.push_back("the terms that describe the missing effect: the run with them failed: " + *m.run_failure);
  return all;
}

}  // namespace

std::vector<std::string> not_screened_texts(const std::vector<NotScreened>& groups) {
  std::vector<std::string> all;
  for (const auto& g : groups) all.push_back(g.label + ": " + g.failure.value_or(no_effect_text));
  return all;
}

std::vector<std::string> skipped_texts(const Diagnosis& d) {
  std::vector<std::string> all;
  for (const auto& step : d.skipped) all.push_back(skipped_text(step));
  if (!d.missing) return all;
  const auto terms = skipped_terms(*d.missing);
  all.insert(all.end(), terms.begin(), terms.end());
  return all;
}

namespace {

struct EventText {
  std::string operator()(const BaseFitBegins&) const { return "base fit"; }
  std::string operator()(const LocalEvidenceFound& e) const { return fmt::format("a discrepancy in one place alone: log evidence {:.3g}", e.log_evidence); }
  std::string operator()(const MislabelledChannel& m) const { return mislabelled_sentence(m); }
  std::string operator()(const ClockOffset& c) const { return clock_sentence(c); }
  std::string operator()(const ScreeningBegins& s) const {
    if (s.on_top_of.empty()) return "screening of each mechanism, to first order";
    return fmt::format("screening of {} on top of {}, to first order", s.gauges_alone ? "a fault of each gauge" : "each mechanism", s.on_top_of);
  }
  std::string operator()(const CandidateScreened& c) const {
    if (c.on_top) return fmt::format("{}: log Bayes factor {:.3g} to first order on top of it", c.label, c.log_bayes_factor);
    return fmt::format("{}: log Bayes factor {:.3g} to first order, p {:.2g}", c.label, c.log_bayes_factor, c.p_value);
  }
  std::string operator()(const FitBegins& f) const { return fmt::format("fit of {} ({} runs so far)", f.name, f.runs); }
  std::string operator()(const ExplanationFitted& e) const {
    return fmt::format("{}: log Bayes factor {:.4g}, chi-squared {:.4g} for {:.0f} values ({:.4g} without it), {} runs", e.name, e.log_bayes_factor, e.chi2,
                       e.values, e.base_chi2, e.runs);
  }
  std::string operator()(const TermScreeningBegins&) const { return "screening of the terms that describe the missing effect"; }
};

}  // namespace

std::string event_text(const DiagnosisEvent& event) { return std::visit(EventText{}, event); }

}  // namespace calomel
