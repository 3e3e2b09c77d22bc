/// Voxels of an earlier bake in the same folder are reused by fingerprint. Therefore kernels that give other bytes need
/// another kernel_version.
#include "core/base/kernel_version.h"

#include <gtest/gtest.h>

#include "kernels/cpu/bake_cell.h"
#include "tests/kernels/cuda_scenes.h"

namespace gigabake::kernels {
namespace {

/// Returns the sum of the hashes of all levels of all test cells.
Hash128 hash_of_all_cells(SurfaceRule rule, MipFilter filter) {
  const ThreadPool pool(2);
  Hash128 sum{};
  for (test::TestCell& cell : test::all_cells())
    for (const Hash128& lod : bake_cell(cell.input(), cell.parameters(rule, filter, true), pool).content_hash)
      sum += lod;
  return sum;
}

TEST(KernelVersion, IsRaisedWithWhateverGivesOtherVoxels) {
  EXPECT_EQ(kernel_version, 8u) << "write down what this version gives";
  const struct {
    SurfaceRule rule;
    MipFilter filter;
    Hash128 hash;
  } version_8[] = {{SurfaceRule::area, MipFilter::coverage, {0xa759790c4c62a8c7, 0x639836d723b87928}},
                   {SurfaceRule::area, MipFilter::thesis, {0x5b07fd6d68aba787, 0x2c1b3dbb22e0cd70}},
                   {SurfaceRule::area, MipFilter::box, {0x14cd28cf560d90c7, 0xe7f843318393e2f0}},
                   {SurfaceRule::conservative, MipFilter::coverage, {0xe676ce102c1d70a0, 0x16283a9e5c7fd791}},
                   {SurfaceRule::thin, MipFilter::coverage, {0x113cdbfb2c937240, 0x816acd2cf400f832}}};
  for (const auto& [rule, filter, hash] : version_8)
    EXPECT_EQ(hash_of_all_cells(rule, filter), hash)
        << name_of(rule) << ", " << name_of(filter) << ": other voxels than this version gave: raise kernel_version";
}

}  // namespace
}  // namespace gigabake::kernels
