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
  } version_7[] = {{SurfaceRule::area, MipFilter::coverage, {0x1b050b96fd42ed81, 0x6859346548ce0c09}},
                   {SurfaceRule::area, MipFilter::thesis, {0x2e5885acb4e1270c, 0x23e20f04623fcdeb}},
                   {SurfaceRule::area, MipFilter::box, {0x798ec8f5db82455d, 0xcfa7d59b96b19e00}},
                   {SurfaceRule::conservative, MipFilter::coverage, {0xbf78d0404116c309, 0xd9c30ebca0c0eb08}},
                   {SurfaceRule::thin, MipFilter::coverage, {0x113cdbfb2c937240, 0x816acd2cf400f832}}};
  for (const auto& [rule, filter, hash] : version_7)
    EXPECT_EQ(hash_of_all_cells(rule, filter), hash)
        << name_of(rule) << ", " << name_of(filter) << ": other voxels than this version gave: raise kernel_version";
}

}  // namespace
}  // namespace gigabake::kernels
