#include "scheduler/plan/source_precision.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace gigabake {
namespace {

/// A scene with forty placements of thirty files. The last placement of file f has the coarsest resolution, 2^-f m.
struct Placements {
  SceneSources sources;
  std::vector<TileScan> scans;
  Placements() {
    for (std::uint32_t t = 0; t < 40; ++t) {
      sources.tiles.emplace_back().name = "file" + std::to_string(t % 30);
      TileScan& s = scans.emplace_back();
      s.tile = t;
      s.spacing_m = std::ldexp(t < 30 && t + 30 < 40 ? 0.5 : 1.0, -int(t % 30));
    }
  }
};

TEST(SourcePrecision, ListsEachSourceOnceCoarsestFirstUpToAQuarterOfAVoxel) {
  const Placements p;
  const SourcePrecision precision = source_precision(p.scans, p.sources, std::ldexp(1.0, -5));
  EXPECT_EQ(precision.wanted_m, std::ldexp(1.0, -7));
  EXPECT_EQ(precision.max_spacing_m, 1);
  ASSERT_EQ(precision.coarse_sources, 7u) << "a spacing of just a quarter is fine enough";
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(precision.coarse[i].name, "file" + std::to_string(i));
    EXPECT_EQ(precision.coarse[i].spacing_m, std::ldexp(1.0, -int(i)));
  }
}

TEST(SourcePrecision, CountsAllAndListsSixteen) {
  const Placements p;
  const SourcePrecision precision = source_precision(p.scans, p.sources, 1e-12);
  EXPECT_EQ(precision.coarse_sources, 30u);
  EXPECT_EQ(precision.coarse.size(), SourcePrecision::max_listed);
}

TEST(SourcePrecision, IsTheSameForAnyOrderOfScans) {
  Placements p;
  const SourcePrecision first = source_precision(p.scans, p.sources, 0.01);
  std::shuffle(p.scans.begin(), p.scans.end(), std::mt19937(3));
  const SourcePrecision second = source_precision(p.scans, p.sources, 0.01);
  ASSERT_EQ(first.coarse.size(), second.coarse.size());
  for (std::size_t i = 0; i < first.coarse.size(); ++i) EXPECT_EQ(first.coarse[i].name, second.coarse[i].name);
}

TEST(SourcePrecision, SaysNothingOfFineSources) {
  const Placements p;
  EXPECT_TRUE(source_precision(p.scans, p.sources, 4).coarse.empty());
}

}  // namespace
}  // namespace gigabake
