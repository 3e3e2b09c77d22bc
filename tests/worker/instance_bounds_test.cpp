#include "worker/scan/instance_bounds.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "kernels/cpu/bake_cell.h"
#include "tests/random_seed.h"
#include "worker/pipeline/lattice.h"

namespace gigabake {
namespace {

TEST(BoundsOf, LooksAtFinitePositionsOnly) {
  Primitive p;
  p.position = {1, 2, 3, std::numeric_limits<float>::quiet_NaN(), 5, -7, 0, std::numeric_limits<float>::infinity(), 4};
  const LocalBounds b = bounds_of(p);
  EXPECT_EQ(b.low, (Vec3d{0, 2, -7}));
  EXPECT_EQ(b.high, (Vec3d{1, 5, 4}));
}

TEST(MayMeet, IsFalseForAPrimitiveWithoutAFinitePosition) {
  Primitive p;
  p.position.assign(9, std::numeric_limits<float>::quiet_NaN());
  BakeParameters parameters;
  parameters.voxel_size_m = 1;
  EXPECT_FALSE(may_overlap(scene_box(bounds_of(p), Instance{}, parameters), parameters, Box3i64::cube({}, 8)));
}

/// Triangles under random rotations, shears and shifts lie around the cell's border.
TEST(MayMeet, IsTrueWheneverTheKernelsFindAVoxel) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const ThreadPool pool(1);
  const kernels::MaterialView white;
  int met = 0, missed = 0;
  for (int round = 0; round < 4000; ++round) {
    BakeParameters parameters;
    parameters.voxel_size_m = std::exp(3 * unit(rng));
    for (auto& o : parameters.lattice_origin_m) o = 1000 * unit(rng);
    Primitive primitive;
    for (int i = 0; i < 9; ++i) primitive.position.push_back(float(20 * unit(rng)));
    primitive.index = {0, 1, 2};
    Instance instance;
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) instance.scene_from_local.m[r][c] = unit(rng) * parameters.voxel_size_m;
      instance.scene_from_local.m[r][3] =
          parameters.lattice_origin_m[r] + (4 + 12 * unit(rng)) * parameters.voxel_size_m;
    }
    const auto map = row_major(instance.scene_from_local);
    kernels::PartView part;
    part.position = {primitive.position.data(), 9};
    part.index = {primitive.index.data(), 3};
    std::ranges::copy(map, part.scene_from_local);
    kernels::CellParameters cell;
    cell.frame = snap_frame(parameters);
    cell.window_voxels = 8;
    cell.surface = SurfaceRule::conservative;
    const bool occupied = !kernels::bake_cell({{&part, 1}, {&white, 1}, {}}, cell, pool).levels.empty();
    const bool may =
        may_overlap(scene_box(bounds_of(primitive), instance, parameters), parameters, Box3i64::cube({}, 8));
    EXPECT_TRUE(may || !occupied) << "round " << round;
    met += occupied;
    missed += !may;
  }
  EXPECT_GT(met, 100);
  EXPECT_GT(missed, 100);
}

}  // namespace
}  // namespace gigabake
