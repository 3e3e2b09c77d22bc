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
  } version_6[] = {{SurfaceRule::area, MipFilter::coverage, {0xd23fd349cc0de615, 0x38deae54c28912ec}},
                   {SurfaceRule::area, MipFilter::thesis, {0x57490a35bb98c6b8, 0x9934c2a606dc845b}},
                   {SurfaceRule::area, MipFilter::box, {0xb1ec2b42bda99a0b, 0x3cd705b8ddd95d06}},
                   {SurfaceRule::conservative, MipFilter::coverage, {0xb4134bf757367f2b, 0xe880c4aabd14cd3c}},
                   {SurfaceRule::thin, MipFilter::coverage, {0xae9281cbf9e8c830, 0xcba8bdda3a571c63}}};
  for (const auto& [rule, filter, hash] : version_6)
    EXPECT_EQ(hash_of_all_cells(rule, filter), hash)
        << name_of(rule) << ", " << name_of(filter) << ": other voxels than this version gave: raise kernel_version";
}

}  // namespace
}  // namespace gigabake::kernels
