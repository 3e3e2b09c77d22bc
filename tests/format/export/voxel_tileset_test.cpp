#include "format/export/voxel_tileset.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lattice/error.h"
#include "lattice/octahedral.h"
#include "tests/format/scene/scene_voxels.h"
#include "tests/format/shard/made_shard.h"
#include "tests/format/system/small_disk.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using made::TempFolder;

struct TileVoxel {
  std::array<std::uint8_t, 4> rgba{};
  std::array<float, 3> normal{};
};
using TileVoxels = std::map<std::array<std::int64_t, 3>, TileVoxel>;

/// A tile's voxels, at their place among all of its level, from the oct-tree's lowest corner.
void read_tile(const std::filesystem::path& glb, const std::array<std::int64_t, 3>& tile, bool normals,
               TileVoxels& voxels) {
  const std::string bytes = made::bytes_of(glb);
  std::uint32_t json_bytes = 0;
  std::memcpy(&json_bytes, bytes.data() + 12, 4);
  const std::string binary = bytes.substr(20 + json_bytes + 8);
  ASSERT_EQ(binary.size(), normals ? 8192u : 2048u);
  const std::size_t rgba = normals ? 6144 : 0;
  for (std::int64_t z = 0; z < 8; ++z)
    for (std::int64_t y = 0; y < 8; ++y)
      for (std::int64_t x = 0; x < 8; ++x) {
        const auto i = std::size_t(x + 8 * z + 64 * (7 - y));
        TileVoxel voxel;
        std::memcpy(voxel.rgba.data(), binary.data() + rgba + 4 * i, 4);
        if (normals) std::memcpy(voxel.normal.data(), binary.data() + 12 * i, 12);
        if (voxel.rgba[3] != 0) voxels[{8 * tile[0] + x, 8 * tile[1] + y, 8 * tile[2] + z}] = voxel;
      }
}

TileVoxels read_level(const std::filesystem::path& folder, std::size_t level, bool normals) {
  TileVoxels voxels;
  const std::filesystem::path tiles = folder / "tiles" / std::to_string(level);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(tiles)) {
    if (!entry.is_regular_file()) continue;
    const std::filesystem::path p = entry.path();
    read_tile(p,
              {std::stoll(p.parent_path().parent_path().filename().string()),
               std::stoll(p.parent_path().filename().string()), std::stoll(p.stem().string())},
              normals, voxels);
  }
  return voxels;
}

TEST(VoxelTileset, EveryLevelOfTheShardsComesBackFromItsTiles) {
  for (int round = 0; round < 3; ++round) {
    const made::RandomScene scene(round);
    const SceneDescription& written = scene.description();
    const int finest = round % 2;
    EXPECT_EQ(export_3dtiles(scene.xml(), finest, scene / "out"), scene.voxels(finest).size());
    const nlohmann::json root = nlohmann::json::parse(made::bytes_of(scene / "out/tileset.json"))["root"];
    const std::size_t levels = root["implicitTiling"]["availableLevels"];
    const std::vector<double> box = root["boundingVolume"]["box"];
    for (int lod = finest; lod < 4; ++lod) {
      const double voxel_m = std::ldexp(written.voxel_size_m, lod);
      const TileVoxels read = read_level(scene / "out", levels - 1 - std::size_t(lod - finest), written.has_normals);
      const made::SceneVoxels voxels = scene.voxels(lod);
      ASSERT_EQ(read.size(), voxels.size());
      for (const auto& [at, voxel] : voxels) {
        std::array<std::int64_t, 3> from_corner{};
        for (std::size_t c = 0; c < 3; ++c)
          from_corner[c] = at[c] - std::llround((box[c] - box[3] - written.lattice_origin_m[c]) / voxel_m);
        ASSERT_TRUE(read.contains(from_corner));
        EXPECT_EQ(read.at(from_corner).rgba, voxel.rgba);
        const auto normal = written.has_normals ? unit_normal(voxel.normal.data()) : std::array<float, 3>{};
        EXPECT_EQ(read.at(from_corner).normal, normal);
      }
    }
  }
}

TEST(VoxelTileset, LevelsAboveTheCellsHaveAVoxelWhereTheLevelBelowHasOne) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  made::write_random_scene(folder / "scene.xml", rng, true);
  export_3dtiles(folder / "scene.xml", 3, folder / "out");
  const nlohmann::json root = nlohmann::json::parse(made::bytes_of(folder / "out/tileset.json"))["root"];
  const std::size_t levels = root["implicitTiling"]["availableLevels"];
  ASSERT_GT(levels, 1u);
  TileVoxels below = read_level(folder / "out", levels - 1, true);
  for (std::size_t level = levels - 1; level-- > 0;) {
    std::map<std::array<std::int64_t, 3>, std::array<std::uint32_t, 2>> span;  // least and greatest red of the children
    for (const auto& [at, voxel] : below) {
      const auto [entry, first] = span.insert({{at[0] >> 1, at[1] >> 1, at[2] >> 1}, {255, 0}});
      entry->second = {std::min(entry->second[0], std::uint32_t(voxel.rgba[0])),
                       std::max(entry->second[1], std::uint32_t(voxel.rgba[0]))};
    }
    const TileVoxels own = read_level(folder / "out", level, true);
    ASSERT_EQ(own.size(), span.size());
    for (const auto& [at, voxel] : own) {
      ASSERT_TRUE(span.contains(at));
      EXPECT_GE(voxel.rgba[0], span.at(at)[0]);
      EXPECT_LE(voxel.rgba[0], span.at(at)[1]);
    }
    below = own;
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "out/tiles/0/0/0/0.glb"));
}

TEST(VoxelTileset, IsNotWrittenWhereAShardIsDamagedOrTheDiskIsFull) {
  const TempFolder folder;
  made::write_scene_of(folder / "scene.xml", {made::small_shard()});
  const auto entries = [&] { return std::distance(std::filesystem::directory_iterator(folder.path()), {}); };
  {
    const SmallDisk disk(5000);
    EXPECT_THROW(export_3dtiles(folder / "scene.xml", 0, folder / "out"), InputError);
  }
  EXPECT_THROW(export_3dtiles(folder / "scene.xml", 2, folder / "out"), InputError);
  std::filesystem::resize_file(folder / "shards/c_0_0_0.h5", 100);
  EXPECT_THROW(export_3dtiles(folder / "scene.xml", 0, folder / "out"), InputError);
  EXPECT_EQ(entries(), 2);
}

TEST(VoxelTileset, RefusesCellsTooFarApartForOneTree) {
  const TempFolder folder;
  const std::int64_t far = std::int64_t(1) << 40;
  made::write_scene_of(folder / "scene.xml", {made::shard_of({{{0, 0, 0}, {1, 1, 1, 1}, {}}}, {0, 0, 0}, 8),
                                              made::shard_of({{{far, 0, 0}, {1, 1, 1, 1}, {}}}, {far, 0, 0}, 8)});
  EXPECT_THROW(export_3dtiles(folder / "scene.xml", 0, folder / "out"), InputError);
}

}  // namespace
}  // namespace gigabake
