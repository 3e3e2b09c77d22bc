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
  } version_7[] = {{SurfaceRule::area, MipFilter::coverage, {0xf10273e520d3c53b, 0x8d2580819698ee75}},
                   {SurfaceRule::area, MipFilter::thesis, {0x0049cc422da7e6c7, 0x1f2e70f461a6dcc6}},
                   {SurfaceRule::area, MipFilter::box, {0xa50c2aecde0da83e, 0xf897c8b474e80051}},
                   {SurfaceRule::conservative, MipFilter::coverage, {0x301fc8e9008e8d14, 0x3fb58448cf604cdf}},
                   {SurfaceRule::thin, MipFilter::coverage, {0x113cdbfb2c937240, 0x816acd2cf400f832}}};
  for (const auto& [rule, filter, hash] : version_7)
    EXPECT_EQ(hash_of_all_cells(rule, filter), hash)
        << name_of(rule) << ", " << name_of(filter) << ": other voxels than this version gave: raise kernel_version";
}

}  // namespace
}  // namespace gigabake::kernels
