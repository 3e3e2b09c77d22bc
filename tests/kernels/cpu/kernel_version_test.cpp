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
  } version_7[] = {{SurfaceRule::area, MipFilter::coverage, {0x5e33ac3cfc222aef, 0xce27ee8b137537d3}},
                   {SurfaceRule::area, MipFilter::thesis, {0x9902c7ea2739a657, 0x3a64df0657374475}},
                   {SurfaceRule::area, MipFilter::box, {0x1938bd0accd5a6de, 0x06197dcbec5595fe}},
                   {SurfaceRule::conservative, MipFilter::coverage, {0x33a06aa845c2f53c, 0xb4b77525f20bea83}},
                   {SurfaceRule::thin, MipFilter::coverage, {0xd5f4cd7ef5dece62, 0x1a7a92235462e6c2}}};
  for (const auto& [rule, filter, hash] : version_7)
    EXPECT_EQ(hash_of_all_cells(rule, filter), hash)
        << name_of(rule) << ", " << name_of(filter) << ": other voxels than this version gave: raise kernel_version";
}

}  // namespace
}  // namespace gigabake::kernels
