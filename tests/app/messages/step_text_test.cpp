#include "app/messages/step_text.h"

#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace gigabake::app {
namespace {

/// Returns the lines that are shown for a step with constant progress. The text is read ten times per second.
std::vector<std::string> lines(StepText& text, double from_s, double to_s, double parts_per_s) {
  std::vector<std::string> out;
  const int looks = int((to_s - from_s) * 10 + 0.5);
  for (int i = 1; i <= looks; ++i) {
    const double now_s = from_s + i / 10.0;
    if (const auto line = text.line(std::uint64_t((now_s - from_s) * parts_per_s + 1e-6), now_s)) out.push_back(*line);
  }
  return out;
}

TEST(StepText, SaysNothingInTheFirstTwoSeconds) {
  for (const bool terminal : {false, true}) {
    StepText text(1000, terminal);
    text.begin("checking shards", 100, "", 1000);
    EXPECT_TRUE(lines(text, 1000, 1001.9, 10).empty());
    EXPECT_EQ(lines(text, 1000, 1002.1, 10).at(0), "checking shards: 20 %, 8 s left");
  }
}

TEST(StepText, GivesALogALineEveryTenSecondsWhateverTheSteps) {
  StepText text(0, false);
  text.begin("reading the tileset", 0, "tile", 0);
  EXPECT_EQ(lines(text, 0, 9, 1000), std::vector<std::string>{"reading the tileset: 2000 tiles, 2 s"});
  text.begin("planning", 0, "", 9);
  EXPECT_EQ(lines(text, 9, 31, 0), (std::vector<std::string>{"planning: 3 s", "planning: 13 s"}));
}

TEST(StepText, RewritesATerminalsLineTenTimesASecond) {
  StepText text(0, true);
  text.begin("drawing", 50, "frame", 0);
  const auto shown = lines(text, 0, 5, 5);
  EXPECT_GE(shown.size(), 25u);
  EXPECT_LE(shown.size(), 31u);
  EXPECT_EQ(shown.front(), "drawing: 10 of 50 frames, 8 s left");
}

TEST(StepText, IsSilentBetweenSteps) {
  StepText text(0, true);
  EXPECT_TRUE(lines(text, 0, 5, 1).empty());
  text.begin("drawing", 50, "frame", 5);
  EXPECT_EQ(text.line(1, 5.2), "drawing: 1 of 50 frames");
  text.end();
  EXPECT_FALSE(text.line(2, 9));
}

TEST(StepText, NeverSaysMoreThanAll) {
  StepText text(0, true);
  text.begin("checking shards", 10, "", 0);
  EXPECT_EQ(text.line(12, 4), "checking shards: 100 %, 0 s left");
}

}  // namespace
}  // namespace gigabake::app
