/// Samples in bricks that are coarser than the ray's level: scenes with leaves have them in exact images.
#include <gtest/gtest.h>
#include <memory>
#include <random>
#include <vector>

#include "kernels/marching/cast.h"
#include "kernels/pool/pack_brick.h"
#include "tests/kernels/marching/one_cell.h"
#include "tests/random_seed.h"

namespace gigabake::kernels {
namespace {

/// A tree of 32³ voxels whose root brick, of lod 2, has leaves with translucent voxels and random planes only.
class Leaves : public OneCell {
 public:
  explicit Leaves(std::mt19937_64& rng) : OneCell(5, 3) {
    auto slot = std::make_unique<SlotVoxels>();
    for (int at = 0; at < slot_edge * slot_edge * slot_edge; ++at) {
      const int x = at % slot_edge, y = at / slot_edge % slot_edge, z = at / (slot_edge * slot_edge);
      if (rng() % 3 == 0 || z < 2 || z > 6) continue;
      slot->row[z][y] = std::uint16_t(slot->row[z][y] | 1u << x);
      const auto coverage = std::uint16_t(257 * (1 + rng() % 80));
      CastVoxel voxel{{std::uint16_t(rng() % 60000), 20000, 10000, coverage, coverage, coverage}, {0, 27, 100}, 0};
      if (rng() % 2 == 0) voxel.plane = std::uint8_t((1 + rng() % 15) << 2 | (1 + rng() % 3));
      slot->voxel[at] = pack_voxel(voxel);
    }
    pack_brick(*slot, brick_);
    nodes_.assign(8, pack_node({}));
    nodes_[0] = pack_node({lost_ref, 0});
    scene.nodes = nodes_.data();
    scene.parent_bricks = used_.data();
    scene.heads = &brick_.head;
    scene.voxels = brick_.parts.data();
    scene.feedback = {used_.data(), used_.data() + 1, used_.data() + 2};
  }

 private:
  CastBrick brick_;
  std::vector<NodeWord> nodes_;
  std::vector<std::uint32_t> used_ = std::vector<std::uint32_t>(16);
};

CastCamera random_camera(std::mt19937_64& rng) {
  const auto random = [&](double min, double max) { return std::uniform_real_distribution(min, max)(rng); };
  CastCamera camera;
  camera.width = camera.height = 1;
  camera.eye = {random(0, 32), random(0, 32), 45};
  camera.forward = {random(-0.5, 0.5), random(-0.5, 0.5), -1};
  camera.right = {0.001, 0, 0};
  camera.up = {0, 0.001, 0};
  camera.lod1_depth = 1e4;
  return camera;
}

/// Casts a ray as a device does: each hit is composited elsewhere, and the ray's march starts again after it.
int cast_with_restarts(const CastScene& scene, const CastCamera& camera, const CastLine& line, CastRay& ray) {
  for (int hits = 0;; ++hits) {
    MarchState march;
    CastPath path;
    start_march(scene, line, true, ray, march);
    march_to_surface(scene, camera, line, true, march, path, ray);
    if (march.task != CastTask::meet) return hits;
    MarchState met;
    CastPath other;
    pass_surface<RayType::primary>(scene, camera, line, true, met, other, ray);
    if (met.task != CastTask::find) return hits + 1;
  }
}

// 2026-11-28: the next sample depended on the step at which the ray had entered the brick. CPU and GPU rendered
// different images of leaves.
TEST(CoarserBrick, GivesTheSameLightHoweverOftenARayStartsAgain) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const Leaves leaves(rng);
  int hits = 0;
  for (int i = 0; i < 4000; ++i) {
    const CastCamera camera = random_camera(rng);
    const CastLine line = line_of_sight(leaves.scene, camera, 0, 0);
    CastRay whole = start_ray(leaves.scene, line), parts = whole;
    cast_ray(leaves.scene, camera, line, true, true, whole);
    hits += cast_with_restarts(leaves.scene, camera, line, parts);
    finish_opaque(parts);
    ASSERT_EQ(whole.rgb, parts.rgb) << "ray " << i;
    ASSERT_EQ(whole.transmittance, parts.transmittance) << "ray " << i;
    ASSERT_EQ(whole.depth, parts.depth) << "ray " << i;
  }
  EXPECT_GT(hits, 2000);
}

}  // namespace
}  // namespace gigabake::kernels
