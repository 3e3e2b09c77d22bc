#include "bench/accuracy/clipped_triangle.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "tests/random_seed.h"

namespace gigabake::bench {
namespace {

TEST(ClippedTriangle, InADiagonalPlaneIsTheCubesHexagon) {
  // The plane x + y + z = 1.5 cuts the unit cube in a regular hexagon with edges of √½.
  const Corners triangle{{{9.5, -4, -4}, {-4, 9.5, -4}, {-4, -4, 9.5}}};
  EXPECT_NEAR(area_of(clip_to_cube(triangle, {0, 0, 0}, 1)), 3 * std::sqrt(3.0) / 4, 1e-12);
  EXPECT_TRUE(clip_to_cube(triangle, {1, 1, 1}, 1).empty());
}

TEST(ClippedTriangle, OverAllCubesOfAGridHasItsWholeArea) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> place(0, 5);
  for (int round = 0; round < 100; ++round) {
    Corners triangle;
    for (Vec3d& corner : triangle) corner = {place(rng), place(rng), place(rng)};
    double sum = 0;
    for (int i = 0; i < 125; ++i)
      sum += area_of(clip_to_cube(triangle, {double(i % 5), double(i / 5 % 5), double(i / 25)}, 1));
    EXPECT_NEAR(sum, length(normal_of(triangle)) / 2, 1e-9);
  }
}

TEST(ClippedTriangle, KeepsTheWeightsOfItsCorners) {
  const Corners triangle{{{0, 0, 0.5}, {3, 0.25, 0.5}, {0.5, 3, 0.75}}};
  for (const ClippedCorner& c : clip_to_cube(triangle, {0, 0, 0}, 1)) {
    const Vec3d at = triangle[0] * (1 - c.second - c.third) + triangle[1] * c.second + triangle[2] * c.third;
    EXPECT_LT(length(c.at - at), 1e-12);
  }
}

TEST(ClippedTriangle, IsAsFarAsTheNearestOfItsPoints) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> place(-1, 1);
  for (int round = 0; round < 50; ++round) {
    Corners triangle;
    for (Vec3d& corner : triangle) corner = {place(rng), place(rng), place(rng)};
    const Vec3d p{2 * place(rng), 2 * place(rng), 2 * place(rng)};
    constexpr int steps = 200;
    double nearest = INFINITY;
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j) {
        const Vec3d q = triangle[0] + ((triangle[1] - triangle[0]) * i + (triangle[2] - triangle[0]) * j) / steps;
        nearest = std::min(nearest, length(p - q));
      }
    const double distance = distance_to(triangle, p);
    EXPECT_LE(distance, nearest + 1e-12);
    EXPECT_GT(distance, nearest - 4.0 / steps);
  }
}

TEST(ClippedTriangle, PointsInAPolygonAreSpreadOverItsArea) {
  // The polygon is the unit square. Each quarter of it must contain about a quarter of the points.
  const std::vector<ClippedCorner> square{{{0, 0, 0}}, {{1, 0, 0}}, {{1, 1, 0}}, {{0, 1, 0}}};
  constexpr int edge = 64;
  std::array<int, 4> in_quarter{};
  for (int i = 0; i < edge * edge; ++i) {
    const ClippedCorner p = point_in(square, (i % edge + 0.5) / edge, (i / edge + 0.5) / edge);
    ++in_quarter[std::size_t(p.at[0] >= 0.5) + 2 * std::size_t(p.at[1] >= 0.5)];
  }
  for (const int n : in_quarter) EXPECT_NEAR(n, edge * edge / 4, 40);
}

}  // namespace
}  // namespace gigabake::bench
