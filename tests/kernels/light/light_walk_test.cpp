#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "kernels/marching/cast.h"
#include "kernels/pool/pack_brick.h"
#include "tests/kernels/marching/one_cell.h"

namespace gigabake::kernels {
namespace {

/// A scene of one brick of 8³ voxels: opaque surfaces, residual coverage and translucent surfaces at random places.
class OneBrick {
 public:
  explicit OneBrick(std::mt19937_64& random) {
    SlotVoxels slot;
    for (int at = 0; at < slot_voxels; ++at) {
      if (random() % 8 != 0) continue;
      std::uint16_t& row = slot.row[at / (slot_edge * slot_edge)][at / slot_edge % slot_edge];
      row = std::uint16_t(row | 1u << at % slot_edge);
      slot.voxel[at] = pack_voxel(random_voxel(random));
    }
    pack_brick(slot, brick_);
    nodes_[0] = pack_node({empty_ref, 0});
    CastScene& scene = cell_.scene;
    scene.nodes = nodes_;
    scene.parent_bricks = &parent_brick_;
    scene.heads = &brick_.head;
    scene.voxels = brick_.parts.data();
    scene.feedback = {&tile_used_, &slot_used_, &wanted_};
  }

  const CastScene& scene() const { return cell_.scene; }

 private:
  static CastVoxel random_voxel(std::mt19937_64& random) {
    const auto coverage = [&] { return std::uint16_t(257 * (random() % 256)); };
    const auto below = [&](int end) { return int(random() % std::uint64_t(end)); };
    CastVoxel voxel{{100, 200, 300, coverage(), coverage(), coverage()}, {}, 0};
    const int x = below(128), y = below(128 - x);
    voxel.normal[0] = std::int8_t(x);
    voxel.normal[1] = std::int8_t(y);
    voxel.normal[2] = std::int8_t(127 - x - y);
    if (random() % 2 == 0) voxel.plane = pack_plane({below(15) - 7, 1 + below(max_coherence)});
    if (random() % 32 == 0) voxel.plane = clear_plane;
    return voxel;
  }

  OneCell cell_{3, 1};
  NodeWord nodes_[8] = {};
  std::uint32_t parent_brick_ = 0, tile_used_ = 0, slot_used_ = 0, wanted_ = 0;
  CastBrick brick_;
};

/// Returns a line from a point of a cube around the brick towards a point of the brick.
CastLine random_line(std::mt19937_64& random) {
  std::uniform_real_distribution<double> around(-12, 20), inside(0, 8);
  CastLine line;
  double squared = 0;
  for (int a = 0; a < 3; ++a) {
    line.origin[a] = around(random);
    line.direction[a] = inside(random) - line.origin[a];
    squared += line.direction[a] * line.direction[a];
  }
  line.enter = 0;
  line.leave = double(far_voxel);
  line.lod1_distance = 1e6;
  for (int a = 0; a < 3; ++a) {
    set_direction(line, a, line.direction[a] / std::sqrt(squared));
    clip_to_box(line, a, -1, 9);
  }
  return line;
}

template <RayType aim>
float light_through(const CastScene& scene, const CastLine& line) {
  CastRay ray = start_ray(scene, line);
  cast_ray<aim>(scene, CastCamera(), line, true, true, ray);
  EXPECT_EQ(ray.lod, -1);
  return ray.transmittance;
}

TEST(LightWalk, LetsThroughWhatTheEyesRayDoes) {
  constexpr std::uint64_t seed = 20261124;
  std::mt19937_64 random(seed);
  int partly = 0;
  for (int i = 0; i < 100; ++i) {
    const OneBrick brick(random);
    for (int n = 0; n < 50; ++n) {
      const CastLine line = random_line(random);
      const float seen = light_through<RayType::shadow>(brick.scene(), line);
      ASSERT_EQ(seen, light_through<RayType::primary>(brick.scene(), line))
          << "seed " << seed << ", brick " << i << ", ray " << n;
      partly += seen > 0 && seen < 1 ? 1 : 0;
    }
  }
  EXPECT_GT(partly, 500) << "rays that lose some of their light and not all";
}

}  // namespace
}  // namespace gigabake::kernels
