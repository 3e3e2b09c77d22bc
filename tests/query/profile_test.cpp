// Stations of profiles: distances on the ellipsoid whose closed forms are known, and the ends of lines.
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "core/base/error.h"
#include "core/math/geodesic.h"
#include "query/query_inputs.h"

namespace gigabake {
namespace {

constexpr double equator_radius_m = 6378137, quarter_meridian_m = 10001965.7293127;  // of WGS84
constexpr double degree_of_equator_m = equator_radius_m * std::numbers::pi / 180;

std::vector<QueryInput> stations(const std::vector<Geodetic>& vertices, double step_m, std::size_t batch = 7) {
  const auto source = profile_queries(GeodesicPath(vertices), step_m, "--profile");
  std::vector<QueryInput> all, next;
  for (source->next(batch, next); !next.empty(); source->next(batch, next))
    all.insert(all.end(), next.begin(), next.end());
  EXPECT_EQ(source->count(), all.size());
  return all;
}

TEST(GeodesicPath, HasTheLengthOfMeridiansAndOfTheEquator) {
  EXPECT_NEAR(GeodesicPath({{0, 8, 0}, {90, 8, 0}}).length_m(), quarter_meridian_m, 1e-6);
  EXPECT_NEAR(GeodesicPath({{0, -3, 0}, {0, 4, 0}}).length_m(), 7 * degree_of_equator_m, 1e-6);
  const GeodesicPath corner({{0, 0, 0}, {0, 1, 0}, {0, 0.25, 0}, {0, 2.25, 0}});
  EXPECT_NEAR(corner.length_m(), 3.75 * degree_of_equator_m, 1e-6);
  const double at_degrees[][2] = {{0, 0}, {0.5, 0.5}, {1, 1}, {1.5, 0.5}, {1.75, 0.25}, {3, 1.5}, {3.75, 2.25}};
  for (const auto& [distance, longitude] : at_degrees) {
    const Geodetic p = corner.position(distance * degree_of_equator_m);
    EXPECT_NEAR(p.longitude_deg, longitude, 1e-12);
    EXPECT_NEAR(p.latitude_deg, 0, 1e-12);
  }
}

TEST(GeodesicPath, CrossesTheAntimeridian) {
  const GeodesicPath path({{0, 179, 0}, {0, -179, 0}});
  EXPECT_NEAR(path.length_m(), 2 * degree_of_equator_m, 1e-6);
  EXPECT_NEAR(path.position(1.5 * degree_of_equator_m).longitude_deg, -179.5, 1e-12);
}

TEST(ProfileQueries, IncludeBothEndsOfTheLine) {
  const double degree = degree_of_equator_m;
  const std::vector<QueryInput> even = stations({{0, 0, 0}, {0, 1, 0}}, degree / 20);
  ASSERT_EQ(even.size(), 21u);  // the last step of 20 is not split by rounding
  for (std::size_t i = 0; i < even.size(); ++i) {
    EXPECT_NEAR(even[i].station_m, double(i) * degree / 20, 1e-6);
    EXPECT_NEAR(even[i].from[0], double(i) / 20, 1e-12);
  }
  const std::vector<QueryInput> rest = stations({{0, 0, 0}, {0, 1, 0}}, degree * 0.3);
  ASSERT_EQ(rest.size(), 5u);
  EXPECT_NEAR(rest[3].from[0], 0.9, 1e-12);
  EXPECT_NEAR(rest[4].from[0], 1, 1e-12);
  EXPECT_EQ(stations({{0, 0, 0}, {0, 1, 0}}, 1e9).size(), 2u);
  for (const double step : {0.0, -1.0, std::nan(""), HUGE_VAL, 1e-9})
    EXPECT_THROW(stations({{0, 0, 0}, {0, 1, 0}}, step), UsageError) << step;
  EXPECT_THROW(stations({{46, 8, 0}, {46, 368, 0}}, 1), UsageError);
  EXPECT_THROW(stations({{90, 8, 0}, {90, 9, 0}}, 1), UsageError);
}

}  // namespace
}  // namespace gigabake
