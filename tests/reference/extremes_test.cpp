/// Tests of the largest counts and sizes that the kernels promise: millions of triangles in one voxel, a million voxels
/// in one triangle.
#include <gtest/gtest.h>

#include "bake_scene.h"
#include "core/base/rules.h"
#include "print.h"

namespace gigabake::reference {
namespace {

using namespace gigabake::kernels;

/// Returns copies of the smallest possible triangle, half a sub-voxel², in voxel 0.
Part min_triangles(std::size_t count, const std::array<float, 3>& corner, std::uint32_t material) {
  Part part;
  part.material = material;
  const auto& c = corner;
  part.position = {c[0], c[1], c[2], c[0] + 1, c[1], c[2], c[0], c[1] + 1, c[2]};
  part.index.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) part.index.insert(part.index.end(), {0, 1, 2});
  return part;
}

/// The 17 million triangles are sorted by colour. A sum in float, or a sum that saturates, would ignore the last
/// triangles. The large triangle counts by its area.
TEST(ManyTriangles, SeventeenMillionInOneVoxelAverageExactly) {
  constexpr std::size_t million = 1000000;
  BakeScene scene;
  scene.set_window({0, 0, 0}, 8);
  scene.add_part(min_triangles(6 * million, {10, 10, 10}, scene.add_colour({0, 0, 65535, 65535})));
  scene.add_part(min_triangles(5 * million, {200, 10, 10}, scene.add_colour({0, 65535, 0, 65535})));
  scene.add_part(min_triangles(6 * million, {200, 200, 10}, scene.add_colour({65535, 0, 0, 65535})));
  scene.add_mesh({{{{0, 0, 100}, {256, 0, 100}, {0, 256, 100}}}}, scene.add_colour({0, 65535, 0, 65535}));
  const CellVolume volume = scene.bake(2);
  const VoxelMap voxels = voxels_at(volume, scene.parameters, 0);
  ASSERT_EQ(voxels.size(), 1u);
  EXPECT_EQ(volume.stats.fragments, 17 * million + 1);
  // Areas in half sub-voxels²: 6, 5 and 6 million, and 65536 of the large triangle.
  const double whole = 17e6 + 65536;
  const auto& rgba = voxels.begin()->second.rgba;
  EXPECT_LE(code_error(rgba[0], 6e6 / whole), 0.501);
  EXPECT_LE(code_error(rgba[1], (5e6 + 65536) / whole), 0.501);
  EXPECT_LE(code_error(rgba[2], 6e6 / whole), 0.501);
  EXPECT_EQ(rgba[3], 255);
}

constexpr std::int64_t far = 500'000 * 256;

/// The triangle is a million voxels wide; every voxel in a window of 1024³ is compared with its exact plane.
TEST(OneTriangle, AMillionVoxelsWideOccupiesExactlyItsPlaneInAWindowOf1024) {
  BakeScene scene;
  scene.set_window({-512, -512, -512}, 1024);
  const Triangle t{{{-far, -far, -far / 3 + 7}, {far, -far + 11, far / 5}, {13, far, far / 15}}};
  scene.add_triangle(t);
  const CellVolume volume = scene.bake(2);
  ASSERT_FALSE(volume.levels.empty());
  const auto n = normal_of(t);
  ASSERT_GT(n[2], 0);
  mpz_class offset;
  for (int r = 0; r < 3; ++r) offset += n[r] * mpz_class(long(t[0][r]));
  std::size_t expected = 0;
  const mpz_class rise_x = abs(n[0]), rise_y = abs(n[1]);
  for (long j = -512; j < 512; ++j)
    for (long i = -512; i < 512; ++i) {
      // Over the open column of voxel (i, j), the plane's height times 2 n[2] lies strictly between low2 and high2. The
      // triangle covers the window.
      const mpz_class centre2 = 2 * offset - n[0] * (512 * i + 256) - n[1] * (512 * j + 256);
      const mpz_class low2 = centre2 - 256 * (rise_x + rise_y), high2 = centre2 + 256 * (rise_x + rise_y);
      mpz_class first, last;
      mpz_fdiv_q(first.get_mpz_t(), low2.get_mpz_t(), mpz_class(512 * n[2]).get_mpz_t());
      mpz_cdiv_q(last.get_mpz_t(), high2.get_mpz_t(), mpz_class(512 * n[2]).get_mpz_t());
      expected += std::size_t(mpz_class(last - first).get_ui());
    }
  EXPECT_EQ(volume.levels[0].rgba.size() / 4, expected);
  EXPECT_GE(expected, std::size_t(1024) * 1024);
  for (std::size_t i = 0; i < volume.levels[0].rgba.size(); ++i) ASSERT_EQ(volume.levels[0].rgba[i], 255);
}

/// A sliver across the largest window costs time proportional to its length. Its bounding box has 2^33 bricks.
TEST(OneTriangle, ASliverAcrossAMaxWindowCostsItsLength) {
  BakeScene scene;
  scene.set_window({-4096, -4096, -4096}, 8192);
  scene.add_triangle({{{-far, -far, -far}, {far, far, far}, {far, far - 300, far}}});
  const CellVolume volume = scene.bake(2);
  EXPECT_GE(volume.stats.fragments, 8192u);
  EXPECT_LE(volume.stats.pairs, 8u * 1024);  // a brick on the diagonal touches seven others
}

/// A triangle whose edges are neighbouring Fibonacci numbers: two edges of 2^28 sub-voxels span half a sub-voxel². In
/// double, the products of the edges lose more than this area. A single colour must stay unchanged.
class FibonacciSliver : public testing::Test {
 protected:
  static constexpr Triangle sliver{{{0, 0, 100}, {267914296, 165580141, 100}, {165580141, 102334155, 100}}};
  static constexpr std::array<std::uint8_t, 4> ochre{188, 99, 137, 255};

  FibonacciSliver() { scene_.set_window({0, 0, 0}, 128); }
  void expect_ochre() {
    const VoxelMap voxels = voxels_at(scene_.bake(), scene_.parameters, 0);
    EXPECT_EQ(positions_of(voxels), occupied(sliver, SurfaceRule::area, scene_.window()));
    EXPECT_GE(voxels.size(), 128u);
    for (const auto& [p, v] : voxels) ASSERT_EQ(v.rgba, ochre) << p[0] << ' ' << p[1];
  }

  BakeScene scene_;
};

TEST_F(FibonacciSliver, KeepsTheColourThatItsVerticesShare) {
  Part& part = scene_.add_triangle(sliver);
  for (int v = 0; v < 3; ++v)
    for (int c = 0; c < 4; ++c) part.rgba.push_back(std::uint16_t(std::lround(65535 * linear_of(ochre[c] / 255.0))));
  expect_ochre();
}

TEST_F(FibonacciSliver, KeepsTheColourOfAPlainTexture) {
  std::vector<std::uint8_t> texels;
  for (int i = 0; i < 64 * 64; ++i) texels.insert(texels.end(), ochre.begin(), ochre.end());
  Part& part = scene_.add_triangle(sliver, scene_.add_textured({}, texels, 64, 64));
  part.uv = {0, 0, 1, 0, 0.25f, 1};
  expect_ochre();
}

}  // namespace
}  // namespace gigabake::reference
