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
  } version_7[] = {{SurfaceRule::area, MipFilter::coverage, {0x43a77417a3b471a5, 0xceebbccc875c020e}},
                   {SurfaceRule::area, MipFilter::thesis, {0x4d5c1c6d487bc3c1, 0x3f36e43707f53bbc}},
                   {SurfaceRule::area, MipFilter::box, {0xfdf2ffa693276d0c, 0xa667f7c2a16e2e36}},
                   {SurfaceRule::conservative, MipFilter::coverage, {0x82d8e3292b6690f1, 0x535258282d94b20a}},
                   {SurfaceRule::thin, MipFilter::coverage, {0x17dab9020eec34cb, 0x20547dcfffc20780}}};
  for (const auto& [rule, filter, hash] : version_7)
    EXPECT_EQ(hash_of_all_cells(rule, filter), hash)
        << name_of(rule) << ", " << name_of(filter) << ": other voxels than this version gave: raise kernel_version";
}

}  // namespace
}  // namespace gigabake::kernels
