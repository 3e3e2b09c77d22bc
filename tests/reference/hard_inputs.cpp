#include <limits>

#include "core/base/rules.h"
#include "hard_values.h"
#include "hard_values_scene.h"

namespace gigabake::reference {
namespace {

constexpr std::array<std::int8_t, 2> up{0, 0}, down{127, 127};

const Triangle off_centre{{{10, 10, 10}, {110, 20, 30}, {30, 100, 90}}};

void normal_follows_winding() {
  BakeScene front, back;
  front.add_mesh(sheet_at(100));
  back.add_mesh(reversed(sheet_at(100)));
  EXPECT_EQ(only_voxel(front).normal, up);
  EXPECT_NEAR(direction_of(only_voxel(back).normal)[2], -1, 1e-12);
}

void opposite_sheets_cancel() {
  BakeScene scene;
  scene.add_mesh(sheet_at(100));
  scene.add_mesh(reversed(sheet_at(120)));
  EXPECT_EQ(only_voxel(scene).normal, up) << "the zero vector is stored as +z";
}

void mirrored_instances_keep_their_outside() {
  BakeScene scene;
  scene.add_mesh(sheet_at(100)).scene_from_local = {-1, 0, 0, 256, 0, 1, 0, 0, 0, 0, 1, 0};
  EXPECT_EQ(only_voxel(scene).normal, up);
}

void mirrored_upside_down() {
  BakeScene scene;
  scene.add_mesh(sheet_at(100)).scene_from_local = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 256};
  EXPECT_EQ(only_voxel(scene).normal, down);
}

void half_a_turn_turns_the_normal() {
  BakeScene scene;
  scene.add_mesh(sheet_at(100)).scene_from_local = {1, 0, 0, 0, 0, -1, 0, 256, 0, 0, -1, 256};
  EXPECT_EQ(only_voxel(scene).normal, down);
}

void what_is_invisible_has_no_say_in_the_normal() {
  BakeScene scene;
  scene.add_mesh(sheet_at(100), scene.add_colour({65535, 65535, 65535, 0}, AlphaMode::blend));
  scene.add_mesh({{{{100, 10, 10}, {100, 200, 10}, {100, 10, 200}}}});
  EXPECT_EQ(only_voxel(scene).normal, (std::array<std::int8_t, 2>{127, 0}));
}

Part spoiled(float bad) {
  Part part;
  part.position = {10, 10, 10, 110, 20, 30, 30, 100, 90, 200, bad, 200};
  part.index = {0, 1, 2, 1, 2, 3};
  return part;
}

void not_a_number_is_dropped() {
  const float inf = std::numeric_limits<float>::infinity();
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), inf, -inf}) {
    BakeScene scene;
    scene.add_part(spoiled(bad));
    EXPECT_EQ(baked(scene).size(), 1u);
    EXPECT_EQ(scene.bake().stats.non_finite, 1u);
  }
}

void off_the_lattice_is_dropped() {
  BakeScene scene;
  scene.add_part(spoiled(1e30f));
  EXPECT_EQ(baked(scene).size(), 1u);
  EXPECT_EQ(scene.bake().stats.non_finite, 1u);
}

void bad_vertices_that_no_triangle_uses_do_not_count() {
  BakeScene scene;
  scene.add_part(spoiled(std::numeric_limits<float>::quiet_NaN())).index = {0, 1, 2};
  EXPECT_EQ(baked(scene).size(), 1u);
  EXPECT_EQ(scene.bake().stats.non_finite, 0u);
}

void oversized_is_counted_for_the_cell_to_fail() {
  BakeScene scene;
  const std::int64_t far = std::int64_t(1) << 31;
  scene.add_triangle({{{-far, 0, 10}, {far, 0, 10}, {0, far, 10}}});
  EXPECT_EQ(scene.bake().stats.oversized, 1u);
}

void max_width_is_not_oversized() {
  BakeScene scene;
  const std::int64_t far = std::int64_t(1) << 30;
  scene.add_triangle({{{-far, -far, 10}, {far, -far, 10}, {0, far, 10}}});
  EXPECT_EQ(scene.bake().stats.oversized, 0u);
  EXPECT_EQ(baked(scene).size(), 16u * 16u);
}

void no_area_after_the_snap_is_dropped() {
  BakeScene scene;
  Part part;
  part.position = {10.1f, 10.2f, 10.3f, 10.4f, 10.2f, 10.3f, 10.2f, 10.45f, 10.3f};
  part.index = {0, 1, 2};
  scene.add_part(part);
  EXPECT_TRUE(baked(scene).empty());
  EXPECT_EQ(scene.bake().stats.zero_area, 1u);
}

void half_a_sub_voxel_snaps_up() {
  for (const auto& [z, voxel] : {std::pair{255.5f, 1}, {255.49f, 0}, {-0.5f, 0}, {-0.51f, -1}}) {
    BakeScene scene;
    scene.set_window({-8, -8, -8}, 16);
    Part part;
    part.position = {10, 10, z, 110, 20, z, 30, 100, z};
    part.index = {0, 1, 2};
    scene.add_part(part);
    EXPECT_EQ(positions_of(baked(scene)), (std::set<Voxel>{{0, 0, voxel}})) << "z = " << z;
  }
}

void far_from_the_origin() {
  BakeScene here, there;
  const std::int64_t far = std::int64_t(1) << 40;  // voxels
  here.add_triangle(off_centre);
  there.set_window({far, -far, far}, 16);
  there.add_mesh({off_centre}).scene_from_local = {1, 0, 0, 256.0 * far, 0, 1, 0, -256.0 * far, 0, 0, 1, 256.0 * far};
  EXPECT_EQ(only_voxel(there), only_voxel(here));
}

void texture_coordinates_that_are_not_numbers_mean_zero() {
  BakeScene scene;
  const auto material = scene.add_textured({}, {255, 0, 0, 255, 0, 255, 0, 255, 0, 255, 0, 255, 0, 255, 0, 255}, 2, 2);
  Part& part = scene.add_mesh({off_centre}, material);
  part.uv = {0.25f, 0.25f, std::numeric_limits<float>::quiet_NaN(), 0.25f, 0.25f, 0.25f};
  const BakedVoxel bad = only_voxel(scene);
  EXPECT_EQ(scene.bake().stats.bad_uv, 1u);
  part.uv = {0, 0, 0, 0, 0, 0};
  EXPECT_EQ(bad, only_voxel(scene));
  EXPECT_EQ(scene.bake().stats.bad_uv, 0u);
}

}  // namespace

std::vector<HardValue> hard_normals() {
  return {{"normal-follows-winding", normal_follows_winding},
          {"opposite-sheets-cancel", opposite_sheets_cancel},
          {"mirrored-keeps-outside", mirrored_instances_keep_their_outside},
          {"mirrored-upside-down", mirrored_upside_down},
          {"half-a-turn", half_a_turn_turns_the_normal},
          {"invisible-has-no-normal", what_is_invisible_has_no_say_in_the_normal}};
}

std::vector<HardValue> hard_inputs() {
  return {{"not-a-number", not_a_number_is_dropped},
          {"off-the-lattice", off_the_lattice_is_dropped},
          {"unused-bad-vertex", bad_vertices_that_no_triangle_uses_do_not_count},
          {"oversized", oversized_is_counted_for_the_cell_to_fail},
          {"widest", max_width_is_not_oversized},
          {"no-area-after-snap", no_area_after_the_snap_is_dropped},
          {"half-a-sub-voxel", half_a_sub_voxel_snaps_up},
          {"far-from-origin", far_from_the_origin},
          {"bad-texture-coordinates", texture_coordinates_that_are_not_numbers_mean_zero}};
}

}  // namespace gigabake::reference
