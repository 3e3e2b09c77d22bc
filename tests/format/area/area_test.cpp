#include "format/area/area.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <random>

#include "core/base/error.h"
#include "core/math/georeference.h"
#include "format/area/area_in_scene.h"
#include "format/area/geojson.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

const Geodetic place{47, 8, 500};

std::shared_ptr<const Area> bounded(const std::vector<double>& numbers, AreaFrame frame) {
  auto area = std::make_shared<Area>();
  area->bounds = bounds_of_numbers("--bounds", numbers, frame);
  return area;
}

std::shared_ptr<const Area> within(std::vector<Ring> rings) {
  auto area = std::make_shared<Area>();
  area->polygons.emplace_back(std::move(rings));
  return area;
}

Ring ring_of(const std::vector<std::pair<double, double>>& corners) {
  Ring ring;
  for (const auto& [x, y] : corners) ring.push_back({to_fixed(x), to_fixed(y)});
  return ring;
}

TEST(AreaPolygon, SharesEachPositionAmongAdjacentPolygons) {
  // Small integers, so that many positions are on edges and corners.
  const AreaPolygon parts[] = {AreaPolygon({{{0, 0}, {8, 0}, {4, 4}}}), AreaPolygon({{{8, 0}, {8, 8}, {4, 4}}}),
                               AreaPolygon({{{8, 8}, {0, 8}, {4, 4}}}), AreaPolygon({{{0, 8}, {0, 0}, {4, 4}}})};
  for (std::int64_t y = -1; y <= 9; ++y)
    for (std::int64_t x = -1; x <= 9; ++x) {
      int count = 0;
      for (const AreaPolygon& part : parts) count += part.contains({x, y}) ? 1 : 0;
      EXPECT_EQ(count, x >= 0 && x < 8 && y >= 0 && y < 8 ? 1 : 0) << x << "," << y;
    }
}

TEST(AreaPolygon, ClassifiesBoxesLikeAllTheirPositions) {
  const AreaPolygon polygon({{{0, 0}, {20, 3}, {17, 19}, {9, 11}, {2, 18}}, {{6, 5}, {12, 6}, {9, 9}}});
  const test::RandomSeed seed;
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::int64_t> at(-3, 22), size(0, 6);
  int decided = 0;
  for (int i = 0; i < 3000; ++i) {
    const FixedPoint low{at(random), at(random)};
    const FixedBox box{low, {low.x + size(random), low.y + size(random)}};
    const AreaOverlap overlap = polygon.overlap(box);
    if (overlap == AreaOverlap::border) continue;
    ++decided;
    for (std::int64_t y = box.low.y; y <= box.high.y; ++y)
      for (std::int64_t x = box.low.x; x <= box.high.x; ++x)
        ASSERT_EQ(polygon.contains({x, y}), overlap == AreaOverlap::inside);
  }
  EXPECT_GT(decided, 500);
}

TEST(AreaInScene, ClassifiesCellsAndBricksLikeTheCentresOfTheirVoxels) {
  const SnapFrame frame{0.5, {1, 2, 3}};
  const auto areas = {bounded({7.9999, 46.9999, 8.00011, 47.00007, 498, 509}, AreaFrame::degrees),
                      bounded({-7.3, -4.1, 12.5, 9.9}, AreaFrame::scene),
                      within({ring_of({{7.9999, 46.9999}, {8.0001, 47}, {8.00003, 47.0001}})})};
  for (const auto& shape : areas) {
    const AreaInScene area(shape, place);
    int inside = 0, outside = 0, border = 0;
    for (std::int64_t z = -32; z < 32; z += 8)
      for (std::int64_t y = -48; y < 48; y += 8)
        for (std::int64_t x = -48; x < 48; x += 8) {
          const BrickMask mask = area.inside(frame, {x, y, z});
          bool has_inside = false, has_outside = false;
          for (std::int64_t i = 0; i < 512; ++i) {
            const Vec3i64 v{x + i % 8, y + i / 8 % 8, z + i / 64};
            const Point<Scene> centre{1 + (double(v[0]) + 0.5) / 2, 2 + (double(v[1]) + 0.5) / 2,
                                      3 + (double(v[2]) + 0.5) / 2};
            const bool is_inside = area.contains(centre);
            ASSERT_EQ((mask[std::size_t(i) / 64] >> i % 64 & 1) != 0, is_inside);
            (is_inside ? has_inside : has_outside) = true;
          }
          const AreaOverlap overlap = area.overlap(frame, Box3i64::cube({x, y, z}, 8));
          EXPECT_FALSE(overlap == AreaOverlap::inside && has_outside);
          EXPECT_FALSE(overlap == AreaOverlap::outside && has_inside);
          ++(overlap == AreaOverlap::inside ? inside : overlap == AreaOverlap::outside ? outside : border);
        }
    EXPECT_GT(inside, 10);
    EXPECT_GT(outside, 10);
    EXPECT_GT(border, 10);
  }
}

TEST(AreaInScene, KeepsTheHashOfABorderThatItsExtensionLeavesUnchanged) {
  const SnapFrame frame{1, {}};
  const AreaInScene small(bounded({-100, -100, 100, 100}, AreaFrame::scene), {});
  const AreaInScene large(bounded({-100, -100, 500, 100}, AreaFrame::scene), {});
  const auto hashes = [&](const Vec3i64& min) {
    return std::pair(small.border_hash(frame, Box3i64::cube(min, 64)),
                     large.border_hash(frame, Box3i64::cube(min, 64)));
  };
  const auto [north_small, north_large] = hashes({0, 64, 0});
  EXPECT_EQ(north_small, north_large);
  const auto [east_small, east_large] = hashes({64, 0, 0});
  EXPECT_NE(east_small, east_large);
  EXPECT_NE(north_small, east_small);
}

TEST(AreaInScene, RefusesAPlaceOnTheEarthForALocalScene) {
  EXPECT_THROW(AreaInScene(bounded({7, 46, 9, 48}, AreaFrame::degrees), {}), UsageError);
  EXPECT_NO_THROW(AreaInScene(bounded({7, 46, 9, 48}, AreaFrame::scene), {}));
}

TEST(Area, SurvivesItsBytes) {
  Area area =
      *within({ring_of({{179, -17}, {181, -17}, {180, -16}}), ring_of({{179.9, -16.9}, {180.1, -16.9}, {180, -16.5}})});
  area.bounds = bounds_of_numbers("--bounds", {170, -20, 190, -10, -5, 1000}, AreaFrame::degrees);
  ByteWriter writer;
  put(writer, area);
  const std::vector<std::uint8_t> bytes = writer.take();
  ByteReader reader(bytes, "area");
  const Area again = get_area(reader);
  reader.expect_end();
  EXPECT_EQ(again.polygons.at(0).rings(), area.polygons[0].rings());
  EXPECT_EQ(again.bounds->low, area.bounds->low);
  EXPECT_EQ(again.bounds->high, area.bounds->high);
  EXPECT_EQ(again.bounds->height_high_m, 1000);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ByteReader cut({bytes.data(), size}, "area");
    EXPECT_THROW(get_area(cut), InputError);
  }
}

TEST(FaultOf, FindsCrossingsAndHolesOutside) {
  const Ring square{{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  EXPECT_FALSE(fault_of({square}));
  EXPECT_FALSE(fault_of({square, {{2, 2}, {4, 2}, {3, 4}}}));
  EXPECT_FALSE(fault_of({square, {{0, 2}, {4, 2}, {3, 4}}})) << "a hole may touch the outer ring";
  EXPECT_TRUE(fault_of({{{0, 0}, {10, 10}, {10, 0}, {0, 10}}}));
  EXPECT_TRUE(fault_of({{{0, 0}, {4, 0}, {4, 4}, {8, 4}, {8, 8}, {4, 4}, {0, 4}}})) << "it touches itself";
  EXPECT_TRUE(fault_of({{{0, 0}, {10, 0}, {5, 0}, {5, 5}}})) << "it returns on its own edge";
  EXPECT_TRUE(fault_of({square, {{5, 5}, {15, 5}, {5, 8}}}));
  EXPECT_TRUE(fault_of({square, {{20, 20}, {25, 20}, {22, 25}}}));
}

}  // namespace
}  // namespace gigabake
