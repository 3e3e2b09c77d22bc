// Shaders: they receive the surface's position and normal, and the image shows their result.
#include "kernels/light/shader.h"

#include <cmath>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/math/octahedral.h"
#include "tests/viewer/voxel_scene.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake {
namespace {

constexpr int run = 64;  ///< width of the slope in voxels; it rises one voxel per two

VoxelScene slope() {
  VoxelScene scene(run);
  scene.add_cell(
      [](std::int64_t x, std::int64_t, std::int64_t z) -> std::optional<Paint> {
        if (z != x / 2) return {};
        Paint paint;
        encode_octahedral(-1, 0, 2, paint.normal.data());
        return paint;
      },
      {0, 0, 0});
  return scene;
}

View seen_from_above(ViewMode mode) {
  View out{view({32, 32, 300}, {32, 32.001, 15}, 64).camera, mode, {false, {0, 0, 0, 0}}, PictureLight::linear_too};
  out.camera.fovy_deg = 8;
  return out;
}

Picture draw(const VoxelScene& scene, const View& view) {
  FrameRenderer::Options options;
  options.threads = 2;
  return FrameRenderer(scene.description(), "scene.xml", scene.pages(), options).render_complete(view).picture;
}

/// A shader whose colour is z of the position, z of the normal and x of the position.
struct WhereShader {
  GB_HD void operator()(const kernels::SurfacePoint& at, float rgb[3]) const {
    rgb[0] = float(at.place[2]) * at.there;
    rgb[1] = at.normal[2] * at.there;
    rgb[2] = float(at.place[0]) * at.there;
  }
};

TEST(Shader, OfOnesOwnKnowsWhereTheSurfaceIsAndWhereItFaces) {
  View view_of = seen_from_above(ViewMode::lit);
  view_of.shader = kernels::host_shader(WhereShader{});
  const Picture picture = draw(slope(), view_of);
  int seen = 0;
  for (std::size_t i = 0; i < picture.linear.size(); i += 4) {
    if (!(picture.linear[i + 3] > 0.99f)) continue;
    ++seen;
    EXPECT_NEAR(picture.linear[i], 0.25 + picture.linear[i + 2] / 2, 1) << "a voxel of " << i / 4;
    EXPECT_NEAR(picture.linear[i + 1], 2 / std::sqrt(5.0), 0.02) << i / 4;
  }
  EXPECT_GT(seen, 500);
}

TEST(Shader, OfHeightPaintsTheLowestBlueAndTheHighestWhite) {
  View all = seen_from_above(ViewMode::height);
  all.camera.fovy_deg = 13;
  const Picture picture = draw(slope(), all);
  const auto pixel = [&](std::size_t x) { return &picture.linear[4 * (32 * 64 + x)]; };
  std::size_t first = 0, last = 63;
  while (!(pixel(first)[3] > 0.99f)) ++first;
  while (!(pixel(last)[3] > 0.99f)) --last;
  if (pixel(first)[2] / pixel(first)[0] < pixel(last)[2] / pixel(last)[0]) std::swap(first, last);
  EXPECT_GT(pixel(first)[2], 2 * pixel(first)[1]) << "blue";
  EXPECT_NEAR(pixel(last)[0], pixel(last)[2], 0.3f * pixel(last)[0]) << "nearly white";
}

TEST(Shader, OfSlopePaintsByTheTangent) {
  const Picture picture = draw(slope(), seen_from_above(ViewMode::slope));
  const float* middle = &picture.linear[4 * (32 * 64 + 32)];
  ASSERT_GT(middle[3], 0.99f);
  EXPECT_NEAR(middle[1] / middle[0], 0.70 / 0.80, 0.1) << "a tangent of a half is yellow";
  EXPECT_LT(middle[2], 0.2f * middle[0]);
}

TEST(Shader, OfSlopeRefusesASceneWithoutNormals) {
  const VoxelScene scene = slope();
  SceneDescription without = scene.description();
  without.has_normals = false;
  FrameRenderer::Options options;
  options.threads = 1;
  FrameRenderer renderer(without, "scene.xml", scene.pages(), options);
  EXPECT_THROW(renderer.render_complete(seen_from_above(ViewMode::slope)), UsageError);
}

}  // namespace
}  // namespace gigabake
