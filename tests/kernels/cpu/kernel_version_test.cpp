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
                     {0xf4f3106c7d0c6c60, 0x0dc90c8bf39333c1},
                     {0x7b657da7a52649fb, 0xd2d3097dfa33c107},
                     {0x0ba30c0d84f5c0e4, 0xb2c23dc8b2e4d86d}},
                    {SurfaceRule::area,
                     MipFilter::thesis,
                     {0xd1cbf099d864b24f, 0x7e82c85e70c29dc1},
                     {0xcf34ede034b86dd3, 0x46a29859403a9679},
                     {0x62e51cf016193592, 0xab2e81456f7383ad}},
                    {SurfaceRule::area,
                     MipFilter::box,
                     {0x747b4ed57d2efdc3, 0x8b3daa79d8e85cf0},
                     {0xdc88743cc691c60a, 0xb3d830925ebd8585},
                     {0x3336a66471f6f75e, 0x36fe8a3df0707cee}},
                    {SurfaceRule::conservative,
                     MipFilter::coverage,
                     {0x31f1d680629028fa, 0x76cbe35a9df9500a},
                     {0x676acd9ef3814387, 0x602c00613726e294},
                     {0xe3f405592cd05b1f, 0x4c8e14c2c919151f}},
                    {SurfaceRule::thin,
                     MipFilter::coverage,
                     {0xe222b3c5d3c5055a, 0x35fa82b0453398da},
                     {0x1fe81609c5870e48, 0x82bfdd545897dccc},
                     {0x5e12fcc5cc7a4a08, 0xf82bbabcf4ff863a}}};
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
