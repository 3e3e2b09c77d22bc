#include "worker/pipeline/cell_loader.h"

#include <gtest/gtest.h>

#include "glb_scene.h"
#include "kernels/cpu/bake_cell.h"
#include "worker/pipeline/cell_parameters.h"

namespace gigabake {
namespace {

/// 32,768 triangles of textured ground, 128 m wide, in cells of 32 m.
class CellLoaderTest : public testing::Test {
 protected:
  CellLoaderTest() {
    parameters.voxel_size_m = 0.25;
    parameters.cell_voxels = 128;
    GlbMesh mesh = rolling_ground(128, 0, 0);
    mesh.image = checkered_png(64);
    write_glb(folder.path() / "ground.glb", mesh);
    sources = sources_of(folder.path(), {"ground.glb"});
  }

  CellJob job_at(std::int64_t x, std::int64_t y, std::uint32_t cell_voxels) const {
    CellJob job;
    job.name = "cell";
    job.lattice_min = {x, y, -std::int64_t(cell_voxels) / 2};
    job.cell_voxels = cell_voxels;
    job.tiles = {0};
    return job;
  }

  /// Returns parameters with a cell so large that it contains all of the ground.
  BakeParameters uncut() const {
    BakeParameters one = parameters;
    one.cell_voxels = 1024;
    one.lattice_origin_m = {-100, -100, 0};
    return one;
  }

  static std::size_t triangles_of(const LoadedCell& cell) {
    std::size_t corners = 0;
    for (const kernels::PartView& part : cell.parts) corners += part.index.size;
    return corners / 3;
  }

  ScratchFolder folder;
  BakeParameters parameters;
  SceneSources sources;
};

TEST_F(CellLoaderTest, ACellOfALargeMeshHasTheBitsOfTheWholeMeshAndFewOfItsTriangles) {
  CellLoader loader(sources, parameters, std::uint64_t(1) << 28, 2);
  const BakeParameters one = uncut();
  CellLoader whole(sources, one, std::uint64_t(1) << 28, 2);
  int baked = 0;
  std::size_t triangles = 0;
  for (std::int64_t y = -128; y < 640; y += 128)
    for (std::int64_t x = -128; x < 640; x += 128) {
      const CellJob job = job_at(x, y, 128);
      const LoadedCell near = loader.load(job);
      CellJob far_and_near = job;
      far_and_near.lattice_min = {0, 0, -512};
      far_and_near.cell_voxels = 1024;
      const LoadedCell all = whole.load(far_and_near);
      ASSERT_EQ(triangles_of(all), 32768u);
      const kernels::CellParameters p = cell_parameters(job, parameters, 0);
      const kernels::CellVolume a = kernels::bake_cell(near.input(), p, callers_thread());
      const kernels::CellVolume b = kernels::bake_cell(all.input(), p, callers_thread());
      EXPECT_EQ(a.content_hash, b.content_hash) << x << ' ' << y;
      EXPECT_EQ(a.stats.triangles, b.stats.triangles);
      baked += !a.levels.empty();
      triangles += triangles_of(near);
    }
  EXPECT_EQ(baked, 16);
  EXPECT_LT(triangles, 3u * 32768);  // without clusters there would be 16 times as many
}

TEST_F(CellLoaderTest, AMeshThatLiesInOneCellIsNotCut) {
  const BakeParameters one = uncut();
  CellLoader loader(sources, one, std::uint64_t(1) << 28, 2);
  const LoadedCell cell = loader.load(job_at(0, 0, 1024));
  ASSERT_EQ(cell.tiles.size(), 1u);
  EXPECT_EQ(cell.tiles[0]->primitives().at(0).clusters.size(), 1u);
  EXPECT_EQ(triangles_of(cell), 32768u);
}

/// One image is the colour and the normal map: each use has its texture.
TEST_F(CellLoaderTest, ACellHasTheNormalMapsThatItsPartsUse) {
  const auto textures_with = [&](const std::string& map, bool normals) {
    GlbMesh mesh = rolling_ground(128, 0, 0);
    mesh.image = checkered_png(64);
    mesh.material = R"({"normalTexture":)" + map + "}";
    write_glb(folder.path() / "ground.glb", mesh);
    sources = sources_of(folder.path(), {"ground.glb"});
    BakeParameters p = parameters;
    p.normals = normals;
    CellLoader loader(sources, p, std::uint64_t(1) << 28, 2);
    const LoadedCell cell = loader.load(job_at(0, 0, 128));
    for (const kernels::PartView& part : cell.parts)
      EXPECT_EQ(part.normal_map.texture, cell.textures.size() == 2 ? 1 : -1) << map;
    return cell.textures.size();
  };
  EXPECT_EQ(textures_with(R"({"index":0})", true), 2u);
  EXPECT_EQ(textures_with(R"({"index":0})", false), 1u) << "voxels without normals";
  EXPECT_EQ(textures_with(R"({"index":0,"texCoord":3})", true), 1u) << "no coordinates";
}

}  // namespace
}  // namespace gigabake
