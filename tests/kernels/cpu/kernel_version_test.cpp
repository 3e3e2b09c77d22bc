/// Voxels that a folder keeps from an earlier bake are taken over by fingerprint: so kernels that give other bytes need
/// another kernel_version.
#include "lattice/kernel_version.h"

#include <gtest/gtest.h>

#include "kernels/cpu/bake_cell.h"
#include "tests/kernels/cuda_scenes.h"

namespace gigabake::kernels {
namespace {

/// Of all test cells' lods, added up.
Hash128 hash_of_all_cells() {
  const ThreadPool pool(2);
  Hash128 sum{};
  for (test::TestCell& cell : test::all_cells()) {
    const CellVolume volume =
        bake_cell(cell.input(), cell.parameters(SurfaceRule::area, MipFilter::coverage, true), pool);
    for (const Hash128& lod : volume.content_hash) sum += lod;
  }
  return sum;
}

TEST(KernelVersion, IsRaisedWithWhateverGivesOtherVoxels) {
  const Hash128 of_version_4{0x8193bd7165105793, 0xa176cc188ad4598f};
  EXPECT_EQ(kernel_version, 4u) << "write down what this version gives";
  EXPECT_EQ(hash_of_all_cells(), of_version_4) << "other voxels than this version gave: raise kernel_version";
}

}  // namespace
}  // namespace gigabake::kernels
