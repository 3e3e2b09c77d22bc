// Closed meshes as shapes of edits: the same positions as other shapes, and as half-spaces.
#include <algorithm>
#include <gtest/gtest.h>
#include <random>

#include "format/edit/lattice_shape.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using Triangle3 = LatticeMesh::Triangle;

std::vector<Vec3i64> corners_of(const Vec3i64& low, const Vec3i64& high) {
  std::vector<Vec3i64> out;
  for (int i = 0; i < 8; ++i)
    out.push_back({(i & 1) != 0 ? high[0] : low[0], (i & 2) != 0 ? high[1] : low[1], (i & 4) != 0 ? high[2] : low[2]});
  return out;
}

/// The triangles of a box over corners_of(), counter-clockwise seen from outside.
const std::vector<Triangle3> box_faces{{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                       {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

class RandomPositions {
 public:
  explicit RandomPositions(std::uint64_t seed) : random_(seed) {}
  Vec3i64 at(std::int64_t limit, std::int64_t step = 1) {
    std::uniform_int_distribution<std::int64_t> any(-limit / step, limit / step);
    return {any(random_) * step, any(random_) * step, any(random_) * step};
  }

 private:
  std::mt19937_64 random_;
};

TEST(LatticeMesh, OfABoxHasThePositionsOfTheBoxAlsoOnItsFaces) {
  const test::RandomSeed seed;
  RandomPositions random(seed);
  for (int round = 0; round < 300; ++round) {
    const Vec3i64 a = random.at(40, 4), b = random.at(40, 4);
    const Vec3i64 low = min_by_axis(a, b), high = max_by_axis(a, b) + Vec3i64::all(4);
    const LatticeShape mesh = LatticeMesh(corners_of(low, high), box_faces), box = LatticeBox{low, high};
    EXPECT_FALSE(open_edges(corners_of(low, high), box_faces));
    for (int i = 0; i < 200; ++i) {
      const Vec3i64 p = random.at(48, 4);
      EXPECT_EQ(contains(mesh, p), contains(box, p)) << p[0] << " " << p[1] << " " << p[2];
    }
  }
}

TEST(LatticeMesh, OfAConvexBodyHasThePositionsBehindAllItsFaces) {
  const test::RandomSeed seed;
  RandomPositions random(seed);
  const std::vector<Triangle3> faces{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                     {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int round = 0; round < 200; ++round) {
    const Vec3i64 m = random.at(3000),
                  r = {5000 + random.at(4000)[0], 5000 + random.at(4000)[1], 5000 + random.at(4000)[2]};
    const std::vector<Vec3i64> corners{m + Vec3i64{r[0], 7, -3}, m - Vec3i64{r[0], 0, 0}, m + Vec3i64{11, r[1], 0},
                                       m - Vec3i64{0, r[1], 0},  m + Vec3i64{0, 0, r[2]}, m - Vec3i64{5, 2, r[2]}};
    const LatticeMesh mesh(corners, faces);
    for (int i = 0; i < 300; ++i) {
      const Vec3i64 p = random.at(12000);
      bool is_behind = true, is_on = false;
      for (const Triangle3& t : faces) {
        const Vec3i64 &a = corners[t[0]], &b = corners[t[1]], &c = corners[t[2]];
        const std::int64_t side = dot(cross(b - a, c - a), p - a);
        is_behind = is_behind && side < 0, is_on = is_on || side == 0;
      }
      EXPECT_TRUE(is_on || mesh.contains(p) == is_behind);
      const Vec3i64 edge = Vec3i64::all(1 + std::abs(random.at(1500)[0]));
      const AreaOverlap overlap = mesh.overlap(p, p + edge);
      EXPECT_TRUE(overlap == AreaOverlap::border || is_on || (overlap == AreaOverlap::inside) == is_behind);
    }
  }
}

TEST(LatticeMesh, JoinsOverlappingBodiesAndKeepsCavities) {
  std::vector<Vec3i64> positions = corners_of({0, 0, 0}, {100, 100, 100});
  std::vector<Triangle3> faces = box_faces;
  const auto add = [&](const Vec3i64& low, const Vec3i64& high, bool is_cavity) {
    const auto first = std::uint32_t(positions.size());
    for (const Vec3i64& p : corners_of(low, high)) positions.push_back(p);
    for (const Triangle3& t : box_faces)
      faces.push_back(is_cavity ? Triangle3{first + t[0], first + t[2], first + t[1]}
                                : Triangle3{first + t[0], first + t[1], first + t[2]});
  };
  add({50, 50, 50}, {150, 150, 150}, false);
  add({10, 10, 10}, {20, 20, 20}, true);
  EXPECT_FALSE(open_edges(positions, faces));
  const LatticeMesh mesh(positions, faces);
  EXPECT_TRUE(mesh.contains({75, 75, 75}) && mesh.contains({5, 5, 5}) && mesh.contains({140, 140, 140}));
  EXPECT_FALSE(mesh.contains({15, 15, 15}) || mesh.contains({140, 20, 20}));
}

TEST(LatticeMesh, CountsTheEdgesOfAHoleAndOfATurnedTriangle) {
  const std::vector<Vec3i64> corners = corners_of({0, 0, 0}, {9, 9, 9});
  std::vector<Triangle3> faces = box_faces;
  faces.pop_back();
  EXPECT_EQ(open_edges(corners, faces).value().find("is not closed: 3 of 18 edges"), 0u);
  faces.push_back({3, 5, 7});
  EXPECT_TRUE(open_edges(corners, faces));
}

}  // namespace
}  // namespace gigabake
