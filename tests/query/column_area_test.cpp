// Columns of voxels in an area, against a test of every column.
#include "query/volume/column_area.h"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/math/georeference.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

constexpr double radius_m = 300;

SceneHeader header(const Geodetic& origin) {
  SceneHeader scene;
  scene.voxel_size_m = 2;
  scene.lattice_origin_m = {0.7, -1.3, 5};
  scene.origin = origin;
  return scene;
}

/// Returns a star around a point of the scene, at longitudes that may exceed 180 degrees.
Ring star(std::mt19937_64& rng, const Geodetic& origin, double x_m, double y_m, double max_m) {
  std::uniform_real_distribution<double> length(max_m / 4, max_m);
  const Affine<Ecef, Scene> to_ecef = ecef_from_enu(origin);
  Ring ring;
  for (int corner = 0; corner < 9; ++corner) {
    const double angle = 2 * std::numbers::pi * corner / 9, r = length(rng);
    Geodetic p = geodetic_of(to_ecef({x_m + r * std::cos(angle), y_m + r * std::sin(angle), 0}));
    p.longitude_deg = origin.longitude_deg + std::remainder(p.longitude_deg - origin.longitude_deg, 360.0);
    ring.push_back({to_fixed(p.longitude_deg), to_fixed(p.latitude_deg)});
  }
  return ring;
}

/// Tests all columns of a scene that is wider than the area.
void compare(const Geodetic& origin, std::mt19937_64& rng, int lod) {
  auto area = std::make_shared<Area>();
  area->polygons.emplace_back(std::vector<Ring>{star(rng, origin, 0, 0, radius_m), star(rng, origin, 0, 0, 40)});
  area->polygons.emplace_back(std::vector<Ring>{star(rng, origin, 500, 100, 150)});
  const SceneHeader scene = header(origin);
  // The window contains a part of the area.
  const ColumnArea columns(area, scene, {{-60, -200, 0}, {100, 90, 10}}, lod);
  std::map<std::pair<double, double>, bool> found;
  const std::uint64_t beyond = columns.for_each_block([&](const ColumnArea::Block& block) {
    for (const AreaColumn& c : columns.columns_in(block))
      EXPECT_TRUE(found.emplace(std::pair(c.x_m, c.y_m), c.is_at_outline).second);
  });
  const AreaInScene exact(area, origin);
  std::uint64_t inside = 0, at_outline = 0, found_at_outline = 0;
  const double edge = columns.column_m();
  EXPECT_EQ(edge, 2 << lod);
  const auto range = std::int64_t(800 / edge);
  const auto contains = [&](std::int64_t x, std::int64_t y) {
    return exact.contains({0.7 + (double(x) + 0.5) * edge, -1.3 + (double(y) + 0.5) * edge, 0});
  };
  for (std::int64_t y = -range; y < range; ++y)
    for (std::int64_t x = -range; x < range; ++x) {
      if (!contains(x, y)) continue;
      ++inside;
      const bool cut = !(contains(x - 1, y) && contains(x + 1, y) && contains(x, y - 1) && contains(x, y + 1));
      at_outline += cut ? 1 : 0;
      const auto at = found.find({0.7 + (double(x) + 0.5) * edge, -1.3 + (double(y) + 0.5) * edge});
      if (at != found.end()) {
        EXPECT_EQ(at->second, cut);
      }
    }
  for (const auto& [place, cut] : found) found_at_outline += cut ? 1 : 0;
  EXPECT_EQ(found.size() + beyond, inside);
  EXPECT_EQ(found_at_outline, at_outline);
  EXPECT_GT(inside, 0u);
}

TEST(ColumnArea, HasTheColumnsWhoseCentresAreInside) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (const Geodetic& origin : {Geodetic{47, 8, 500}, Geodetic{-16.5, 180, 20}, Geodetic{0, -179.999, 0},
                                 Geodetic{78, 15, -30}, Geodetic{-89, 60, 2800}})
    for (const int lod : {0, 2}) compare(origin, rng, lod);
}

TEST(ColumnArea, CountsWholeBlocksOutsideTheScene) {
  auto area = std::make_shared<Area>();
  const Ring square{{to_fixed(7.9), to_fixed(46.9)},
                    {to_fixed(8.1), to_fixed(46.9)},
                    {to_fixed(8.1), to_fixed(47.1)},
                    {to_fixed(7.9), to_fixed(47.1)}};
  area->polygons.emplace_back(std::vector<Ring>{square});
  const ColumnArea columns(area, header({47, 8, 500}), {{-8, -8, 0}, {8, 8, 8}}, 3);
  std::uint64_t blocks = 0, in_blocks = 0;
  const std::uint64_t beyond = columns.for_each_block([&](const ColumnArea::Block& block) {
    ++blocks;
    in_blocks += columns.columns_in(block).size();
  });
  EXPECT_LT(blocks, 120u);  // the outline, and the scene
  // The square's sides are radii of curvature of WGS84 times angles. Each side may cut half a column.
  constexpr double west_east_m = 15212.4, south_north_m = 22235.9, column_m = 16;
  EXPECT_NEAR(double(in_blocks + beyond), west_east_m * south_north_m / (column_m * column_m),
              (west_east_m + south_north_m) / column_m);
}

TEST(ColumnArea, RefusesAnAreaFarBeyondTheScene) {
  const Geodetic origin{47, 8, 500};
  std::mt19937_64 rng(1);
  for (const double far_m : {60e3, 3e6}) {
    auto area = std::make_shared<Area>();
    area->polygons.emplace_back(std::vector<Ring>{star(rng, origin, far_m, 0, 500)});
    EXPECT_THROW(ColumnArea(area, header(origin), {{0, 0, 0}, {64, 64, 64}}, 0), UsageError);
  }
  auto antipode = std::make_shared<Area>();
  antipode->polygons.emplace_back(std::vector<Ring>{star(rng, {-47, -172, 0}, 0, 0, 500)});
  EXPECT_THROW(ColumnArea(antipode, header(origin), {{0, 0, 0}, {64, 64, 64}}, 0), UsageError);
}

}  // namespace
}  // namespace gigabake
