#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <gtest/gtest.h>
#include <numeric>

#include "sample/terrain/erosion.h"
#include "sample/terrain/noise.h"
#include "sample/terrain/relief.h"

namespace gigabake::sample {
namespace {

TEST(Turn, IsSineAndCosineToTheLastDigitButOne) {
  constexpr double pi = 3.14159265358979323846;
  for (int i = -72000; i <= 72000; ++i) {
    const double degrees = i * 0.01;
    const Turn t = turn_of(degrees);
    // turn_of() reduces degrees to an octant exactly. The reference reduces radians, which is exact only near zero.
    const double tolerance = 3e-16 + std::fabs(degrees) * 4e-18;
    ASSERT_NEAR(t.sine, std::sin(degrees * pi / 180), tolerance) << degrees;
    ASSERT_NEAR(t.cosine, std::cos(degrees * pi / 180), tolerance) << degrees;
  }
  EXPECT_EQ(turn_of(90).cosine, 0);
  EXPECT_EQ(turn_of(-180).sine, 0);
}

TEST(Earth, PutsTheMapWhereGeographicLibDoes) {
  const Geodetic origin{-33.5, 151.2, 20};
  const Earth earth(origin);
  const GeographicLib::LocalCartesian reference(origin.latitude_deg, origin.longitude_deg, origin.height_m);
  for (const MapPoint p : {MapPoint{0, 0}, {1000, -500}, {-40000, 40000}}) {
    const Geodetic g = earth.geodetic(p, 123);
    const Point<Enu> at = earth.enu(p, 123);
    double e = 0, n = 0, u = 0;
    reference.Forward(g.latitude_deg, g.longitude_deg, g.height_m, e, n, u);
    EXPECT_NEAR(at.x, e, 2e-8);
    EXPECT_NEAR(at.y, n, 2e-8);
    EXPECT_NEAR(at.z, u, 2e-8);
  }
}

TEST(Erosion, LetsAllWaterOutAndCarvesValleys) {
  constexpr int edge = 65;
  Raster height(edge, -160, 160);
  Raster uplift_m = height;
  std::vector<std::uint8_t> base(height.v.size(), 0);
  for (int y = 0; y < edge; ++y)
    for (int x = 0; x < edge; ++x) {
      const MapPoint p = height.point(x, y);
      height.at(x, y) = 2 * noise(5, p.e_m / 40, p.n_m / 40);
      uplift_m.at(x, y) = 30;
      base[std::size_t(y) * edge + std::size_t(x)] = x == 0;
    }
  const Raster before = height;
  const Raster area = erode(height, uplift_m, base, {});
  double out_m2 = 0;
  for (int y = 0; y < edge; ++y) {
    out_m2 += area.at(0, y);
    EXPECT_EQ(height.at(0, y), before.at(0, y)) << "the base keeps its height";
  }
  EXPECT_NEAR(out_m2, double(edge) * edge * height.cell_m * height.cell_m, 1e-6 * out_m2);
  EXPECT_GT(std::accumulate(height.v.begin(), height.v.end(), 0.0), 0);
  for (std::size_t i = 0; i < height.v.size(); ++i) EXPECT_LT(height.v[i], before.v[i] + 30 + 1e-9);
}

/// The bits were recorded once; every machine, compiler and libm must give the same.
TEST(Relief, IsTheSameToTheLastBitOnEveryMachine) {
  EXPECT_EQ(hash_of(1, 2, 3), 2845626729u);
  EXPECT_EQ(fractal_noise(7, 1.25, -3.5, 5), -0x1.17271461771fep-2);
  const Relief relief(160, 1);
  EXPECT_EQ(relief.height_m({70, -31}), 0x1.260d140ea52d7p+4);
  EXPECT_EQ(relief.height_m({-66.25, 40.5}), 0x1.592f0a4390aafp+3);
}

}  // namespace
}  // namespace gigabake::sample
