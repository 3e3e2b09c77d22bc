/// Voxels of an earlier bake in the same folder are reused by fingerprint. Therefore kernels that give other bytes need
/// another kernel_version.
#include "core/base/kernel_version.h"

#include <gtest/gtest.h>
#include <list>
#include <utility>

#include "kernels/cpu/bake_cell.h"
#include "tests/kernels/cuda_scenes.h"

namespace gigabake::kernels {
namespace {

/// Returns the sum of the hashes of all levels of the cells.
Hash128 hash_of(std::list<test::TestCell> cells, SurfaceRule rule, MipFilter filter) {
  const ThreadPool pool(2);
  Hash128 sum{};
  for (test::TestCell& cell : cells)
    for (const Hash128& lod : bake_cell(cell.input(), cell.parameters(rule, filter, true), pool).content_hash)
      sum += lod;
  return sum;
}

TEST(KernelVersion, IsRaisedWithWhateverGivesOtherVoxels) {
  EXPECT_EQ(kernel_version, 14u) << "write down what this version gives";
  const struct {
    SurfaceRule rule;
    MipFilter filter;
    Hash128 flat, smooth, mapped;  ///< of cells without and with vertex normals, and with normal maps
  } version_14[] = {{SurfaceRule::area,
                     MipFilter::coverage,
                     {0xd03645d874815045, 0x26eb7536fef60ca9},
                     {0x5941584ed95a4535, 0x88f31a9ee3961cd3},
                     {0x49dbb865f05ad915, 0x6893d02c1eb71cc3}},
                    {SurfaceRule::area,
                     MipFilter::thesis,
                     {0xb1f058a02c522d34, 0x24905d41e616f230},
                     {0x39e88efbdd13919a, 0xdf63d60138a25198},
                     {0xfffa569d8245e01f, 0xf3f171a6c7b853df}},
                    {SurfaceRule::area,
                     MipFilter::box,
                     {0x0735efe2a27d5be8, 0x5353d211183f8b3f},
                     {0xb9c020054a3f916c, 0x883de53e10bcf0be},
                     {0xeb21d4a226548168, 0xca7d9154b0abd4cd}},
                    {SurfaceRule::conservative,
                     MipFilter::coverage,
                     {0x2fa1cbb518112697, 0x219c456bff5b4d05},
                     {0x0440eef48aecff0c, 0x47aee1df7e7f7768},
                     {0x7bafa3ac7a5c7d01, 0x72375dbb17167e8a}},
                    {SurfaceRule::thin,
                     MipFilter::coverage,
                     {0xeaf103cd006125d2, 0x2a74c098ce089663},
                     {0xed4edc419dd81e83, 0x079d2023b13f3fd9},
                     {0x9eabb20451be5218, 0xabfd518511ac20e3}}};
  for (const auto& [rule, filter, flat, smooth, mapped] : version_14) {
    EXPECT_EQ(hash_of(test::flat_cells(), rule, filter), flat)
        << name_of(rule) << ", " << name_of(filter) << ": other voxels than this version gave: raise kernel_version";
    EXPECT_EQ(hash_of(test::smooth_cells(), rule, filter), smooth)
        << name_of(rule) << ", " << name_of(filter) << ": other voxels than this version gave: raise kernel_version";
    EXPECT_EQ(hash_of(test::mapped_cells(), rule, filter), mapped)
        << name_of(rule) << ", " << name_of(filter) << ": other voxels than this version gave: raise kernel_version";
  }
}

}  // namespace
}  // namespace gigabake::kernels
