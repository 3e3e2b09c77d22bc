/// The overlap functions of kernels/ compared with exact clipping, one brick at a time.
#include <cstdlib>
#include <gtest/gtest.h>

#include "kernels/body/voxelize/brick_triangle.h"
#include "print.h"
#include "triangle_families.h"

namespace gigabake::reference {
namespace {

using namespace gigabake::kernels;

template <class I>
std::set<Voxel> touched(const Triangle& t, SurfaceRule rule, const Window& brick) {
  WindowTriangle w{};
  for (int k = 0; k < 3; ++k)
    for (int r = 0; r < 3; ++r) w.p[k][r] = std::int32_t(t[k][r] - brick.min[r] * subvoxels);
  const BrickTriangle<I> b = make_brick_triangle<I>(w, {0, 0, 0});
  std::uint64_t slab[8];
  touched_voxels(b, rule, slab);
  std::set<Voxel> out;
  for (int i = 0; i < brick_voxels; ++i) {
    if (!(slab[i / 64] >> (i % 64) & 1)) continue;
    Voxel v = brick.min;
    v[b.axis] += i / 64;
    v[(b.axis + 1) % 3] += i % 8;
    v[(b.axis + 2) % 3] += i / 8 % 8;
    out.insert(v);
  }
  return out;
}

bool is_within(const Triangle& t, const Window& brick, std::int64_t extent) {
  for (const auto& v : t)
    for (const std::int64_t distance : v - brick.min * subvoxels)
      if (std::abs(distance) > extent / 2) return false;
  return true;
}

struct TouchingTriangles {
  Family family;
  int count;
};

class TouchedVoxels : public testing::TestWithParam<TouchingTriangles> {};

TEST_P(TouchedVoxels, AgreesWithExactClippingForEveryRule) {
  const auto [family, count] = GetParam();
  const std::uint64_t seed = 20'240'000 + std::uint64_t(family);
  Rng rng(seed);
  for (int i = 0; i < count; ++i) {
    const Window brick{{8 * uniform(rng, -999, 999), 8 * uniform(rng, -999, 999), 8 * uniform(rng, -999, 999)}, 8};
    const Triangle t = random_triangle(family, brick, rng);
    const auto pieces = pieces_in(t, brick);
    for (const SurfaceRule rule : {SurfaceRule::area, SurfaceRule::conservative, SurfaceRule::thin}) {
      const std::set<Voxel> expected = occupied(t, pieces, rule);
      ASSERT_EQ(touched<__int128>(t, rule, brick), expected) << "128 bits" << describe(seed, i, t, rule);
      if (is_within(t, brick, narrow_extent)) {
        ASSERT_EQ(touched<std::int64_t>(t, rule, brick), expected) << "64 bits" << describe(seed, i, t, rule);
      }
      if (is_within(t, brick, small_extent)) {
        ASSERT_EQ(touched<std::int32_t>(t, rule, brick), expected) << "32 bits" << describe(seed, i, t, rule);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Random, TouchedVoxels,
    testing::Values(TouchingTriangles{Family::tiny, 30000}, TouchingTriangles{Family::small, 15000},
                    TouchingTriangles{Family::sliver, 15000}, TouchingTriangles{Family::lattice_vertices, 10000},
                    TouchingTriangles{Family::half_voxel_ties, 15000}, TouchingTriangles{Family::axis_parallel, 10000},
                    TouchingTriangles{Family::in_lattice_plane, 10000},
                    TouchingTriangles{Family::edge_through_corner, 10000},
                    TouchingTriangles{Family::diagonal_plane, 10000}, TouchingTriangles{Family::large, 2000},
                    TouchingTriangles{Family::large_lattice, 1000}),
    [](const auto& row) { return std::string(name_of(row.param.family)); });

}  // namespace
}  // namespace gigabake::reference
