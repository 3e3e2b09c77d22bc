#include "bench/accuracy/leaks/leak_bench.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "tests/worker/glb_scene.h"

namespace gigabake::bench {
namespace {

// 2026-11-23: a translucent surface of alpha .30 appeared with .24 to 1, depending on its slope, the view and the
// level.
TEST(Panes, ShowTheirAlphaFromEverySideAtEveryLevel) {
  const ScratchFolder folder;
  LeakBenchRequest request;
  request.out = folder.path() / "scenes";
  request.backend = Backend::cpu;
  request.edge = 160;
  request.families = {"panes"};
  request.width = 80, request.height = 60;
  const LeakBench bench = bench_leaks(request, [](const std::string&) {});
  ASSERT_EQ(bench.scenes.size(), 5u);
  for (const LeakResult& scene : bench.scenes)
    for (const LeakRow& row : scene.rows) {
      if (row.error.inner < 100) continue;
      const std::string view = scene.name + " from " + std::to_string(row.elevation_deg) + " at " +
                               std::to_string(row.voxels_per_pixel) + " voxels a pixel";
      EXPECT_GE(row.error.bias, -0.02) << view;
      EXPECT_LE(row.error.bias, 0.03) << view;
      EXPECT_LE(row.error.rms, 0.06) << view;
    }
}

TEST(LeakBench, LooksAtTheKindsOfScenesThatItIsAskedFor) {
  const std::vector<std::string> families = leak_families();
  EXPECT_EQ(families.front(), "planes");
  EXPECT_EQ(std::count(families.begin(), families.end(), "panes"), 1);
}

}  // namespace
}  // namespace gigabake::bench
