/// Fragment weights compared with exactly clipped areas, and their sum compared with the area of the mesh. Bounds:
/// docs/accuracy.md.
#include <cmath>
#include <gtest/gtest.h>
#include <map>

#include "closed_meshes.h"
#include "kernels/cpu/voxelize/cell_lanes.h"
#include "print.h"

namespace gigabake::reference {
namespace {

using namespace gigabake::kernels;

constexpr double weight_unit = 68719476736.0;  // 2^36

/// Bounds on the error of an area before it is rounded to a weight, in voxel²: for triangles a few and a million voxels
/// wide.
constexpr double small_bound = 1e-14, large_bound = 1e-9;

struct Weighed {
  std::int64_t weight;
  double centroid[2];  ///< centroid of the fragment along `axis` + 1 and + 2, in voxels from the cell's lowest corner
  int axis;            ///< projection axis of the triangle
};

std::map<Voxel, Weighed> weigh(const Triangle& t, const Window& brick) {
  WindowTriangle w{};
  for (int k = 0; k < 3; ++k)
    for (int r = 0; r < 3; ++r) w.p[k][r] = std::int32_t(t[k][r] - brick.min[r] * subvoxels);
  const auto b = make_brick_triangle<__int128>(w, {0, 0, 0});
  std::uint64_t slab[8];
  touched_voxels(b, SurfaceRule::conservative, slab);
  const TrianglePlane plane = make_plane(b);
  std::map<Voxel, Weighed> out;
  for (int i = 0; i < brick_voxels; ++i) {
    if (!(slab[i / 64] >> (i % 64) & 1)) continue;
    CellLanes lanes;
    lanes.count = 1;
    lanes.u[0] = double(i % 8 - plane.anchor[0]);
    lanes.v[0] = double(i / 8 % 8 - plane.anchor[1]);
    measure_moments(plane, cut_slab(plane, double(i / 64 - plane.anchor[2])), lanes);
    Voxel v = brick.min;
    v[b.axis] += i / 64;
    v[(b.axis + 1) % 3] += i % 8;
    v[(b.axis + 2) % 3] += i / 8 % 8;
    out[v] = {weight_of(lanes.area[0], plane.weight_scale),
              {lanes.moment_u[0] / lanes.area[0], lanes.moment_v[0] / lanes.area[0]},
              b.axis};
  }
  return out;
}

struct RandomTriangles {
  Family family;
  int count;
};

class FragmentWeights : public testing::TestWithParam<RandomTriangles> {};

TEST_P(FragmentWeights, AreTheExactlyClippedAreasWithinTheStatedBound) {
  const auto [family, count] = GetParam();
  const double bound = family >= Family::large ? large_bound : small_bound;
  const std::uint64_t seed = 51 + std::uint64_t(family);
  Rng rng(seed);
  double worst = 0;
  for (int i = 0; i < count; ++i) {
    const Window brick{{8 * uniform(rng, -99, 99), 8 * uniform(rng, -99, 99), 8 * uniform(rng, -99, 99)}, 8};
    const Triangle t = random_triangle(family, brick, rng);
    const auto weighed = weigh(t, brick);
    for (const Piece& piece : pieces_in(t, brick)) {
      const double exact = area_voxel2(piece, t) * weight_unit;
      const auto found = weighed.find(piece.voxel);
      ASSERT_NE(found, weighed.end());
      const double error = std::abs(double(found->second.weight) - std::max(1.0, exact));
      worst = std::max(worst, (error - 0.5) / weight_unit);
      ASSERT_LE(error, 0.5 + bound * weight_unit)
          << "exact " << exact << describe(seed, i, t, SurfaceRule::conservative);
      ASSERT_GE(found->second.weight, 1);
    }
  }
  RecordProperty("worst_error_voxel2", std::to_string(worst * 1e15) + "e-15");
}

INSTANTIATE_TEST_SUITE_P(
    Random, FragmentWeights,
    testing::Values(RandomTriangles{Family::tiny, 20000}, RandomTriangles{Family::small, 8000},
                    RandomTriangles{Family::sliver, 8000}, RandomTriangles{Family::lattice_vertices, 4000},
                    RandomTriangles{Family::half_voxel_ties, 4000}, RandomTriangles{Family::axis_parallel, 4000},
                    RandomTriangles{Family::in_lattice_plane, 4000}, RandomTriangles{Family::edge_through_corner, 4000},
                    RandomTriangles{Family::diagonal_plane, 4000}, RandomTriangles{Family::large, 600},
                    RandomTriangles{Family::large_lattice, 1000}),
    [](const auto& row) { return std::string(name_of(row.param.family)); });

/// Returns the sum of the weights of all half-open voxels that contain a part of the triangle, brick by brick.
double total_weight(const Triangle& t) {
  const Voxel low = min_by_axis(min_by_axis(t[0], t[1]), t[2]) >> 11,
              high = max_by_axis(max_by_axis(t[0], t[1]), t[2]) >> 11;
  double sum = 0;
  for (std::int64_t z = low[2]; z <= high[2]; ++z)
    for (std::int64_t y = low[1]; y <= high[1]; ++y)
      for (std::int64_t x = low[0]; x <= high[0]; ++x) {
        const Window brick{{8 * x, 8 * y, 8 * z}, 8};
        const auto weighed = weigh(t, brick);
        for (const Voxel& v : occupied(t, SurfaceRule::area, brick)) sum += double(weighed.at(v).weight);
      }
  return sum;
}

TEST(FragmentWeightsOfAMesh, AddUpToItsArea) {
  Rng rng(61);
  for (const ClosedMesh& mesh :
       {sphere({1000, 1100, 1200}, 900, 10), torus({0, 0, 0}, 1400, 500, 10), box({-512, 0, 256}, {512, 1024, 768}),
        box({-500, 3, 251}, {511, 1020, 771}), random_hull({0, 0, 0}, 2000, 1, 9, rng)}) {
    double area = 0, weight = 0;
    for (const Triangle& t : mesh.triangles) {
      if (!has_area(t)) continue;  // at the poles of a sphere
      area += area_voxel2(t);
      weight += total_weight(t);
    }
    EXPECT_NEAR(weight / weight_unit, area, 1e-8 * area) << mesh.name;
  }
}

class FragmentCentroids : public testing::TestWithParam<Family> {};

/// The test covers fragments of at least 1e-5 voxel², two thirds of a sub-voxel². Centroids of smaller fragments cause
/// no visible change of colour.
TEST_P(FragmentCentroids, AreTheExactOnesWithinAThousandthOfAVoxel) {
  const std::uint64_t seed = 71;
  Rng rng(seed);
  for (int i = 0; i < 300; ++i) {
    const Window brick{{0, 0, 0}, 8};
    const Triangle t = random_triangle(GetParam(), brick, rng);
    const auto weighed = weigh(t, brick);
    for (const Piece& piece : pieces_in(t, brick)) {
      if (!has_area_in_voxel(piece) || area_voxel2(piece, t) < 1e-5) continue;
      const auto b = centroid_barycentric(piece, t);
      const auto at = [&](int axis) {
        mpq_class p;
        for (int k = 0; k < 3; ++k) p += b[k] * mpq_class(long(t[k][axis]));
        return p.get_d() / 256 - double(piece.voxel[axis]);
      };
      const Weighed& w = weighed.at(piece.voxel);
      for (int k = 0; k < 2; ++k)
        ASSERT_NEAR(w.centroid[k], at((w.axis + 1 + k) % 3), 1e-3) << describe(seed, i, t, SurfaceRule::area);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Random, FragmentCentroids, testing::ValuesIn(all_families),
                         [](const auto& row) { return std::string(name_of(row.param)); });

}  // namespace
}  // namespace gigabake::reference
