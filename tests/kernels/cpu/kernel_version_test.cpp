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
  EXPECT_EQ(kernel_version, 10u) << "write down what this version gives";
  const struct {
    SurfaceRule rule;
    MipFilter filter;
    Hash128 hash;
  } version_10[] = {{SurfaceRule::area, MipFilter::coverage, {0x219a9f127e58a501, 0x468de5c8d370a431}},
                    {SurfaceRule::area, MipFilter::thesis, {0xf50435f8bb3cee67, 0x9cd997d78a13df86}},
                    {SurfaceRule::area, MipFilter::box, {0x364416ad2bf89cb0, 0xf64e1c94c4446512}},
                    {SurfaceRule::conservative, MipFilter::coverage, {0xda0958782a06fbaa, 0x32a8628034a40cde}},
                    {SurfaceRule::thin, MipFilter::coverage, {0xbc8c87d950c713cc, 0x82470e9e2fa06edc}}};
  for (const auto& [rule, filter, hash] : version_10)
    EXPECT_EQ(hash_of_all_cells(rule, filter), hash)
        << name_of(rule) << ", " << name_of(filter) << ": other voxels than this version gave: raise kernel_version";
}

}  // namespace
}  // namespace gigabake::kernels
