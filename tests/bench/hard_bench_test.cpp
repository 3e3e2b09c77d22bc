/// Tests that the suite of hard cases passes, and that it fails if a bound does not hold.
#include "bench/hard/hard_bench.h"

#include <gtest/gtest.h>

#include "bench/hard/hard_case.h"
#include "bench/report/hard_report.h"
#include "tests/worker/glb_scene.h"

namespace gigabake::bench {
namespace {

const HardFigure& figure(const HardResult& result, const std::string& name) {
  for (const HardFigure& f : result.figures)
    if (f.name == name) return f;
  throw std::runtime_error("no figure " + name + " in " + result.name + ": " + result.error);
}

TEST(HardSuite, EveryBoundHoldsOnTheCpu) {
  const ScratchFolder folder;
  std::size_t cases = 0;
  const HardBench bench = bench_hard({folder.path(), Backend::cpu, 2, 1}, [&](const HardResult& r) {
    ++cases;
    EXPECT_EQ(r.error, "") << r.name;
    for (const HardFigure& f : r.figures)
      EXPECT_TRUE(f.holds()) << r.name << ": " << f.name << " " << f.measured << " of " << f.bound << " " << f.unit;
  });
  EXPECT_TRUE(bench.holds());
  EXPECT_EQ(bench.cases.size(), cases);
  EXPECT_GE(cases, 280u);
}

class HardSuiteNotices : public testing::Test {
 protected:
  HardSuiteNotices() : hard(lattice_case("broken", "", "")) {
    add_triangle(hard.scenes[0].tiles[0], {{{10, 10, 10}, {1110, 20, 30}, {30, 1100, 90}}}, lattice_unit_m);
    hard.expected = [this] { return reference::expected_voxels({wanted}, SurfaceRule::area, hard.window); };
  }
  HardResult result() const { return run_hard_case(hard, folder.path() / "case", {{}, 1}); }

  ScratchFolder folder;
  HardCase hard;
  reference::Painted wanted{
      {{{10, 10, 10}, {1110, 20, 30}, {30, 1100, 90}}}, reference::white16, AlphaMode::opaque, {}};
};

TEST_F(HardSuiteNotices, NothingWhereNothingIsWrong) { EXPECT_TRUE(result().holds()); }

TEST_F(HardSuiteNotices, VoxelsThatAreMissingOrTooMany) {
  wanted.triangle[1] = {1110, 20, 330};
  const HardResult r = result();
  EXPECT_FALSE(r.holds());
  EXPECT_GT(figure(r, "missed").measured, 0);
  EXPECT_GT(figure(r, "extra").measured, 0);
}

TEST_F(HardSuiteNotices, AColourThatIsOffByOneCode) {
  wanted.colour = {64900, 65535, 65535, 65535};
  EXPECT_FALSE(figure(result(), "colour").holds());
}

TEST_F(HardSuiteNotices, ANormalThatPointsTheOtherWay) {
  std::swap(wanted.triangle[1], wanted.triangle[2]);
  EXPECT_GT(figure(result(), "normal").measured, 179);
}

TEST_F(HardSuiteNotices, AnAlphaOfHalf) {
  wanted.mode = AlphaMode::blend;
  wanted.colour[3] = 32768;
  EXPECT_FALSE(figure(result(), "alpha").holds());
}

TEST_F(HardSuiteNotices, ALeafThatIsMissingOrOnAnotherLevel) {
  hard.scenes[0].tiles[0].lod = 1;
  reference::Painted at_half = wanted;
  for (reference::LatticeVertex& v : at_half.triangle) v = {v[0] / 2, v[1] / 2, v[2] / 2};
  const ExpectedVoxels leaves = reference::expected_voxels({at_half}, SurfaceRule::area, {{-4, -4, -4}, 8});
  hard.expected_levels = [&] { return std::vector<ExpectedVoxels>{{}, leaves}; };
  EXPECT_TRUE(result().holds());
  hard.expected_levels = [&] { return std::vector<ExpectedVoxels>{leaves, {}}; };
  const HardResult r = result();
  EXPECT_EQ(figure(r, "missed").measured, double(leaves.size()));
  EXPECT_EQ(figure(r, "extra").measured, double(leaves.size()));
}

TEST_F(HardSuiteNotices, AnotherClass) {
  for (HardCase& one : class_cases())
    if (one.name == "class-tie-reversed") hard = one;
  EXPECT_TRUE(result().holds());
  hard.scenes[0].tiles[1].voxel_class = 6;
  EXPECT_EQ(figure(result(), "another class").measured, 1);
}

TEST_F(HardSuiteNotices, AWayToWriteTheSceneThatShows) {
  hard.scenes.push_back(hard.scenes[0]);
  hard.scenes[1].tiles[0].meshes[0].position[0] += 500;
  EXPECT_EQ(figure(result(), "differ in a bit").measured, 1);
}

TEST_F(HardSuiteNotices, ACellThatFails) {
  hard.parameters.voxel_size_m = 1e-12;
  const HardResult r = result();
  EXPECT_FALSE(r.holds());
}

TEST(HardSuiteReport, NamesWhatFails) {
  HardBench bench{"cpu", {{"good", "group", "", 1, {{"missed", "voxels", 0, 0}}, {}}}};
  EXPECT_NE(to_markdown(bench).find("every bound holds"), std::string::npos);
  // 2026-11-22: the report begins with its result and ends with an explanation of its columns.
  EXPECT_EQ(
      to_markdown(bench).find("In all 1 hard cases every claimed bound holds. Nearest to its bound comes missed of "
                              "`good`: 0 of 0 voxels.\n"),
      0u)
      << to_markdown(bench);
  EXPECT_NE(to_markdown(bench).find("- missed: voxels of"), std::string::npos);
  bench.cases.push_back({"bad", "ties, area", "", 1, {{"missed", "voxels", 2, 0}}, {}});
  EXPECT_NE(to_markdown(bench).find("| `bad` | 1 | 2 ≤ 0 **fails** |"), std::string::npos) << to_markdown(bench);
  EXPECT_EQ(to_markdown(bench).find("In 1 of 2 hard cases a claimed bound does not hold. Farthest beyond its bound is "
                                    "missed of `bad`: 2 of 0 voxels.\n"),
            0u)
      << to_markdown(bench);
  EXPECT_NE(to_json(bench).find("\"holds\": false"), std::string::npos);
}

TEST(HardSuiteReport, ListsCasesWithGoalsInATableOfTheirOwn) {
  const HardFigure met{"area at 1", "", 1.04, 1.05, HardRange{0.97, 1.05}, 0.97};
  const HardFigure missed{"area at 4", "", 1.2, 1.3, HardRange{0.97, 1.05}, 0.97};
  const HardFigure lost{"area at 16", "", 0.5, 1.3, HardRange{0.97, 1.05}, 0.97};
  HardBench bench{"cpu", {{"town", "surfaces", "", 1, {met, missed}, {}}}};
  EXPECT_TRUE(bench.holds());
  EXPECT_NE(to_markdown(bench).find("1 of 2 values meet their goal"), std::string::npos) << to_markdown(bench);
  EXPECT_NE(to_markdown(bench).find("| `town` | area at 1; area at 4 | **1.04**; 1.2 | 0.97 to 1.05; 0.97 to 1.3 | "
                                    "0.97 to 1.05 |\n"),
            std::string::npos)
      << to_markdown(bench);
  bench.cases[0].figures.push_back(lost);
  EXPECT_FALSE(bench.holds()) << "below the lower bound";
  EXPECT_NE(to_markdown(bench).find("0.5 **fails**"), std::string::npos) << to_markdown(bench);
}

}  // namespace
}  // namespace gigabake::bench
