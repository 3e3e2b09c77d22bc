// Compares the closed-form alpha of leak scenes with the triangles that are written for them.
#include "bench/accuracy/leaks/leak_scene.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <set>

#include "bench/accuracy/accuracy_views.h"
#include "bench/accuracy/leaks/leak_views.h"
#include "format/system/publish.h"
#include "tests/worker/glb_scene.h"

namespace gigabake::bench {
namespace {

TEST(Sheet, IsCrossedWithinItsBordersAndInFrontOfTheEye) {
  const Sheet sheet{{1, 1, 5}, {4, 0, 0}, {0, 2, 1}};
  const Vec3d down{0, 0, -1};
  EXPECT_TRUE(is_crossed(sheet, {2, 2, 20}, down));
  EXPECT_TRUE(is_crossed(sheet, {1, 1, 20}, down)) << "the border belongs to it";
  EXPECT_FALSE(is_crossed(sheet, {0.9, 2, 20}, down));
  EXPECT_FALSE(is_crossed(sheet, {2, 3.1, 20}, down));
  EXPECT_FALSE(is_crossed(sheet, {2, 2, 0}, down)) << "it lies behind the eye";
  EXPECT_TRUE(is_crossed(sheet, {2, 2, 0}, {0, 0, 3})) << "from below";
  EXPECT_FALSE(is_crossed(sheet, {-9, 2, 5.5}, {1, 0, 0}) && is_crossed(sheet, {2, 0, 20}, {1, 0, 0}));
}

TEST(Sheet, ATriangleIsHalfOfIt) {
  const Sheet sheet{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, SheetShape::triangle};
  EXPECT_TRUE(is_crossed(sheet, {1, 1, 9}, {0, 0, -1}));
  EXPECT_FALSE(is_crossed(sheet, {3, 3, 9}, {0, 0, -1}));
}

TEST(Sheet, LayersLetThroughWhatEachLetsThrough) {
  const Sheet upper{{0, 0, 2}, {4, 0, 0}, {0, 4, 0}}, lower{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}};
  EXPECT_DOUBLE_EQ(alpha_through({upper, lower}, 0.3, {1, 1, 9}, {0, 0, -1}), 1 - 0.7 * 0.7);
  EXPECT_DOUBLE_EQ(alpha_through({upper, lower}, 0.3, {6, 6, 9}, {0, 0, -1}), 0.3);
  EXPECT_EQ(alpha_through({upper, lower}, 0.3, {-1, 6, 9}, {0, 0, -1}), 0);
}

TEST(LeakScenes, HaveNamesOfTheirOwnAndEveryFamily) {
  std::set<std::string> names, families;
  for (const LeakScene& scene : leak_scenes(64)) {
    EXPECT_TRUE(names.insert(scene.name).second) << scene.name;
    families.insert(scene.family);
  }
  EXPECT_EQ(families, (std::set<std::string>{"covered planes", "crowns", "hills", "mixed winding", "panes", "planes",
                                             "roofs over walls", "steps", "thin walls", "wires"}));
}

TEST(LeakScenes, AreSeenOnlyWhereTheyAreWideEnough) {
  const std::vector<LeakView> views = leak_views(subject_of(plane_scene(100, 20, 30)), {}, BakeParameters{1});
  EXPECT_EQ(views.size(), 7u * 4 + 4) << "0.25, 1, 1.4 and 4 voxels a pixel: at 8 it would be 12 pixels wide";
}

TEST(LeakViews, BeginBehindTheirDistanceOrChangeLevelsInTheMiddle) {
  const BakeParameters lattice{1};
  const LeakScene scene = plane_scene(400, 20, 30);
  for (const LeakView& view : leak_views(subject_of(scene), {}, lattice)) {
    const kernels::CastCamera camera = reference_camera(view.camera, lattice);
    const double wanted = camera.lod1_depth * view.voxels_per_pixel / 2;
    const auto depth_of = [&](const Vec3d& p) { return dot(p - Vec3d::from(camera.eye), Vec3d::from(camera.forward)); };
    const double target = depth_of(scene.target);
    double nearest = 1e30;
    for (const double u : {0.0, 1.0})
      for (const double v : {0.0, 1.0}) {
        const Sheet& sheet = scene.sheets[0];
        nearest = std::min(nearest, depth_of(sheet.corner + sheet.u * u + sheet.v * v));
      }
    if (view.eye == LeakEye::at_level_change) {
      EXPECT_NEAR(target / wanted, 1, 1e-6);
    } else {
      EXPECT_GT(nearest / wanted, 0.999) << view.elevation_deg << " " << view.voxels_per_pixel;
      const double to_lattice = view.eye == LeakEye::on_lattice ? 64 : 0;
      EXPECT_LT(nearest, 1.001 * wanted + to_lattice) << view.elevation_deg << " " << view.voxels_per_pixel;
    }
    if (view.eye == LeakEye::on_lattice) {
      EXPECT_EQ(std::fmod(camera.eye[2], 64), 0);
    }
  }
}

class LeakTruths : public testing::Test {
 protected:
  void SetUp() override {
    if (!ReferenceCaster::is_built()) GTEST_SKIP() << "built without Embree";
  }

  /// Compares the triangles with the alpha of all pixels that have a closed form. Returns the number of these pixels.
  std::size_t compare(const LeakScene& scene) {
    const std::vector<std::uint8_t> glb = sample::to_glb(scene.model);
    publish_file(folder_.path() / "scene.glb", {reinterpret_cast<const char*>(glb.data()), glb.size()},
                 Durability::while_up);
    SourceOptions options;
    options.local = true;
    BakeParameters lattice;
    lattice.voxel_size_m = 1;
    const ReferenceCaster caster(open_sources(folder_.path() / "scene.glb", options), lattice, 2);
    LeakViewRange range;
    range.width = range.height = 48;
    std::size_t seen = 0;
    for (const LeakView& view : leak_views(subject_of(scene), range, lattice)) {
      const kernels::CastCamera camera = reference_camera(view.camera, lattice);
      const AlphaPicture reference_alpha = alpha_of_sheets(scene, camera);
      const std::vector<bool> inner = inner_pixels(reference_alpha);
      const LeakError e = leak_error(inner, reference_alpha, caster.draw(camera, 4));
      seen += e.inner;
      if (scene.reference_alpha == LeakReferenceKind::sheets) {
        EXPECT_LT(e.rms, 1e-4) << scene.name << ", " << view.elevation_deg << "°, " << view.voxels_per_pixel;
      } else if (e.inner > 0 && view.elevation_deg >= 20) {
        EXPECT_TRUE(e.bias < -0.01 && e.bias > -0.99) << scene.name << " is neither empty nor full: " << e.bias;
      }
    }
    return seen;
  }

  ScratchFolder folder_;
};

TEST_F(LeakTruths, AreWhatTheTrianglesShow) {
  for (const LeakScene& scene : leak_scenes(150)) EXPECT_GT(compare(scene), 1000u) << scene.name;
}

TEST_F(LeakTruths, AHoleInTheTrianglesShows) {
  LeakScene scene = plane_scene(150, 20, 30);
  scene.model.meshes[0].index.resize(3);
  const std::vector<std::uint8_t> glb = sample::to_glb(scene.model);
  publish_file(folder_.path() / "scene.glb", {reinterpret_cast<const char*>(glb.data()), glb.size()},
               Durability::while_up);
  SourceOptions options;
  options.local = true;
  const BakeParameters lattice{1};
  const ReferenceCaster caster(open_sources(folder_.path() / "scene.glb", options), lattice, 1);
  const kernels::CastCamera camera =
      reference_camera(leak_views(subject_of(scene), {}, lattice).front().camera, lattice);
  const AlphaPicture reference_alpha = alpha_of_sheets(scene, camera);
  EXPECT_GT(leak_error(inner_pixels(reference_alpha), reference_alpha, caster.draw(camera, 1)).below_90, 0.3);
}

}  // namespace
}  // namespace gigabake::bench
