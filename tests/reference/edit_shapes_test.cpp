// Shapes of edits select the positions that exact arithmetic selects, in the whole range of coordinates, and on
// borders. Ties are as docs/editing.md states them.
#include <gmpxx.h>
#include <gtest/gtest.h>
#include <random>

#include "format/edit/lattice_shape.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using Exact3 = std::array<mpz_class, 3>;

mpz_class exact(std::int64_t v) { return mpz_class(long(v)); }

Exact3 difference(const Vec3i64& a, const Vec3i64& b) {
  return {exact(a[0]) - exact(b[0]), exact(a[1]) - exact(b[1]), exact(a[2]) - exact(b[2])};
}

mpz_class dot(const Exact3& a, const Exact3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Exact3 cross(const Exact3& a, const Exact3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

bool is_selected(const LatticeBox& box, const Vec3i64& p) {
  bool is_inside = true;
  for (std::size_t c = 0; c < 3; ++c) is_inside = is_inside && box.low[c] <= p[c] && p[c] < box.high[c];
  return is_inside;
}

bool is_selected(const LatticeSphere& sphere, const Vec3i64& p) {
  const Exact3 d = difference(p, sphere.centre);
  return dot(d, d) <= exact(sphere.radius) * exact(sphere.radius);
}

bool is_selected(const LatticeCylinder& cylinder, const Vec3i64& p) {
  const Exact3 d = difference(p, cylinder.base), axis = difference(cylinder.axis, {0, 0, 0}), across = cross(d, axis);
  const mpz_class along = dot(d, axis), length = dot(axis, axis);
  return along >= 0 && along < length &&
         dot(across, across) <= exact(cylinder.radius) * exact(cylinder.radius) * length;
}

/// Returns how often the ring's edges east of a position turn around it; an edge contains its lower end.
int turns_around(const std::vector<std::array<mpz_class, 2>>& ring, const mpz_class& x, const mpz_class& y) {
  int turns = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const auto &a = ring[i], &b = ring[(i + 1) % ring.size()];
    const auto &low = a[1] <= b[1] ? a : b, &high = a[1] <= b[1] ? b : a;
    if (y < low[1] || y >= high[1]) continue;
    const bool is_east = (high[0] - low[0]) * (y - low[1]) > (x - low[0]) * (high[1] - low[1]);
    if (is_east) turns += a[1] <= b[1] ? 1 : -1;
  }
  return turns;
}

/// A prism over one ring, for the reference.
struct Prism {
  Ring ring;
  std::int64_t low, high;
};

bool is_selected(const Prism& prism, const Vec3i64& p) {
  std::vector<std::array<mpz_class, 2>> ring;
  for (const FixedPoint& v : prism.ring) ring.push_back({exact(v.x), exact(v.y)});
  return prism.low <= p[2] && p[2] < prism.high && turns_around(ring, exact(p[0]), exact(p[1])) != 0;
}

/// A closed mesh, for the reference.
struct Body {
  std::vector<Vec3i64> corners;
  std::vector<LatticeMesh::Triangle> triangles;
};

bool is_selected(const Body& body, const Vec3i64& p) {
  int winding = 0;
  for (const LatticeMesh::Triangle& t : body.triangles) {
    std::vector<std::array<mpz_class, 2>> ring;
    for (const auto i : t) ring.push_back({exact(body.corners[i][0]), exact(body.corners[i][1])});
    const int turns = turns_around(ring, exact(p[0]), exact(p[1]));
    if (turns == 0) continue;
    const Vec3i64 &a = body.corners[t[0]], &b = body.corners[t[1]], &c = body.corners[t[2]];
    const Exact3 normal = cross(difference(b, a), difference(c, a)), d = difference(p, a);
    const mpq_class height = mpq_class(-(normal[0] * d[0] + normal[1] * d[1])) / mpq_class(normal[2]) - mpq_class(d[2]);
    if (height > 0) winding += turns;
  }
  return winding != 0;
}

class RandomShapes {
 public:
  explicit RandomShapes(std::uint64_t seed) : random_(seed) {}

  std::int64_t number(std::int64_t low, std::int64_t high) {
    return std::uniform_int_distribution<std::int64_t>(low, high)(random_);
  }
  /// Returns an edge of a shape: small in half of the cases, so that many positions are ties.
  std::int64_t size() { return number(0, 1) == 0 ? 8 * number(1, 12) : number(1, max_shape_edge / 4); }
  Vec3i64 at(const Vec3i64& low, const Vec3i64& high) {
    return {number(low[0], high[0]), number(low[1], high[1]), number(low[2], high[2])};
  }
  Vec3i64 place() { return at(Vec3i64::all(-(std::int64_t(1) << 40)), Vec3i64::all(std::int64_t(1) << 40)); }

 private:
  std::mt19937_64 random_;
};

template <class Shape, class Reference>
void compare(const Shape& shape, const Reference& reference, const std::vector<Vec3i64>& ties, RandomShapes& random,
             int& selected, int& others) {
  const LatticeShape lattice = shape;
  const LatticeBox box = bounds_of(lattice);
  std::vector<Vec3i64> positions = ties;
  for (int i = 0; i < 60; ++i) positions.push_back(random.at(box.low, box.high));
  for (const Vec3i64& p : positions) {
    bool is_in_bounds = true;
    for (std::size_t c = 0; c < 3; ++c) is_in_bounds = is_in_bounds && box.low[c] <= p[c] && p[c] <= box.high[c];
    if (!is_in_bounds) continue;
    const bool expected = is_selected(reference, p);
    EXPECT_EQ(contains(lattice, p), expected) << p[0] << " " << p[1] << " " << p[2];
    ++(expected ? selected : others);
  }
}

TEST(EditShapes, BoxesSpheresAndCylindersEqualExactArithmetic) {
  const test::RandomSeed seed;
  RandomShapes random(seed);
  int selected = 0, others = 0;
  for (int round = 0; round < 2000; ++round) {
    const Vec3i64 m = random.place();
    const LatticeBox box{m, m + Vec3i64{random.size(), random.size(), random.size()}};
    compare(box, box, {box.low, box.high, {box.low[0], box.high[1], box.low[2]}}, random, selected, others);
    const std::int64_t k = random.size() / 8 + 1;  // 7, 4, 4: a position at distance 9
    const LatticeSphere sphere{m, 9 * k};
    compare(sphere, sphere,
            {m + Vec3i64{7 * k, 4 * k, 4 * k}, m + Vec3i64{7 * k, 4 * k, 4 * k + 1}, m + Vec3i64{9 * k, 0, 0},
             m - Vec3i64{0, 9 * k, 0}, m + Vec3i64{9 * k, 1, 0}},
            random, selected, others);
    const LatticeCylinder upright{m, {0, 0, random.size()}, 5 * k};
    compare(upright, upright,
            {m + Vec3i64{3 * k, 4 * k, 0}, m + Vec3i64{3 * k, 4 * k + 1, 0}, m + upright.axis,
             m + upright.axis - Vec3i64{0, 0, 1}, m - Vec3i64{5 * k, 0, 0}},
            random, selected, others);
    const std::int64_t a = random.size() / 4 + 1;
    const LatticeCylinder tilted{m, {random.number(-a, a), random.number(-a, a), a}, random.size() / 2 + 1};
    compare(tilted, tilted, {m, m + tilted.axis}, random, selected, others);
  }
  EXPECT_GT(selected, 50000);
  EXPECT_GT(others, 50000);
}

TEST(EditShapes, PrismsEqualExactArithmetic) {
  const test::RandomSeed seed;
  RandomShapes random(seed);
  int selected = 0, others = 0;
  for (int round = 0; round < 2000; ++round) {
    const Vec3i64 m = random.place();
    const std::int64_t a = random.size(), b = random.size(), c = random.size();
    const Prism prism{{{m[0], m[1]}, {m[0] + a, m[1] - b}, {m[0] + a + b, m[1] + c}, {m[0] + a / 2, m[1] + c + 1}},
                      m[2],
                      m[2] + random.size()};
    const LatticePrism shape{AreaPolygon({prism.ring}), prism.low, prism.high};
    std::vector<Vec3i64> ties;
    for (std::size_t i = 0; i < prism.ring.size(); ++i) {
      const FixedPoint &v = prism.ring[i], &w = prism.ring[(i + 1) % prism.ring.size()];
      for (const std::int64_t z : {prism.low, prism.high, prism.high - 1}) {
        ties.push_back({v.x, v.y, z});
        ties.push_back({(v.x + w.x) >> 1, (v.y + w.y) >> 1, z});
      }
    }
    compare(shape, prism, ties, random, selected, others);
  }
  EXPECT_GT(selected, 20000);
  EXPECT_GT(others, 20000);
}

TEST(EditShapes, ClosedMeshesEqualExactArithmetic) {
  const test::RandomSeed seed;
  RandomShapes random(seed);
  int selected = 0, others = 0;
  for (int round = 0; round < 1500; ++round) {
    const Vec3i64 m = random.place();
    // Larger meshes of few triangles would need too large an index.
    const std::int64_t r = random.size() % (1 << 17) / 2 + 3;
    Body body{{}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
    for (int i = 0; i < 4; ++i) body.corners.push_back(m + random.at(Vec3i64::all(-r), Vec3i64::all(r)));
    if (open_edges(body.corners, body.triangles)) continue;
    std::vector<Vec3i64> ties = body.corners;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j) ties.push_back((body.corners[std::size_t(i)] + body.corners[std::size_t(j)]) >> 1);
    for (const auto& t : body.triangles) {
      const Vec3i64 &a = body.corners[t[0]], &b = body.corners[t[1]], &c = body.corners[t[2]];
      ties.push_back(a + ((b - a) >> 1) + ((c - a) >> 2));
    }
    compare(LatticeMesh(body.corners, body.triangles), body, ties, random, selected, others);
  }
  EXPECT_GT(selected, 5000);
  EXPECT_GT(others, 5000);
}

}  // namespace
}  // namespace gigabake
