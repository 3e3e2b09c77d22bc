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
  EXPECT_EQ(kernel_version, 12u) << "write down what this version gives";
  const struct {
    SurfaceRule rule;
    MipFilter filter;
    Hash128 flat, smooth, mapped;  ///< of cells without and with vertex normals, and with normal maps
  } version_12[] = {{SurfaceRule::area,
                     MipFilter::coverage,
                     {0xc246751957a165af, 0x737ab13fb8dfdc43},
                     {0x08843ddaa557d412, 0x9d8c68e17ea5e99d},
                     {0xd2f1ba9b1fa94875, 0xafde8d2230e36cf4}},
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
                     {0x93fe71efb44e6173, 0x1e2bef622058375b},
                     {0x2bc5dc0598d03d7c, 0xdd8cb6db3ce7ba3a},
                     {0xff3d9a9162689674, 0x6a5a8c941910c443}},
                    {SurfaceRule::thin,
                     MipFilter::coverage,
                     {0x27d3dc3d8ca949e7, 0x5d2c2eab4b71be2a},
                     {0xf588518f7133a35e, 0xcb43d28bfc6a600a},
                     {0xe83ed8fb6dacd0af, 0x87341cd2edf541a9}}};
  for (const auto& [rule, filter, flat, smooth, mapped] : version_12) {
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
