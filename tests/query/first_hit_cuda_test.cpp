// First hits are bit-identical on GPU and CPU. The tests are skipped, with the reason, if there is no GPU.
#include <cstring>
#include <gtest/gtest.h>
#include <memory>
#include <vector>

#include "first_hit_scenes.h"
#include "kernels/cuda/baker.h"
#include "query/first_hit/first_hit_device.h"

namespace gigabake {
namespace {

using kernels::FirstHit;
using kernels::VoxelAttributes;
using namespace first_hit_test;

class CudaFirstHit : public testing::Test {
 protected:
  void SetUp() override {
    const kernels::CudaDevices devices = kernels::cuda_devices();
    if (devices.usable.empty()) GTEST_SKIP() << devices.reason;
    device_ = devices.usable[0];
  }

  /// Expects the device's last cast to have the given hits and attributes.
  static void expect_equal(const kernels::CudaFirstHits& device, const std::vector<FirstHit>& hits,
                           const std::vector<VoxelAttributes>& attributes) {
    const std::vector<FirstHit> device_hits = device.hits();
    const std::vector<VoxelAttributes> device_looks = device.attributes();
    ASSERT_EQ(device_hits.size(), hits.size());
    ASSERT_EQ(device_looks.size(), attributes.size());
    int different = 0;
    for (std::size_t i = 0; i < hits.size(); ++i)
      different += std::memcmp(&hits[i], &device_hits[i], sizeof hits[i]) != 0 ||
                   std::memcmp(&attributes[i], &device_looks[i], sizeof attributes[i]) != 0;
    EXPECT_EQ(different, 0) << "of " << hits.size() << " rays";
  }

  int device_ = 0;
  ThreadPool pool_{2};
};

TEST_F(CudaFirstHit, CastsRaysAsTheCpuDoes) {
  for (const std::uint64_t sparsity : {2u, 20u, 400u, 20000u}) {
    VoxelScene voxels(32);
    voxels.add_cells(dust(sparsity), {0, 0, 0}, 64);
    const FirstHitScene scene = build(voxels);
    kernels::CudaFirstHits device(device_, scene.view);
    for (const std::size_t count : {std::size_t(1), std::size_t(33), std::size_t(200000)}) {
      const std::vector<kernels::FirstHitRay> rays = random_rays(count, -20, 84);
      std::vector<FirstHit> hits(count);
      std::vector<VoxelAttributes> attributes(count);
      kernels::cast_first_hits(scene.view, {rays.data(), count}, {{hits.data(), count}, {attributes.data(), count}},
                               pool_);
      device.upload({rays.data(), count});
      device.cast(true);
      expect_equal(device, hits, attributes);
    }
  }
}

TEST_F(CudaFirstHit, CastsPicturesAsTheCpuDoes) {
  VoxelScene voxels(64);
  voxels.add_cells(hills, {0, 0, 0}, 128);
  const FirstHitScene scene = build(voxels);
  kernels::CudaFirstHits device(device_, scene.view);
  for (const kernels::FirstHitCamera& c : cameras_on_hills()) {
    const std::size_t count = std::size_t(c.width) * std::size_t(c.height);
    std::vector<FirstHit> hits(count);
    std::vector<VoxelAttributes> attributes(count);
    kernels::cast_first_hits(scene.view, c, {{hits.data(), count}, {attributes.data(), count}}, pool_);
    device.cast(c, true);
    expect_equal(device, hits, attributes);
  }
}

TEST_F(CudaFirstHit, MeetsNothingInAnEmptyScene) {
  const FirstHitScene scene = FirstHitBuilder(0).finish();
  kernels::CudaFirstHits device(device_, scene.view);
  const std::vector<kernels::FirstHitRay> rays = random_rays(100, -1, 1);
  device.upload({rays.data(), rays.size()});
  device.cast(false);
  for (const FirstHit& hit : device.hits()) EXPECT_EQ(hit.attributes_index, kernels::no_attributes);
  EXPECT_TRUE(device.attributes().empty());
}

}  // namespace
}  // namespace gigabake
