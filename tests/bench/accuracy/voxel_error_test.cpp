// Compares baked planes with planes in closed form: missing, extra and misplaced voxels.
#include "bench/accuracy/voxel_error.h"

#include <cmath>
#include <gtest/gtest.h>

#include "bench/accuracy/sampled_voxels.h"
#include "bench/bench_scene.h"
#include "scheduler/plan/merge.h"
#include "tests/worker/glb_scene.h"

namespace gigabake::bench {
namespace {

constexpr double voxel_m = 0.5;

BakeParameters lattice(double voxel_size_m = voxel_m) {
  BakeParameters parameters;
  parameters.voxel_size_m = voxel_size_m;
  parameters.lattice_origin_m = {3, -2, 1};
  parameters.cell_voxels = 64;
  return parameters;
}

/// Returns a horizontal square around the origin, `up` voxels above the lattice's corner.
GlbMesh level_square(double half_m, double up, const std::string& material = "{}") {
  const auto h = float(half_m), y = float(1 + up * voxel_m);
  GlbMesh mesh;
  mesh.position = {-h, y, h, h, y, h, h, y, -h, -h, y, -h};
  mesh.index = {0, 1, 2, 0, 2, 3};
  mesh.material = material;
  return mesh;
}

std::string coloured(const std::string& rgba, const std::string& more = "") {
  return "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[" + rgba + "]}" + more + "}";
}

class VoxelErrors : public testing::Test {
 protected:
  void SetUp() override {
    if (!ReferenceCaster::is_built()) GTEST_SKIP() << "built without Embree";
  }

  SceneSources sources(const std::string& name, const GlbMesh& mesh) const {
    write_glb(folder_.path() / name, mesh);
    return sources_of(folder_.path(), {name});
  }

  std::filesystem::path bake(const SceneSources& of, const BakeParameters& parameters) const {
    const BenchScene scene{of.root, {}, parameters, 2, 0};
    const BakePlan plan = plan_scene(of, scene);
    CellPipeline pipeline(of, parameters, WorkerOptions{2, 0, folder_.path(), {}});
    const auto path = folder_.path() / "scene.xml";
    write_scene(path, merge(plan, bake_cells(pipeline, plan.jobs, 1), of.origin, parameters));
    return path;
  }

  VoxelError error_of(const GlbMesh& baked, const GlbMesh& reference_alpha, int coarser = 1, int threads = 2) const {
    const auto scene = bake(sources("baked.glb", baked), lattice(voxel_m * coarser));
    return voxel_error(ReferenceCaster(sources("truth.glb", reference_alpha), lattice(), threads), scene, coarser, {},
                       threads);
  }

  ScratchFolder folder_;
};

TEST_F(VoxelErrors, OfAPlaneAgainstItselfAreNone) {
  const GlbMesh square = level_square(10, 0.5, coloured("0.2,0.5,0.8,1"));
  const VoxelError e = error_of(square, square);
  EXPECT_EQ(e.voxels, 1600u);
  EXPECT_EQ(e.coloured, 1600u);
  EXPECT_EQ(e.points, 200000u);
  EXPECT_EQ(e.missed + e.extra + e.beyond_half + e.beyond_whole, 0);
  EXPECT_NEAR(e.max_distance, 0, 1e-6);
  EXPECT_NEAR(e.normal_99_deg, 0, 1e-4);
  EXPECT_NEAR(e.alpha_bias, 0, 1e-6);
  EXPECT_LT(e.rms_colour, 0.004) << "half a code";
  EXPECT_LT(e.delta_e, 0.4);
}

TEST_F(VoxelErrors, OfAPlaneInALatticePlaneAreNone) {
  const VoxelError e = error_of(level_square(10, 3), level_square(10, 3));
  EXPECT_EQ(e.missed + e.extra, 0) << "the plane belongs to the voxels above it and touches the voxels below it";
  EXPECT_NEAR(e.max_distance, 0.5, 1e-6);
}

TEST_F(VoxelErrors, OfAPlaneThatIsOffAreItsWholeArea) {
  // The reference plane is 1.2 voxels above the baked plane: 0.7 above the voxels' upper sides, 1.2 above their
  // centres.
  const VoxelError near = error_of(level_square(10, 0.5), level_square(10, 1.7));
  EXPECT_EQ(near.missed, 1);
  EXPECT_EQ(near.missed_by_half, 1);
  EXPECT_EQ(near.missed_by_one, 0);
  EXPECT_NEAR(near.extra, 1, 1e-9);
  EXPECT_NEAR(near.beyond_whole, 1, 1e-9);
  EXPECT_NEAR(near.max_distance, 1.2, 1e-5);
  EXPECT_EQ(near.coloured, 0u);
  const VoxelError far = error_of(level_square(10, 0.5), level_square(10, 5.5));
  EXPECT_EQ(far.missed_by_one, 1);
  EXPECT_NEAR(far.max_distance, 5, 1e-5);
}

TEST_F(VoxelErrors, OfHalfAPlaneAreTheOtherHalf) {
  const VoxelError less = error_of(level_square(5, 0.5), level_square(10, 0.5));
  EXPECT_NEAR(less.missed, 0.75, 0.01);
  EXPECT_EQ(less.extra, 0);
  const VoxelError more = error_of(level_square(10, 0.5), level_square(5, 0.5));
  EXPECT_EQ(more.missed, 0);
  // Voxels that only touch the smaller square's rim are within the snap distance and do not count as extra.
  EXPECT_NEAR(more.extra, 1 - 22 * 22 / 1600.0, 0.01);
}

TEST_F(VoxelErrors, OfColourAndAlphaAreTheirDifferences) {
  const VoxelError grey = error_of(level_square(10, 0.5), level_square(10, 0.5, coloured("0.5,0.5,0.5,1")));
  EXPECT_NEAR(grey.rms_colour, 0.5, 1e-4);
  EXPECT_NEAR(grey.delta_e, 100 - (116 * std::cbrt(0.5) - 16), 0.01);
  EXPECT_NEAR(grey.rms_alpha, 0, 1e-6);
  const std::string pane = coloured("1,1,1,0.25", ",\"alphaMode\":\"BLEND\"");
  const VoxelError thin = error_of(level_square(10, 0.5, pane), level_square(10, 0.5));
  EXPECT_NEAR(thin.alpha_bias, 64 / 255.0 - 1, 1e-4);
  EXPECT_NEAR(thin.rms_alpha, 1 - 64 / 255.0, 1e-4);
  EXPECT_NEAR(thin.rms_colour, 0, 1e-4);
}

TEST_F(VoxelErrors, OfATextureAreWhatFilteringLeaves) {
  GlbMesh square = level_square(10, 0.5);
  square.uv = {0, 1, 1, 1, 1, 0, 0, 0};
  square.image = checkered_png(16);
  const VoxelError e = error_of(square, square);
  EXPECT_NEAR(e.texels, 16 / 40.0, 1e-6) << "16 texels over 40 voxels";
  EXPECT_LT(e.rms_colour, 0.02);
  EXPECT_LT(e.delta_e, 3);
  GlbMesh other = square;
  other.image = checkered_png(32);
  const VoxelError wrong = error_of(square, other);
  EXPECT_NEAR(wrong.texels, 32 / 40.0, 1e-6) << "of the truth";
  EXPECT_GT(wrong.rms_colour, 5 * e.rms_colour);
}

TEST_F(VoxelErrors, OfNormalsAreAnglesToTheOutside) {
  GlbMesh turned = level_square(10, 0.5);
  turned.index = {0, 2, 1, 0, 3, 2};
  EXPECT_NEAR(error_of(turned, turned).normal_deg, 0, 1e-4);
  EXPECT_NEAR(error_of(turned, level_square(10, 0.5)).normal_deg, 180, 1e-4);
  GlbMesh ramp = level_square(10, 0);
  for (std::size_t v = 0; v < 4; ++v) ramp.position[3 * v + 1] = ramp.position[3 * v];
  const VoxelError e = error_of(ramp, ramp);
  EXPECT_LT(e.normal_99_deg, 0.97) << "what two bytes can say";
  EXPECT_EQ(e.missed + e.extra, 0);
}

TEST_F(VoxelErrors, OfAMirroredPlaneAreNone) {
  SceneSources mirrored = sources("plane.glb", level_square(10, 0.5));
  mirrored.tiles[0].scene_from_tile.m[0][0] *= -1;
  const auto scene = bake(mirrored, lattice());
  const VoxelError e = voxel_error(ReferenceCaster(mirrored, lattice(), 1), scene, 1, {}, 1);
  EXPECT_NEAR(e.normal_99_deg, 0, 1e-4);
  EXPECT_EQ(e.missed + e.extra, 0);
}

TEST_F(VoxelErrors, OfCoarserVoxelsAreInTheirs) {
  // The square is three voxels above the lattice's corner: 1.5 voxels of twice the size.
  const VoxelError e = error_of(level_square(10, 3), level_square(10, 3), 2);
  EXPECT_EQ(e.voxels, 400u);
  EXPECT_EQ(e.missed + e.extra, 0);
  EXPECT_NEAR(e.max_distance, 0, 1e-6);
}

TEST_F(VoxelErrors, DoNotDependOnThreads) {
  const GlbMesh ground = rolling_ground(20, 0, 0);
  const VoxelError one = error_of(ground, ground, 1, 1), three = error_of(ground, ground, 1, 3);
  EXPECT_EQ(one.normal_deg, three.normal_deg);
  EXPECT_EQ(one.rms_colour, three.rms_colour);
  EXPECT_EQ(one.missed + one.extra, 0);
}

TEST_F(VoxelErrors, AreOfAtMostAsManyVoxelsAsAskedFor) {
  const auto scene = bake(sources("plane.glb", level_square(10, 0.5)), lattice());
  const SceneDescription description = read_scene(scene);
  for (const std::uint64_t maximum : {1, 7, 1000, 1599, 1600, 9999}) {
    const std::size_t sampled = sample_voxels(description, scene, maximum, 5).size();
    EXPECT_LE(sampled, maximum);
    EXPECT_GE(sampled, std::min<std::uint64_t>(maximum, 1600) / 2);
  }
}

}  // namespace
}  // namespace gigabake::bench
