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
  EXPECT_EQ(kernel_version, 9u) << "write down what this version gives";
  const struct {
    SurfaceRule rule;
    MipFilter filter;
    Hash128 hash;
  } version_9[] = {{SurfaceRule::area, MipFilter::coverage, {0xb10fb67311ba0e8c, 0x218bc27e9a7a7b9a}},
                   {SurfaceRule::area, MipFilter::thesis, {0xf50435f8bb3cee67, 0x9cd997d78a13df86}},
                   {SurfaceRule::area, MipFilter::box, {0x364416ad2bf89cb0, 0xf64e1c94c4446512}},
                   {SurfaceRule::conservative, MipFilter::coverage, {0xf07e9c28e5fda081, 0x5db05bbb1810f835}},
                   {SurfaceRule::thin, MipFilter::coverage, {0x76c18d6db00470cc, 0xfe759869aa731e1e}}};
  for (const auto& [rule, filter, hash] : version_9)
    EXPECT_EQ(hash_of_all_cells(rule, filter), hash)
        << name_of(rule) << ", " << name_of(filter) << ": other voxels than this version gave: raise kernel_version";
}

}  // namespace
}  // namespace gigabake::kernels
