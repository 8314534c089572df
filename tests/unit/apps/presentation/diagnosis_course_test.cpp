// Lines about a running diagnosis, how its fits ended, and what it did not do.
#include "apps/presentation/diagnosis_course.hpp"

#include <gmock/gmock.h>

namespace calomel {
namespace {

using ::testing::ElementsAre;

TEST(DiagnosisCourse, EveryEventHasALine) {
  EXPECT_EQ(event_text(BaseFitBegins{}), "base fit");
  EXPECT_EQ(event_text(LocalEvidenceFound{-3.21}), "a discrepancy in one place alone: log evidence -3.21");
  EXPECT_EQ(event_text(ScreeningBegins{}), "screening of each mechanism, to first order");
  EXPECT_EQ(event_text(ScreeningBegins{.on_top_of = "echo"}), "screening of each mechanism on top of echo, to first order");
  EXPECT_EQ(event_text(ScreeningBegins{.on_top_of = "echo", .gauges_alone = true}), "screening of a fault of each gauge on top of echo, to first order");
  EXPECT_EQ(event_text(CandidateScreened{.label = "interface (top)", .log_bayes_factor = 12.34, .p_value = 0.012}),
            "interface (top): log Bayes factor 12.3 to first order, p 0.012");
  EXPECT_EQ(event_text(CandidateScreened{.label = "interface (top)", .log_bayes_factor = 12.34, .on_top = true}),
            "interface (top): log Bayes factor 12.3 to first order on top of it");
  EXPECT_EQ(event_text(FitBegins{"echo", 123}), "fit of echo (123 runs so far)");
  EXPECT_EQ(event_text(ExplanationFitted{.name = "echo", .log_bayes_factor = 106, .chi2 = 70, .values = 100, .base_chi2 = 400, .runs = 40}),
            "echo: log Bayes factor 106, chi-squared 70 for 100 values (400 without it), 40 runs");
  EXPECT_EQ(event_text(TermScreeningBegins{}), "screening of the terms that describe the missing effect");
  EXPECT_EQ(event_text(MislabelledChannel{.gauge = "T2", .own = -0.98, .like = 0.98}),
            "The record of gauge T2 has the opposite sign of its simulation (correlation -0.98). Check its wiring and its direction in the case.");
  EXPECT_EQ(
      event_text(ClockOffset{.delay = -2e-3, .sd = 1e-4, .log_bayes_factor = 9}),
      "All records look 2.00 ± 0.10 ms early (log Bayes factor 9 to first order). Check the instant from which they count, and set recordings.trigger_offset; "
      "where the instant is not known, set errors.trigger_sd.");
}

TEST(DiagnosisCourse, AFitEndsInOneOfSeveralWays) {
  using Kind = FitStatus::Kind;
  const auto text = [](const FitStatus& status) {
    Alternative a;
    a.runs = 12;
    a.status = status;
    return fit_status_text(a);
  };
  EXPECT_EQ(text({}), "");
  EXPECT_EQ(text({.kind = Kind::first_order}), "estimated to first order only");
  EXPECT_EQ(text({.kind = Kind::linearised_run_failed}), "a run about the estimate of its numbers failed");
  EXPECT_EQ(text({.kind = Kind::on_unsettled_fit}), "it is added to a fit that has not settled");
  EXPECT_EQ(text({.kind = Kind::numbers_moved}), "its numbers still moved after 12 runs");
  EXPECT_EQ(text({.kind = Kind::stable, .coarse = 30, .fine = 20}), "evidence and numbers were stable from 30 coarse and 20 fine runs on");
  EXPECT_EQ(text({.kind = Kind::emulator, .settling = {.settled = true, .coarse = 30, .fine = 20}}), "settled after 30 coarse and 20 fine runs");
  EXPECT_EQ(text({.kind = Kind::run_limit, .run_limit = 761}), "diagnosis.max_runs = 761 ended its fit before it was done");
  EXPECT_EQ(text({.kind = Kind::failed, .message = "no run succeeded"}), "no run succeeded");
}

TEST(DiagnosisCourse, WhatWasNotDoneIsListed) {
  using Kind = SkippedStep::Kind;
  Diagnosis d;
  d.skipped = {{.kind = Kind::mechanisms},
               {.kind = Kind::screening_failed, .name = "interface (top)", .message = "an element collapsed"},
               {.kind = Kind::no_effect, .name = "interface (rear)"},
               {.kind = Kind::relinearisation, .name = "previous_pulses", .runs = 66, .made = 1950, .limit = 2000},
               {.kind = Kind::fit, .name = "interface", .runs = 40, .made = 1990, .limit = 2000},
               {.kind = Kind::search_cut_short, .name = "lag", .limit = 761},
               {.kind = Kind::fit_ended, .name = "tone", .limit = 761},
               {.kind = Kind::fit_ended, .name = "hum", .message = "no run of the model succeeded", .limit = 761},
               {.kind = Kind::missing_terms, .runs = 135, .limit = 100}};
  EXPECT_THAT(skipped_texts(d),
              ElementsAre("the screening of mechanisms and all later steps: channels appear to be mixed up", "interface (top): an element collapsed",
                          "interface (rear): none of its numbers changes the records by itself",
                          "previous_pulses: its effect was not linearised again, which takes 66 runs; 1950 of diagnosis.max_runs = 2000 are made",
                          "interface: its fit was not begun, which takes 40 runs at first; 1990 of diagnosis.max_runs = 2000 are made",
                          "lag: diagnosis.max_runs = 761 ended a search for its fit; the best fit that was found is reported",
                          "tone: diagnosis.max_runs = 761 ended its fit before it was done", "hum: no run of the model succeeded",
                          "the terms that describe the missing effect: they take 135 runs, and diagnosis.term_runs is 100"));
  d.skipped.clear();
  d.missing = MissingTerms{.screened = 1,
                           .offered = 4,
                           .not_screened = {{.label = "mass (top)", .failure = "an element collapsed"},
                                            {.label = "drag (top)", .failure = {}},
                                            {.label = "mass (rear)", .failure = "an element collapsed"}},
                           .run_failure = "the step is too small"};
  EXPECT_THAT(skipped_texts(d),
              ElementsAre("the terms that describe the missing effect: 2 of 4 were not screened: an element collapsed",
                          "the terms that describe the missing effect: 1 of 4 were not screened: none of its numbers changes the records by itself",
                          "the terms that describe the missing effect: the run with them failed: the step is too small"));
  EXPECT_THAT(
      not_screened_texts(d.missing->not_screened),
      ElementsAre("mass (top): an element collapsed", "drag (top): none of its numbers changes the records by itself", "mass (rear): an element collapsed"));
}

}  // namespace
}  // namespace calomel
