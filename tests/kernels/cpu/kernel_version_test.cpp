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
  EXPECT_EQ(kernel_version, 7u) << "write down what this version gives";
  const struct {
    SurfaceRule rule;
    MipFilter filter;
    Hash128 hash;
  } version_7[] = {{SurfaceRule::area, MipFilter::coverage, {0x2df5c05da379e50b, 0x715cce8772dbf33e}},
                   {SurfaceRule::area, MipFilter::thesis, {0x957a575e726519b1, 0xeb8c7ccc3d070df3}},
                   {SurfaceRule::area, MipFilter::box, {0x24883780fffccbb5, 0xfc21b6c1c42ce1c5}},
                   {SurfaceRule::conservative, MipFilter::coverage, {0xfbf16b3477bab208, 0xdba5f7b0894ae9c8}},
                   {SurfaceRule::thin, MipFilter::coverage, {0x6ad7adf18e45b69a, 0x029fd506deb4d1d1}}};
  for (const auto& [rule, filter, hash] : version_7)
    EXPECT_EQ(hash_of_all_cells(rule, filter), hash)
        << name_of(rule) << ", " << name_of(filter) << ": other voxels than this version gave: raise kernel_version";
}

}  // namespace
}  // namespace gigabake::kernels
