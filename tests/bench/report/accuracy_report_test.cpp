#include "bench/report/accuracy_report.h"

#include <gtest/gtest.h>

namespace gigabake::bench {
namespace {

/// Returns a bench with one setting: three views, from different directions at the given scale.
AccuracyBench bench_at(const std::string& scale) {
  AccuracyBench bench;
  bench.backend = "cpu";
  bench.voxel_size_m = 0.5;
  AccuracySetting setting;
  setting.name = "area-coverage";
  setting.surface = "area";
  setting.mip = "coverage";
  setting.parameters.voxel_size_m = 0.5;
  setting.bake_s = 1;
  setting.voxels = setting.bytes = 1;
  for (const char* direction : {"nadir", "oblique", "grazing"}) {
    ViewError view;
    view.view = std::string(direction) + " " + scale;
    view.error.flip = 0.05;
    setting.views.push_back(view);
  }
  bench.settings.push_back(setting);
  return bench;
}

TEST(AccuracyReport, HasGoalsOnlyWhereAVoxelOfLod4FillsAPixel) {
  const AccuracyBench far = bench_at("16"), near = bench_at("0.25");
  EXPECT_EQ(goals_of(far.settings.front()).size(), 7u);
  EXPECT_NE(to_markdown(far).find("meets 7 of 7 goals"), std::string::npos) << to_markdown(far);
  EXPECT_NE(to_markdown(far).find("| lod 4, a voxel a pixel |"), std::string::npos);
  EXPECT_TRUE(goals_of(near.settings.front()).empty());
  EXPECT_EQ(to_markdown(near).find("goals"), std::string::npos) << to_markdown(near);
  EXPECT_EQ(to_markdown(near).find("lod 4, a voxel a pixel"), std::string::npos);
}

}  // namespace
}  // namespace gigabake::bench
