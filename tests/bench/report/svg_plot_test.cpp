#include "bench/report/svg_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gigabake::bench {
namespace {

using testing::HasSubstr;

Plot made_plot() {
  return {"a < b",
          "x",
          "y",
          {{"one", "red", {{1, 5, "cheap"}, {4, 1, "good"}, {4, 6, "bad"}}}, {"two", "blue", {{2, 5, "beaten"}}}}};
}

TEST(Plot, JoinsWhatNothingBeats) {
  std::vector<std::string> names;
  for (const PlotPoint& p : best_of(made_plot())) names.push_back(p.name);
  EXPECT_THAT(names, testing::ElementsAre("cheap", "good"));
}

TEST(Plot, HasEveryPointAndNoMarkupOfNames) {
  const std::string svg = to_svg(made_plot());
  for (const char* part : {"a &lt; b", ">cheap: 1, 5<", ">beaten: 2, 5<", "fill=\"blue\"", "</svg>"})
    EXPECT_THAT(svg, HasSubstr(part));
}

TEST(Plot, OfNothingIsStillAPlot) { EXPECT_THAT(to_svg({"t", "x", "y", {}}), HasSubstr("</svg>")); }

}  // namespace
}  // namespace gigabake::bench
