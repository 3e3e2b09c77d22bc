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
  EXPECT_EQ(kernel_version, 11u) << "write down what this version gives";
  const struct {
    SurfaceRule rule;
    MipFilter filter;
    Hash128 flat, smooth, mapped;  ///< of cells without and with vertex normals, and with normal maps
  } version_11[] = {{SurfaceRule::area,
                     MipFilter::coverage,
                     {0x219a9f127e58a501, 0x468de5c8d370a431},
                     {0xd33173e8ef26cf57, 0x6b6f4d8d3f33c527},
                     {0x1ad35629e0677efa, 0xf001587c5e09591c}},
                    {SurfaceRule::area,
                     MipFilter::thesis,
                     {0xf50435f8bb3cee67, 0x9cd997d78a13df86},
                     {0xfcbd4a2a38c641d8, 0x42c3d3342e046239},
                     {0x7cb402aca6c802bf, 0xa6dfd44bc9cab383}},
                    {SurfaceRule::area,
                     MipFilter::box,
                     {0x364416ad2bf89cb0, 0xf64e1c94c4446512},
                     {0x1d4bee4a082da2f5, 0xbe1b311af548f0a7},
                     {0x25313323cdf79f4c, 0x2d3a6d750cd23bb2}},
                    {SurfaceRule::conservative,
                     MipFilter::coverage,
                     {0xda0958782a06fbaa, 0x32a8628034a40cde},
                     {0x98fc265750945cbd, 0x0eaed26e9fda62ec},
                     {0x7e47343588581c13, 0x60a93555e112b775}},
                    {SurfaceRule::thin,
                     MipFilter::coverage,
                     {0xbc8c87d950c713cc, 0x82470e9e2fa06edc},
                     {0x00d169447cadf338, 0x101133f65c1f1a6c},
                     {0x3a1e338ec2a734b4, 0xba1cdf2971846b34}}};
  for (const auto& [rule, filter, flat, smooth, mapped] : version_11) {
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
