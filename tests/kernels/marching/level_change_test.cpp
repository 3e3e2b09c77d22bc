#include <gtest/gtest.h>
#include <memory>
#include <vector>

#include "kernels/render/caster.h"
#include "tests/kernels/marching/one_cell.h"

namespace gigabake::kernels {
namespace {

/// A tree of 16³ voxels that is empty at lod 0 and has an opaque floor at lod 1; the scene has no other cell.
struct FloorOfLod1 : OneCell {
  FloorOfLod1() : OneCell(4, 2) { scene.min[2] = 13; }

  void put_in(Caster& caster) const {
    CastBricks bricks;
    bricks.push_back(std::make_unique<CastBrick>());
    SlotVoxels slot;
    for (int at = 0; at < slot_edge * slot_edge; ++at) {
      slot.row[4][at / slot_edge] = (1u << slot_edge) - 1;
      slot.voxel[4 * slot_edge * slot_edge + at] = pack_voxel({{32768, 32768, 32768, 65535, 65535, 65535}, {}, 0});
    }
    pack_brick(slot, *bricks[0]);
    caster.put_bricks({{0, 0}}, bricks);
    std::vector<NodeChange> changes{{0, {1, 0}}};
    for (std::uint32_t child = 8; child < 16; ++child) changes.push_back({child, {empty_ref, empty_ref}});
    caster.put_nodes(changes);
  }
};

// 2026-11-23: a step over empty space ended beyond the scene, and the ray ended with it. The next level begins before
// that point, and the ray should still hit its surface.
TEST(LevelChange, ComesBeforeTheEndOfTheSceneWhereEmptySpaceWasSteppedOver) {
  const ThreadPool threads(1);
  const FloorOfLod1 floor;
  const auto caster = make_cpu_caster(floor.scene, {2, 1, max_parts}, {}, threads);
  floor.put_in(*caster);
  CastCamera camera;
  camera.width = camera.height = 1;
  camera.eye[0] = camera.eye[1] = 8.1;
  camera.eye[2] = 30;
  camera.forward[2] = -1;
  camera.right[0] = camera.up[1] = 0.001;
  camera.lod1_depth = 20;  // at a height of 10, on the floor
  caster->start(camera, {0, 0, 1, 1});
  ASSERT_EQ(caster->cast(0, 1, true, {}), 0u);
  float linear[4] = {};
  CastPixels out{};
  out.linear = linear;
  caster->resolve({}, out);
  EXPECT_GT(linear[3], 0.25f) << "the floor, of which one point is looked at";
}

}  // namespace
}  // namespace gigabake::kernels
