// Pieces of triangles along polygons: they cover the triangle once, each on its side.
#include "worker/edit/polygon_pieces.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "tests/random_seed.h"

namespace gigabake {
namespace {

using InPlane = std::array<std::array<double, 2>, 3>;

Ring star_of(std::mt19937_64& random, double radius, double x, double y) {
  std::uniform_real_distribution<double> part(0, 1);
  const int count = 3 + int(random() % 9);
  Ring ring;
  for (int i = 0; i < count; ++i) {
    const double turn = 2 * std::numbers::pi * (i + 0.7 * part(random)) / count, far = radius * (0.3 + part(random));
    ring.push_back({to_fixed(x + far * std::cos(turn)), to_fixed(y + far * std::sin(turn))});
  }
  return ring;
}

double doubled_area(const std::vector<PieceCorner>& corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const PieceCorner &a = corners[i], &b = corners[(i + 1) % corners.size()];
    sum += a.x * b.y - a.y * b.x;
  }
  return sum / fixed_per_unit / fixed_per_unit;
}

double doubled_area(const InPlane& t) {
  return (t[1][0] - t[0][0]) * (t[2][1] - t[0][1]) - (t[1][1] - t[0][1]) * (t[2][0] - t[0][0]);
}

TEST(PolygonPieces, CoverTheTriangleOnceAndLieOnTheirSides) {
  const test::RandomSeed seed;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> coordinate(-10, 10);
  for (int round = 0; round < 2000; ++round) {
    const AreaPolygon polygon({star_of(random, 6, coordinate(random) / 3, coordinate(random) / 3)});
    InPlane t;
    for (auto& corner : t) corner = {coordinate(random), coordinate(random)};
    double area = 0;
    for (const TrianglePiece& piece : pieces_of(t, polygon)) {
      ASSERT_GE(piece.corners.size(), 3u);
      area += doubled_area(piece.corners);
      double x = 0, y = 0;
      for (const PieceCorner& c : piece.corners) {
        EXPECT_NEAR(c.weight[0] + c.weight[1] + c.weight[2], 1, 1e-12);
        for (std::size_t i = 0; i < 3; ++i)
          x += c.weight[i] * t[i][0] / double(piece.corners.size()),
              y += c.weight[i] * t[i][1] / double(piece.corners.size());
      }
      const bool is_wide = std::fabs(doubled_area(piece.corners)) > 1e-4;
      EXPECT_TRUE(!is_wide || polygon.contains({to_fixed(x), to_fixed(y)}) == piece.is_inside) << round;
    }
    EXPECT_NEAR(area, doubled_area(t), 1e-6);
  }
}

TEST(PolygonPieces, GiveAWallAlongABorderToOneSide) {
  const AreaPolygon square({{{to_fixed(0), to_fixed(0)},
                             {to_fixed(4), to_fixed(0)},
                             {to_fixed(4), to_fixed(4)},
                             {to_fixed(0), to_fixed(4)}}});
  const auto sides = [&](const InPlane& t) {
    std::vector<bool> inside;
    for (const TrianglePiece& piece : pieces_of(t, square)) inside.push_back(piece.is_inside);
    return inside;
  };
  EXPECT_EQ(sides({{{0, 1}, {0, 3}, {0, 2}}}), std::vector<bool>{true});   // the western edge is inside
  EXPECT_EQ(sides({{{4, 1}, {4, 3}, {4, 2}}}), std::vector<bool>{false});  // the eastern edge is outside
  EXPECT_EQ(sides({{{1, 0}, {3, 0}, {2, 0}}}), std::vector<bool>{true});   // the southern edge is inside
  EXPECT_EQ(sides({{{1, 4}, {3, 4}, {2, 4}}}), std::vector<bool>{false});  // the northern edge is outside
  EXPECT_EQ(sides({{{-2, 2}, {2, 2}, {0, 2}}}).size(), 2u);
}

}  // namespace
}  // namespace gigabake
