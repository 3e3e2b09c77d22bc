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
  } version_6[] = {{SurfaceRule::area, MipFilter::coverage, {0x844e7864e43a06e5, 0xcac45f1348ac9c69}},
                   {SurfaceRule::area, MipFilter::thesis, {0x94ba99e7a5c8cf31, 0xa20d4e2db3894517}},
                   {SurfaceRule::area, MipFilter::box, {0x20b81482d3470966, 0x3246742e5a5cb008}},
                   {SurfaceRule::conservative, MipFilter::coverage, {0x71a7a83d5e98056a, 0x8ab89568ad02b8f8}},
                   {SurfaceRule::thin, MipFilter::coverage, {0xf545ab9755505495, 0x08d70beaaf2f9f36}}};
  for (const auto& [rule, filter, hash] : version_6)
    EXPECT_EQ(hash_of_all_cells(rule, filter), hash)
        << name_of(rule) << ", " << name_of(filter) << ": other voxels than this version gave: raise kernel_version";
}

}  // namespace
}  // namespace gigabake::kernels
