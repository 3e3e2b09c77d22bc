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
    for (Vector& corner : triangle) corner = {place(rng), place(rng), place(rng)};
    double sum = 0;
    for (int i = 0; i < 125; ++i)
      sum += area_of(clip_to_cube(triangle, {double(i % 5), double(i / 5 % 5), double(i / 25)}, 1));
    EXPECT_NEAR(sum, std::sqrt(dot(normal_of(triangle), normal_of(triangle))) / 2, 1e-9);
  }
}

TEST(ClippedTriangle, KeepsTheWeightsOfItsCorners) {
  const Corners triangle{{{0, 0, 0.5}, {3, 0.25, 0.5}, {0.5, 3, 0.75}}};
  for (const ClippedCorner& c : clip_to_cube(triangle, {0, 0, 0}, 1))
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(c.at[k],
                  (1 - c.second - c.third) * triangle[0][k] + c.second * triangle[1][k] + c.third * triangle[2][k],
                  1e-12);
}

TEST(ClippedTriangle, IsAsFarAsTheNearestOfItsPoints) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> place(-1, 1);
  for (int round = 0; round < 50; ++round) {
    Corners triangle;
    for (Vector& corner : triangle) corner = {place(rng), place(rng), place(rng)};
    const Vector p{2 * place(rng), 2 * place(rng), 2 * place(rng)};
    constexpr int steps = 200;
    double nearest = INFINITY;
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j) {
        Vector q;
        for (std::size_t k = 0; k < 3; ++k)
          q[k] =
              triangle[0][k] + (i * (triangle[1][k] - triangle[0][k]) + j * (triangle[2][k] - triangle[0][k])) / steps;
        nearest = std::min(nearest, std::sqrt(dot(minus(p, q), minus(p, q))));
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
