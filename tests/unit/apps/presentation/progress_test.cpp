#include "apps/presentation/progress.hpp"

#include <gmock/gmock.h>

#include <sstream>

using namespace calomel;

TEST(Progress, WritesPlainLinesEveryTenSecondsAndAtTheEnd) {
  std::ostringstream out;
  double now = 100;
  ProgressDisplay p("campaign", "runs", ProgressDisplay::Style::lines, out, [&] { return now; });
  p.update(20, 100);  // reused
  for (std::size_t done = 21; done <= 100; ++done) {
    now += 0.5;
    p.update(done, 100, "1 failed");
  }
  EXPECT_EQ(out.str(),
            "campaign: 20 of 100 runs\n"
            "campaign: 40 of 100 runs, 2/s, 30 s left, 1 failed\n"
            "campaign: 60 of 100 runs, 2/s, 20 s left, 1 failed\n"
            "campaign: 80 of 100 runs, 2/s, 10 s left, 1 failed\n"
            "campaign: 100 of 100 runs, 2/s, took 40 s, 1 failed\n");
}

TEST(Progress, DrawsABarOverItselfAndEndsItsLine) {
  std::ostringstream out;
  double now = 0;
  {
    ProgressDisplay p("campaign", "runs", ProgressDisplay::Style::bar, out, [&] { return now; });
    p.update(0, 4, "a long note that goes");
    // too soon to be drawn again
    now = 0.05;
    p.update(1, 4);
    now = 1;
    p.update(2, 4);
  }
  const auto text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\r'), 2);
  EXPECT_THAT(text, testing::HasSubstr("\rcampaign [############............] 2 of 4 runs, 2/s, 1 s left"));
  EXPECT_THAT(text, testing::EndsWith(" \n"));  // blanks over the long note, then the line ends
}

TEST(Progress, IsSilentWhenQuiet) {
  std::ostringstream out;
  ProgressDisplay p("campaign", "runs", ProgressDisplay::Style::silent, out);
  p.update(1, 1);
  EXPECT_EQ(out.str(), "");
  EXPECT_EQ(progress_style(true), ProgressDisplay::Style::silent);
}

TEST(Progress, DurationsReadWell) {
  EXPECT_EQ(duration_text(0.24), "0.2 s");
  EXPECT_EQ(duration_text(0.01), "0.1 s");
  EXPECT_EQ(duration_text(0.97), "1 s");
  EXPECT_EQ(duration_text(59), "59 s");
  EXPECT_EQ(duration_text(720), "12 min");
  EXPECT_EQ(duration_text(12000), "3 h 20 min");
}
