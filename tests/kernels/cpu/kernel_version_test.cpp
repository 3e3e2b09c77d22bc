/// Voxels that a folder keeps from an earlier bake are taken over by fingerprint: so kernels that give other bytes need
/// another kernel_version.
#include "lattice/kernel_version.h"

#include <gtest/gtest.h>

#include "kernels/cpu/bake_cell.h"
#include "tests/kernels/cuda_scenes.h"

namespace gigabake::kernels {
namespace {

/// Of all test cells' lods, added up.
Hash128 hash_of_all_cells(SurfaceRule rule, MipFilter filter) {
  const ThreadPool pool(2);
  Hash128 sum{};
  for (test::TestCell& cell : test::all_cells())
    for (const Hash128& lod : bake_cell(cell.input(), cell.parameters(rule, filter, true), pool).content_hash)
      sum += lod;
  return sum;
}

TEST(KernelVersion, IsRaisedWithWhateverGivesOtherVoxels) {
  EXPECT_EQ(kernel_version, 5u) << "write down what this version gives";
  const struct {
    SurfaceRule rule;
    MipFilter filter;
    Hash128 hash;
  } version_5[] = {{SurfaceRule::area, MipFilter::coverage, {0xccc1c098607e1de9, 0xa27a8dcd7a5c4b04}},
                   {SurfaceRule::area, MipFilter::thesis, {0x1ca97bc1ba296e14, 0xeaa1ef640c344272}},
                   {SurfaceRule::area, MipFilter::box, {0x06c80dc410e33543, 0x988682a0c6f32723}},
                   {SurfaceRule::conservative, MipFilter::coverage, {0xd3dd058d89d2a5f9, 0x7f819352b9c13c68}},
                   {SurfaceRule::thin, MipFilter::coverage, {0x0d61b4be5d3928fc, 0xcfa35367a51a417f}}};
  for (const auto& [rule, filter, hash] : version_5)
    EXPECT_EQ(hash_of_all_cells(rule, filter), hash)
        << name_of(rule) << ", " << name_of(filter) << ": other voxels than this version gave: raise kernel_version";
}

}  // namespace
}  // namespace gigabake::kernels
