#include "format/source/mesh/polygon.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "tests/random_seed.h"

namespace gigabake {
namespace {

using PolygonCorners = std::vector<std::array<double, 3>>;

double area(const PolygonCorners& p, const std::vector<std::uint32_t>& index) {
  double sum = 0;
  for (std::size_t t = 0; t < index.size(); t += 3) {
    const auto &a = p[index[t]], &b = p[index[t + 1]], &c = p[index[t + 2]];
    const double x = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]);
    const double y = (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]);
    const double z = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    sum += std::sqrt(x * x + y * y + z * z) / 2;
  }
  return sum;
}

/// The whole border of a star is visible from its centre. The star therefore has the area of the fan around the centre.
TEST(Polygon, TrianglesOfAStarHaveItsAreaWhichOverlapsWouldExceed) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int round = 0; round < 500; ++round) {
    const std::size_t n = 3 + rng() % 30;
    PolygonCorners star;
    for (std::size_t i = 0; i < n; ++i) {
      const double turn = 2 * 3.141592653589793 * double(i) / double(n), r = 0.1 + unit(rng);
      const double x = r * std::cos(turn), y = r * std::sin(turn);
      star.push_back({x, 100 + y, 3 * x - 2 * y});
    }
    PolygonCorners with_centre = star;
    with_centre.push_back({0, 100, 0});
    std::vector<std::uint32_t> fan;
    for (std::uint32_t i = 0; i < n; ++i) fan.insert(fan.end(), {i, std::uint32_t((i + 1) % n), std::uint32_t(n)});
    const std::vector<std::uint32_t> index = triangles_of_polygon(star);
    EXPECT_EQ(index.size(), 3 * (n - 2));
    EXPECT_NEAR(area(star, index), area(with_centre, fan), 1e-9) << n << " corners";
  }
}

/// Returns the polygon in a plane that is parallel to no axis, `offset` metres from the origin.
PolygonCorners tilted(const PolygonCorners& flat, double offset) {
  PolygonCorners out;
  for (const auto& [x, y, z] : flat)
    out.push_back({0.6 * x - 0.64 * y + offset, 0.8 * x + 0.48 * y + 10 * offset, 0.6 * y + z});
  return out;
}

void expect_area(const PolygonCorners& flat, double expected, const char* what) {
  for (const double offset : {0.0, 5e5})
    for (std::size_t first = 0; first < flat.size(); first += 1 + flat.size() / 7) {
      PolygonCorners corners = flat;
      std::rotate(corners.begin(), corners.begin() + std::ptrdiff_t(first), corners.end());
      if (offset != 0) corners = tilted(corners, offset);
      const std::vector<std::uint32_t> index = triangles_of_polygon(corners);
      EXPECT_EQ(index.size(), 3 * (corners.size() - 2)) << what;
      EXPECT_NEAR(area(corners, index), expected, 1e-6 * expected) << what << ", from corner " << first;
    }
}

/// 2026-11-25: polygons with more than 512 corners were triangulated as a fan, whatever their shape.
TEST(Polygon, HasTheAreaOfACombOfAnyLength) {
  for (const int teeth : {2, 127, 128, 5000}) {
    PolygonCorners comb{{0, 0, 0}, {double(teeth), 0, 0}};
    for (int i = teeth; i > 0; --i)
      for (const auto& [x, y] : {std::pair(0.0, 1.0), {-0.5, 1.0}, {-0.5, 4.0}, {-1.0, 4.0}})
        comb.push_back({i + x, y, 0});
    expect_area(comb, 2.5 * teeth, "comb");
  }
}

/// 2026-11-25: a spiral corridor was triangulated as a fan. Only its two ends have ears.
TEST(Polygon, HasTheAreaOfASpiral) {
  constexpr int points = 4000;
  constexpr double step = 20 * 6.283185307179586 / points;
  PolygonCorners spiral;
  for (int i = 0; i < points; ++i)
    spiral.push_back({(i * step + 6) * std::cos(i * step), (i * step + 6) * std::sin(i * step), 0});
  for (int i = points; i-- > 0;)
    spiral.push_back({(i * step + 4) * std::cos(i * step), (i * step + 4) * std::sin(i * step), 0});
  double expected = 0;
  for (std::size_t i = 0; i < spiral.size(); ++i) {
    const auto &a = spiral[i], &b = spiral[(i + 1) % spiral.size()];
    expected += (a[0] * b[1] - a[1] * b[0]) / 2;
  }
  expect_area(spiral, expected, "spiral");
}

/// 2026-11-25: the rest of a polygon after a spike was triangulated as a fan that covered its outside.
TEST(Polygon, KeepsItsAreaWithSpikesRepeatedCornersHolesAndStraightLines) {
  expect_area({{0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {6, 2, 0}, {4, 2, 0}, {4, 4, 0}, {0, 4, 0}}, 16, "spike outwards");
  expect_area({{0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {2, 2, 0}, {4, 2, 0}, {4, 4, 0}, {0, 4, 0}}, 16, "spike inwards");
  expect_area({{0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {-3, 2, 0}, {4, 2, 0}, {4, 4, 0}, {0, 4, 0}}, 16, "spike across");
  expect_area({{0, 0, 0}, {6, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, 16, "overshoot");
  expect_area({{0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {5, 2, 0}, {5, 3, 0}, {5, 2, 0}, {4, 2, 0}, {4, 4, 0}, {0, 4, 0}}, 16,
              "bent spike");
  expect_area({{0, 0, 0}, {0, 0, 0}, {4, 0, 0}, {4, 0, 0}, {2, 1, 0}, {2, 1, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0}}, 12,
              "repeated corners");
  expect_area(
      {{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {0, 8, 0}, {0, 0, 0}, {2, 2, 0}, {2, 6, 0}, {6, 6, 0}, {6, 2, 0}, {2, 2, 0}},
      48, "hole");
  expect_area({{0, 0, 0}, {4, 0, 0}, {2, 2, 0}, {4, 4, 0}, {0, 4, 0}, {2, 2, 0}}, 8, "two triangles that touch");
  PolygonCorners notched;
  for (int i = 0; i < 40; ++i) notched.push_back({0.1 * i, 0, 0});
  for (int i = 0; i < 40; ++i) notched.push_back({4, 0.1 * i, 0});
  notched.insert(notched.end(), {{4, 4, 0}, {2, 1, 0}, {0, 4, 0}});
  expect_area(notched, 10, "straight lines");
}

/// 2026-11-25: a histogram with few distinct heights has many collinear corners.
TEST(Polygon, HasTheAreaOfAHistogram) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (int round = 0; round < 200; ++round) {
    const int columns = 2 + int(rng() % 20);
    PolygonCorners histogram{{0, 0, 0}, {double(columns), 0, 0}};
    double expected = 0;
    for (int i = columns; i > 0; --i) {
      const double height = 1 + double(rng() % 4);
      expected += height;
      histogram.insert(histogram.end(), {{double(i), height, 0}, {double(i - 1), height, 0}});
    }
    expect_area(histogram, expected, "histogram");
  }
}

/// 2026-11-25: a polygon that crosses itself has no correct triangulation. The function still ends soon, with n - 2
/// triangles for n corners.
TEST(Polygon, ThatCrossesItselfEnds) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  PolygonCorners corners;
  for (int i = 0; i < 5000; ++i) corners.push_back({unit(rng), unit(rng), 0});
  EXPECT_EQ(triangles_of_polygon(corners).size(), 3 * (corners.size() - 2));
  corners.assign(6, {std::nan(""), HUGE_VAL, 0});
  EXPECT_EQ(triangles_of_polygon(corners).size(), 12u);
}

}  // namespace
}  // namespace gigabake
