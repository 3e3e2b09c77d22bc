#include "bench/report/leak_report.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/worker/glb_scene.h"

namespace gigabake::bench {
namespace {

LeakError error_of(std::size_t inner, double below_99, double minimum) {
  LeakError e;
  e.inner = inner;
  e.below_99 = below_99;
  e.minimum = minimum;
  return e;
}

LeakBench made_bench(const LeakError& first, const LeakError& second) {
  LeakBench bench{"cpu", 100, 64, {}};
  bench.scenes.push_back({"flat", "planes", "level", true, 7, {{90, 4, LeakEye::anywhere, first}}, {}});
  bench.scenes.push_back({"steep", "planes", "tilted", true, 7, {{10, 16, LeakEye::anywhere, second}}, {}});
  bench.scenes.push_back({"pane", "panes", "glass", false, 7, {{10, 16, LeakEye::anywhere, error_of(500, 1, 0)}}, {}});
  return bench;
}

TEST(LeakReport, NamesTheWorstLeakInOneSentence) {
  const LeakBench bench = made_bench(error_of(400, 0, 1), error_of(300, 0.277, 0.8));
  EXPECT_EQ(verdict(bench),
            "Leaks are not yet bounded: the worst is `steep` from 10° at 16 voxels a pixel, where 27.7 % of the inner "
            "pixels are below alpha .99 and the min is 0.80 (required: at most 0.1 % and at least 0.95; 1 of 2 "
            "images of opaque surfaces are within the bounds).\n");
  EXPECT_EQ(to_markdown(bench).find(verdict(bench)), 0u);
}

TEST(LeakReport, APaneIsNoLeakOfAnOpaqueSurface) {
  const LeakBench bench = made_bench(error_of(400, 0, 1), error_of(300, 0.0005, 0.96));
  EXPECT_TRUE(bench.is_bounded());
  EXPECT_EQ(verdict(bench).find("Leaks are bounded in all 2 images of opaque surfaces: the worst is `steep`"), 0u);
}

TEST(LeakReport, AFewPixelsAreNotTheWorstLeak) {
  const LeakBench bench = made_bench(error_of(400, 0.01, 0.9), error_of(3, 0.7, 0.1));
  EXPECT_NE(verdict(bench).find("`flat`"), std::string::npos);
  EXPECT_FALSE(bench.is_bounded());
}

TEST(LeakReport, TablesPoolThePicturesOfAView) {
  LeakBench bench = made_bench(error_of(300, 0.1, 0.7), error_of(100, 0.5, 0.8));
  bench.scenes[1].rows[0].elevation_deg = 90;
  bench.scenes[1].rows[0].voxels_per_pixel = 4;
  EXPECT_NE(to_markdown(bench).find("| 90 | 4 | 400 | 20.00 | 0.00 | 0.70 | 0.000 | +0.000 | `steep`: 50.00 % |"),
            std::string::npos)
      << to_markdown(bench);
}

TEST(LeakReport, EyesOnTheLatticeHaveRowsOfTheirOwn) {
  LeakBench bench = made_bench(error_of(300, 0, 1), error_of(100, 0.5, 0.8));
  bench.scenes[1].rows[0] = {90, 4, LeakEye::on_lattice, error_of(100, 0.5, 0.8)};
  EXPECT_NE(to_markdown(bench).find("| 90 | 4 | 300 |"), std::string::npos) << to_markdown(bench);
  EXPECT_NE(to_markdown(bench).find("| 90, on a lattice plane | 4 | 100 |"), std::string::npos);
}

TEST(LeakReport, SaysWhatWasNotMeasured) {
  LeakBench bench = made_bench(error_of(300, 0, 1), error_of(0, 0, 1));
  bench.scenes.push_back({"crown", "crowns", "leaves", false, 0, {}, "no Embree"});
  EXPECT_NE(to_markdown(bench).find("| `crown` | leaves | not measured: no Embree |"), std::string::npos);
  EXPECT_NE(to_markdown(bench).find("| 10 | 16 | 0 | | | | | | |"), std::string::npos) << to_markdown(bench);
  const auto json = nlohmann::json::parse(to_json(bench));
  EXPECT_EQ(json["scenes"][3]["not_measured"], "no Embree");
  EXPECT_EQ(json["scenes"][1]["rows"][0]["inner_pixels"], 0);
  EXPECT_FALSE(json["scenes"][1]["rows"][0].contains("below_99"));
}

TEST(LeakBench, MeasuresAFewPlanesFromTheirFilesToTheirRows) {
  const ScratchFolder folder;
  LeakBenchRequest request;
  request.out = folder.path();
  request.backend = Backend::cpu;
  request.suite = LeakSuite::few_planes;
  request.edge = 100;
  const LeakBench bench = bench_leaks(request, [](const std::string&) {});
  ASSERT_EQ(bench.scenes.size(), 3u);
  for (const LeakResult& scene : bench.scenes) {
    EXPECT_GT(scene.voxels, 100u * 70) << scene.name;
    EXPECT_EQ(scene.rows.size(), 4u) << scene.name << ": 8 and 16 voxels a pixel are too many";
    EXPECT_FALSE(std::filesystem::exists(folder.path() / scene.name)) << "nothing is kept";
    for (const LeakRow& row : scene.rows) {
      EXPECT_LE(row.error.inner, 26u * 26);
      EXPECT_GT(row.error.minimum, 0.1) << scene.name << " is there";
    }
  }
}

}  // namespace
}  // namespace gigabake::bench
