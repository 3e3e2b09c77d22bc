#include "worker/tiles/clusters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "tests/random_seed.h"
#include "worker/scan/instance_bounds.h"

namespace gigabake {
namespace {

/// Returns n×n squares of two triangles on the plane z = 0, in the order of rows.
Primitive grid(int n) {
  Primitive mesh;
  mesh.material = 3;
  mesh.position_step = 0.5f;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) mesh.position.insert(mesh.position.end(), {float(x), float(y), 0});
  const auto at = [&](int x, int y) { return std::uint32_t(x + y * (n + 1)); };
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      for (const std::uint32_t vertex :
           {at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y), at(x + 1, y + 1), at(x, y + 1)})
        mesh.index.push_back(vertex);
  return mesh;
}

/// The bits of all values of a corner. Compared as bits, NaN equals itself.
using CornerBits = std::array<std::uint32_t, 9>;
using Triangle = std::array<CornerBits, 3>;

std::vector<Triangle> triangles_of(const Primitive& mesh) {
  std::vector<Triangle> all(mesh.index.size() / 3);
  for (std::size_t i = 0; i < mesh.index.size(); ++i) {
    CornerBits& corner = all[i / 3][i % 3];
    const std::size_t v = mesh.index[i];
    for (std::size_t k = 0; k < 3; ++k) corner[k] = std::bit_cast<std::uint32_t>(mesh.position[3 * v + k]);
    for (std::size_t k = 0; k < 2 && !mesh.uv.empty(); ++k)
      corner[3 + k] = std::bit_cast<std::uint32_t>(mesh.uv[2 * v + k]);
    for (std::size_t k = 0; k < 4 && !mesh.rgba.empty(); ++k) corner[5 + k] = mesh.rgba[4 * v + k];
  }
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<Triangle> triangles_of(const std::vector<Primitive>& clusters) {
  std::vector<Triangle> all;
  for (const Primitive& c : clusters) {
    const std::vector<Triangle> some = triangles_of(c);
    all.insert(all.end(), some.begin(), some.end());
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// Returns random triangles between random vertices, some of them not finite.
Primitive random_mesh(std::size_t vertices, std::size_t triangles, bool has_uv, bool has_rgba, std::mt19937_64& rng) {
  std::normal_distribution<float> place(0, 100);
  Primitive mesh;
  for (std::size_t i = 0; i < 3 * vertices; ++i) mesh.position.push_back(place(rng));
  mesh.position[4] = std::numeric_limits<float>::quiet_NaN();
  mesh.position[10] = std::numeric_limits<float>::infinity();
  mesh.position[17] = 1e30f;
  for (std::size_t i = 0; has_uv && i < 2 * vertices; ++i) mesh.uv.push_back(place(rng));
  for (std::size_t i = 0; has_rgba && i < 4 * vertices; ++i) mesh.rgba.push_back(std::uint16_t(rng()));
  for (std::size_t i = 0; i < 3 * triangles; ++i) mesh.index.push_back(std::uint32_t(rng() % vertices));
  return mesh;
}

TEST(ClustersOf, HoldEveryTriangleOnceBitForBit) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (const bool has_uv : {false, true})
    for (const bool has_rgba : {false, true})
      for (const std::size_t triangles :
           {std::size_t(1), cluster_triangles, cluster_triangles + 1, std::size_t(9000)}) {
        const Primitive mesh = random_mesh(40 + triangles / 3, triangles, has_uv, has_rgba, rng);
        const std::vector<Primitive> clusters = clusters_of(mesh);
        EXPECT_LE(clusters.size(), 1 + 16 * triangles / cluster_triangles);
        EXPECT_EQ(triangles_of(clusters), triangles_of(mesh));
        for (const Primitive& c : clusters) {
          EXPECT_LE(c.index.size(), 3 * cluster_triangles);
          EXPECT_LE(c.position.size() / 3, c.index.size()) << "vertices that no corner has";
          EXPECT_EQ(c.uv.empty(), !has_uv);
          EXPECT_EQ(c.rgba.empty(), !has_rgba);
        }
      }
}

TEST(ClustersOf, KeepWhatIsOfTheWholeMesh) {
  for (const Primitive& c : clusters_of(grid(40))) {
    EXPECT_EQ(c.material, 3);
    EXPECT_EQ(c.position_step, 0.5f);
  }
  EXPECT_TRUE(clusters_of(Primitive{}).empty());
}

/// Returns the area of the clusters' bounding rectangles, in squares of the grid. Ignores rectangles with a side of
/// `maximum` or more.
double covered_area(const std::vector<Primitive>& clusters, double maximum) {
  double area = 0;
  for (const Primitive& c : clusters) {
    const LocalBounds b = bounds_of(c);
    const double width = b.high[0] - b.low[0], depth = b.high[1] - b.low[1];
    if (width < maximum && depth < maximum) area += width * depth;
  }
  return area;
}

TEST(ClustersOf, AreCompact) {
  const int n = 256;
  EXPECT_LT(covered_area(clusters_of(grid(n)), 1e9), 1.6 * n * n);
}

TEST(ClustersOf, AreCompactThoughOneVertexIsFarAway) {
  const int n = 256;
  for (const float far :
       {1e6f, 1e30f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    Primitive mesh = grid(n);
    mesh.position[3 * 1000] = far;
    const std::vector<Primitive> clusters = clusters_of(mesh);
    EXPECT_EQ(triangles_of(clusters), triangles_of(mesh));
    EXPECT_LT(covered_area(clusters, 1000), 1.7 * n * n) << far;
  }
}

TEST(Joined, AreTheTrianglesOfAllClusters) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const Primitive mesh = random_mesh(800, 3000, true, true, rng);
  std::vector<std::shared_ptr<const Primitive>> clusters;
  for (Primitive& c : clusters_of(mesh)) clusters.push_back(std::make_shared<const Primitive>(std::move(c)));
  EXPECT_EQ(triangles_of(joined(clusters)), triangles_of(mesh));
  EXPECT_TRUE(joined({}).index.empty());
}

}  // namespace
}  // namespace gigabake
