#include "core/base/rules.h"
#include "hard_values.h"
#include "hard_values_scene.h"

namespace gigabake::reference {
namespace {

void colours_weigh_by_area() {
  BakeScene scene;
  scene.add_mesh(sheet_at(100), scene.add_colour(red16));
  scene.add_mesh({sheet_at(50)[0]}, scene.add_colour(green16));
  expect_colour(only_voxel(scene), 2.0 / 3, 1.0 / 3, 0);
}

void tiny_beside_large() {
  BakeScene scene;
  scene.add_mesh(sheet_at(100), scene.add_colour(red16));
  scene.add_mesh({{{{10, 10, 10}, {11, 10, 10}, {10, 11, 10}}}}, scene.add_colour(green16));
  EXPECT_EQ(only_voxel(scene).rgba, (std::array<std::uint8_t, 4>{255, 0, 0, 255}));
}

void coincident_triangles_mix() {
  BakeScene scene;
  scene.add_mesh(sheet_at(100), scene.add_colour(red16));
  scene.add_mesh(sheet_at(100), scene.add_colour(green16));
  expect_colour(only_voxel(scene), 0.5, 0.5, 0);
}

void a_triangle_twice_is_once() {
  BakeScene scene;
  const auto grey = scene.add_colour({12345, 23456, 34567, 65535});
  scene.add_mesh(sheet_at(100), grey);
  const BakedVoxel once = only_voxel(scene);
  scene.add_mesh(sheet_at(100), grey);
  EXPECT_EQ(only_voxel(scene), once);
}

void black_is_not_absent() {
  BakeScene scene;
  scene.add_mesh(sheet_at(100), scene.add_colour(black16));
  EXPECT_EQ(only_voxel(scene).rgba, (std::array<std::uint8_t, 4>{0, 0, 0, 255}));
}

void a_contact_takes_the_triangles_colour() {
  BakeScene scene;
  scene.parameters.surface = SurfaceRule::conservative;
  scene.add_mesh({{{{256, 90, 90}, {160, 100, 100}, {160, 90, 110}}}}, scene.add_colour(red16));
  const VoxelMap voxels = baked(scene);
  ASSERT_EQ(voxels.size(), 2u);
  EXPECT_EQ(voxels.at({1, 0, 0}).rgba, (std::array<std::uint8_t, 4>{255, 0, 0, 255}));
}

void a_contact_loses_against_area() {
  BakeScene scene;
  scene.parameters.surface = SurfaceRule::conservative;
  scene.add_mesh({{{{256, 90, 90}, {160, 100, 100}, {160, 90, 110}}}}, scene.add_colour(red16));
  scene.add_mesh({{{{300, 20, 20}, {500, 30, 20}, {400, 230, 20}}}}, scene.add_colour(green16));
  EXPECT_EQ(baked(scene).at({1, 0, 0}).rgba, (std::array<std::uint8_t, 4>{0, 255, 0, 255}));
}

void vertex_colours_average_at_the_centroid() {
  BakeScene scene;
  Part& part = scene.add_mesh({{{{10, 10, 10}, {240, 20, 30}, {30, 230, 90}}}});
  part.rgba = {65535, 0, 0, 65535, 0, 65535, 0, 65535, 0, 0, 65535, 65535};
  expect_colour(only_voxel(scene), 1.0 / 3, 1.0 / 3, 1.0 / 3);
}

/// Checks that mirroring the map and the vertices only changes the winding: every colour stays within a code.
void expect_mirroring_keeps_colours(BakeScene& scene, Part part) {
  const VoxelMap plain = (scene.add_part(part), baked(scene));
  EXPECT_GT(plain.size(), 20u);
  for (std::size_t x = 0; x < part.position.size(); x += 3) part.position[x] = 2048 - part.position[x];
  part.scene_from_local = {-1, 0, 0, 2048, 0, 1, 0, 0, 0, 0, 1, 0};
  scene.parts().clear();
  const VoxelMap mirrored = (scene.add_part(part), baked(scene));
  ASSERT_EQ(positions_of(mirrored), positions_of(plain));
  for (const auto& [position, voxel] : plain)
    for (int c = 0; c < 4; ++c) ASSERT_NEAR(mirrored.at(position).rgba[c], voxel.rgba[c], 1);
}

void a_mirror_keeps_vertex_colours() {
  BakeScene scene;
  Part part;
  part.position = {100, 100, 100, 1900, 300, 200, 700, 1800, 900};
  part.index = {0, 1, 2};
  part.rgba = {65535, 0, 0, 65535, 0, 65535, 0, 65535, 0, 0, 65535, 65535};
  expect_mirroring_keeps_colours(scene, part);
}

void a_mirror_keeps_texture_coordinates() {
  BakeScene scene;
  std::vector<std::uint8_t> texels;
  for (int i = 0; i < 64; ++i) texels.insert(texels.end(), {std::uint8_t(i * 4), std::uint8_t(255 - i * 3), 0, 255});
  Part part;
  part.material = scene.add_textured({}, texels, 8, 8);
  part.position = {100, 100, 100, 1900, 300, 200, 700, 1800, 900};
  part.index = {0, 1, 2};
  part.uv = {0.1f, 0.1f, 0.9f, 0.2f, 0.3f, 0.8f};
  expect_mirroring_keeps_colours(scene, part);
}

void transparent_is_absent() {
  BakeScene scene;
  scene.add_mesh(sheet_at(100), scene.add_colour({65535, 65535, 65535, 0}, AlphaMode::blend));
  EXPECT_TRUE(baked(scene).empty());
}

void alpha_rounds_at_half_a_code() {
  BakeScene below, above;  // 65535 · 0.5/255 = 128.5
  below.add_mesh(sheet_at(100), below.add_colour({65535, 65535, 65535, 128}, AlphaMode::blend));
  EXPECT_TRUE(baked(below).empty());
  above.add_mesh(sheet_at(100), above.add_colour({65535, 65535, 65535, 129}, AlphaMode::blend));
  EXPECT_EQ(only_voxel(above).rgba[3], 1);
}

void opaque_ignores_alpha() {
  BakeScene scene;
  scene.add_mesh(sheet_at(100), scene.add_colour({65535, 0, 0, 0}, AlphaMode::opaque));
  EXPECT_EQ(only_voxel(scene).rgba, (std::array<std::uint8_t, 4>{255, 0, 0, 255}));
}

void a_mask_keeps_its_cutoff() {
  for (const int alpha : {32767, 32768}) {
    BakeScene scene;
    scene.add_mesh(sheet_at(100), scene.add_colour({65535, 0, 0, std::uint16_t(alpha)}, AlphaMode::mask));
    const VoxelMap voxels = baked(scene);
    EXPECT_EQ(voxels.size(), alpha == 32768 ? 1u : 0u);
    for (const auto& [position, voxel] : voxels) EXPECT_EQ(voxel.rgba[3], 255);
  }
}

void translucent_over_opaque() {
  BakeScene scene;
  scene.add_mesh(sheet_at(100));
  scene.add_mesh(sheet_at(50), scene.add_colour({0, 0, 0, 32768}, AlphaMode::blend));
  const BakedVoxel v = only_voxel(scene);
  EXPECT_EQ(v.rgba[3], 255);
  expect_colour(v, 2.0 / 3, 2.0 / 3, 2.0 / 3);
}

/// 2026-11-26: a mean over all fragments made the ground below decals, grass and litter translucent.
void cut_away_over_opaque() {
  BakeScene scene;
  scene.add_mesh(sheet_at(100), scene.add_colour(red16));
  const BakedVoxel alone = only_voxel(scene);
  scene.add_mesh(sheet_at(50), scene.add_colour({0, 65535, 0, 0}, AlphaMode::mask));
  scene.add_mesh(sheet_at(150), scene.add_colour({0, 65535, 0, 0}, AlphaMode::blend));
  EXPECT_EQ(only_voxel(scene), alone);
}

/// Returns the alpha of a voxel with a cut-away layer and a layer whose texels have these alphas.
int alpha_below_a_decal(AlphaMode mode, const std::array<std::uint8_t, 2>& alpha) {
  BakeScene scene;
  std::vector<std::uint8_t> texels;
  for (const std::uint8_t a : alpha) texels.insert(texels.end(), {200, 100, 50, a});
  kernels::MaterialView material;
  material.alpha_mode = mode;
  Part part;
  part.material = scene.add_textured(material, texels, 2, 1);
  part.position = {10, 10, 100, 250, 10, 100, 10, 250, 100};
  part.index = {0, 1, 2};
  part.uv = {0, 0, 1, 0, 0, 1};
  scene.add_part(part);
  scene.add_mesh(sheet_at(50), scene.add_colour({0, 65535, 0, 0}, AlphaMode::mask));
  return only_voxel(scene).rgba[3];
}

/// Many exporters declare every material as MASK or BLEND.
void textures_without_holes_are_opaque() {
  for (const AlphaMode mode : {AlphaMode::mask, AlphaMode::blend}) {
    EXPECT_EQ(alpha_below_a_decal(mode, {255, 255}), 255);
    EXPECT_LT(alpha_below_a_decal(mode, {255, 0}), 200) << "a part of this one is cut away";
  }
  EXPECT_EQ(alpha_below_a_decal(AlphaMode::mask, {255, 128}), 255) << "both texels pass";
  EXPECT_LT(alpha_below_a_decal(AlphaMode::blend, {255, 128}), 200);
}

}  // namespace

std::vector<HardValue> hard_colours() {
  return {{"colours-weigh-by-area", colours_weigh_by_area},
          {"tiny-beside-large", tiny_beside_large},
          {"coincident-triangles", coincident_triangles_mix},
          {"same-triangle-twice", a_triangle_twice_is_once},
          {"black-is-not-absent", black_is_not_absent},
          {"contact-takes-colour", a_contact_takes_the_triangles_colour},
          {"contact-loses-against-area", a_contact_loses_against_area},
          {"vertex-colours-at-centroid", vertex_colours_average_at_the_centroid},
          {"mirror-keeps-vertex-colours", a_mirror_keeps_vertex_colours},
          {"mirror-keeps-texture", a_mirror_keeps_texture_coordinates},
          {"transparent-is-absent", transparent_is_absent},
          {"alpha-rounds-at-half-a-code", alpha_rounds_at_half_a_code},
          {"opaque-ignores-alpha", opaque_ignores_alpha},
          {"mask-at-cutoff", a_mask_keeps_its_cutoff},
          {"translucent-over-opaque", translucent_over_opaque},
          {"cut-away-over-opaque", cut_away_over_opaque},
          {"textures-without-holes", textures_without_holes_are_opaque}};
}

}  // namespace gigabake::reference
