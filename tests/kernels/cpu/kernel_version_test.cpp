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
  EXPECT_EQ(kernel_version, 6u) << "write down what this version gives";
  const struct {
    SurfaceRule rule;
    MipFilter filter;
    Hash128 hash;
  } version_6[] = {{SurfaceRule::area, MipFilter::coverage, {0xac0347b9b879c1e9, 0x8b19b713870ce8ca}},
                   {SurfaceRule::area, MipFilter::thesis, {0xbc6f693c7a088a35, 0x6262a62df1e99178}},
                   {SurfaceRule::area, MipFilter::box, {0x486ce3d7a786c46a, 0xf29bcc2e98bcfc69}},
                   {SurfaceRule::conservative, MipFilter::coverage, {0x995c779232d7c06e, 0x4b0ded68eb630559}},
                   {SurfaceRule::thin, MipFilter::coverage, {0xe2b3b836fdb96d53, 0x00b9cec3f02a2596}}};
  for (const auto& [rule, filter, hash] : version_6)
    EXPECT_EQ(hash_of_all_cells(rule, filter), hash)
        << name_of(rule) << ", " << name_of(filter) << ": other voxels than this version gave: raise kernel_version";
}

}  // namespace
}  // namespace gigabake::kernels
