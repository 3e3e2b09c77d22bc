#include <gtest/gtest.h>

#include "core/base/error.h"
#include "query/maps/surface_map.h"

namespace gigabake {
namespace {

std::string crs_at(double latitude_deg, double longitude_deg) {
  SceneHeader scene;
  scene.origin = Geodetic{latitude_deg, longitude_deg, 0};
  return default_map_crs(scene);
}

// The zones agree with the areas of use in the EPSG registry.
TEST(MapFrame, ChoosesTheZoneOfUtmAtTheOrigin) {
  EXPECT_EQ(crs_at(46.93, 8.3), "EPSG:32632");
  EXPECT_EQ(crs_at(-33.87, 151.21), "EPSG:32756");
  EXPECT_EQ(crs_at(60.39, 5.32), "EPSG:32632");   // western Norway is in zone 32
  EXPECT_EQ(crs_at(78.22, 15.65), "EPSG:32633");  // Svalbard has zones of 12 degrees
  EXPECT_EQ(crs_at(0, 179.9), "EPSG:32660");
  EXPECT_EQ(crs_at(88, 20), "EPSG:5041");
  EXPECT_EQ(crs_at(-88, 20), "EPSG:5042");
  EXPECT_EQ(default_map_crs(SceneHeader{}), "scene");
}

TEST(MapGrid, HasThePixelsWhoseCentresAreInTheHalfOpenBox) {
  const MapBox box{{0.25, -0.5}, {2.25, 0.5}};
  const MapGrid aligned = grid_of(box, 0.5, false);
  // Centres are odd multiples of 0.25: the first one lies on the western bound, the last one below the eastern bound.
  EXPECT_EQ(aligned.west, 0);
  EXPECT_EQ(aligned.columns, 4u);
  EXPECT_EQ(aligned.x(0), 0.25);
  EXPECT_EQ(aligned.x(3), 1.75);
  EXPECT_EQ(aligned.south, -0.5);
  EXPECT_EQ(aligned.rows, 2u);
  EXPECT_EQ(aligned.y(0), 0.25);
  EXPECT_EQ(aligned.y(1), -0.25);
  const MapGrid exact = grid_of(box, 0.5, true);
  EXPECT_EQ(exact.west, 0.25);
  EXPECT_EQ(exact.columns, 4u);
}

TEST(MapGrid, OfAdjacentExactBoxesJoins) {
  const double west = 446820.3, step = 0.1;
  for (int width = 1; width < 500; width += 7) {
    const double middle = west + width * step, east = west + 1000 * step;
    const MapGrid left = grid_of({{west, 0}, {middle, 1}}, step, true),
                  right = grid_of({{middle, 0}, {east, 1}}, step, true);
    EXPECT_EQ(left.columns, std::uint32_t(width));
    EXPECT_EQ(right.columns, std::uint32_t(1000 - width));
    EXPECT_NEAR(left.x(left.columns - 1) + step, right.x(0), 1e-6);
  }
}

TEST(MapGrid, RefusesStepsAndBoxesWithoutPixels) {
  const MapBox box{{0, 0}, {1, 1}};
  for (const double step : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), 1e-10})
    EXPECT_THROW(grid_of(box, step, true), UsageError) << step;
  EXPECT_THROW(grid_of({{1, 0}, {0, 1}}, 1, true), UsageError);
}

}  // namespace
}  // namespace gigabake
