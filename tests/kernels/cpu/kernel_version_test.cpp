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
  EXPECT_EQ(kernel_version, 13u) << "write down what this version gives";
  const struct {
    SurfaceRule rule;
    MipFilter filter;
    Hash128 flat, smooth, mapped;  ///< of cells without and with vertex normals, and with normal maps
  } version_13[] = {{SurfaceRule::area,
                     MipFilter::coverage,
                     {0xcf7c237d7b69eee8, 0xe2d17d8f774cd8c9},
                     {0x0b44498f9dc3a3fd, 0x185239f5c4d604c4},
                     {0x0e68edcb9a011f18, 0x785139eaacca8e9a}},
                    {SurfaceRule::area,
                     MipFilter::thesis,
                     {0xcb34732fea81ab16, 0x5fbf81add392f282},
                     {0xbc188b18ea33fb59, 0x7267d3eaae3cb428},
                     {0xd77d20e3419d3ded, 0x976d039dbfdfb085}},
                    {SurfaceRule::area,
                     MipFilter::box,
                     {0xa8b31f07e5ccdb57, 0x0036169ef2a417c2},
                     {0x05af7577774a6780, 0x517f7fa9cbb05dc2},
                     {0x5acce8e8cba8ebfd, 0x51583dfb3ed50837}},
                    {SurfaceRule::conservative,
                     MipFilter::coverage,
                     {0x0cf80d02fe9240aa, 0x6cd9e7e8aa449d85},
                     {0xede18d0a96311a2c, 0xb4696e93fbb39868},
                     {0xabc4a596f0f08ae1, 0x52ebcd7487eb5930}},
                    {SurfaceRule::thin,
                     MipFilter::coverage,
                     {0xc69a348ad6d89e91, 0x8fde1aeabb825e8c},
                     {0x9adc06a35820d5c8, 0xcf78a73abdb7a127},
                     {0x53bb2bb066a1f00f, 0x71e1c2bab9421cca}}};
  for (const auto& [rule, filter, flat, smooth, mapped] : version_13) {
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
