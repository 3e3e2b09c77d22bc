#include "format/export/voxel_tiles/voxel_tileset.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <libdeflate.h>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/error.h"
#include "core/math/octahedral.h"
#include "format/export/voxel_grid.h"
#include "format/export/voxel_tiles/md5.h"
#include "format/export/voxel_tiles/voxel_tiling.h"
#include "tests/format/scene/scene_voxels.h"
#include "tests/format/shard/made_shard.h"
#include "tests/format/system/small_disk.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using made::TempFolder;

struct TileVoxel {
  std::array<std::uint8_t, 4> rgba{}, normal{};
  VoxelClass voxel_class = no_class;
};
using TileVoxels = std::map<Vec3i64, TileVoxel>;

/// Returns the decompressed content of a gzip file with one member.
std::string unpacked(const std::string& packed) {
  std::uint32_t bytes = 0;
  std::memcpy(&bytes, packed.data() + packed.size() - 4, 4);
  std::string text(bytes, '\0');
  libdeflate_decompressor* unpacker = libdeflate_alloc_decompressor();
  const libdeflate_result result =
      libdeflate_gzip_decompress(unpacker, packed.data(), packed.size(), text.data(), bytes, nullptr);
  libdeflate_free_decompressor(unpacker);
  return result == LIBDEFLATE_SUCCESS ? text : std::string();
}

/// Returns the voxels of a tile and of its padding by their position in the level. Positions count from the lowest
/// corner of the octree.
TileVoxels read_tile(const std::filesystem::path& glb, const Vec3i64& tile, std::int64_t edge) {
  TileVoxels voxels;
  const std::string bytes = unpacked(made::bytes_of(glb));
  std::uint32_t json_bytes = 0;
  std::memcpy(&json_bytes, bytes.data() + 12, 4);
  const std::string binary = bytes.substr(20 + json_bytes + 8);
  const std::int64_t e = edge + 2;
  const auto grid = std::size_t(e * e * e);
  const bool has_classes = bytes.substr(20, json_bytes).find("\"voxel_class\"") != std::string::npos;
  EXPECT_EQ(binary.size(), (has_classes ? 12 : 8) * grid);
  for (std::int64_t z = 0; z < e; ++z)
    for (std::int64_t y = 0; y < e; ++y)
      for (std::int64_t x = 0; x < e; ++x) {
        const auto i = std::size_t(x + e * (z + e * (e - 1 - y)));
        TileVoxel voxel;
        std::memcpy(voxel.rgba.data(), binary.data() + 4 * i, 4);
        std::memcpy(voxel.normal.data(), binary.data() + 4 * grid + 4 * i, 4);
        float voxel_class = 0;
        if (has_classes) std::memcpy(&voxel_class, binary.data() + 8 * grid + 4 * i, 4);
        voxel.voxel_class = VoxelClass(voxel_class);
        if ((voxel.normal[3] == 255) != (voxel.rgba[3] != 0)) ADD_FAILURE() << glb;
        if (voxel.rgba[3] != 0)
          voxels[{edge * tile[0] + x - 1, edge * tile[1] + y - 1, edge * tile[2] + z - 1}] = voxel;
      }
  return voxels;
}

/// Returns every tile of a level, by its position.
std::map<Vec3i64, TileVoxels> read_level(const std::filesystem::path& folder, std::size_t level, std::int64_t edge) {
  std::map<Vec3i64, TileVoxels> tiles;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "tiles" / std::to_string(level))) {
    if (!entry.is_regular_file()) continue;
    const std::filesystem::path p = entry.path();
    const Vec3i64 at{std::stoll(p.parent_path().parent_path().filename().string()),
                     std::stoll(p.parent_path().filename().string()), std::stoll(p.stem().string())};
    tiles[at] = read_tile(p, at, edge);
  }
  return tiles;
}

/// Returns the voxels of a level without the tiles' padding, so that each voxel occurs once.
TileVoxels own_voxels(const std::filesystem::path& folder, std::size_t level, std::int64_t edge) {
  TileVoxels all;
  for (const auto& [tile, voxels] : read_level(folder, level, edge))
    for (const auto& [at, voxel] : voxels)
      if (at[0] / edge == tile[0] && at[1] / edge == tile[1] && at[2] / edge == tile[2] &&
          *std::min_element(at.begin(), at.end()) >= 0)
        all[at] = voxel;
  return all;
}

struct Tree {
  explicit Tree(const std::filesystem::path& folder)
      : root(nlohmann::json::parse(made::bytes_of(folder / "tileset.json"))["root"]),
        levels(root["implicitTiling"]["availableLevels"]),
        box(root["boundingVolume"]["box"]) {}

  /// Returns the position of the tree's corner on the lattice, in voxels of `voxel_m` metres.
  Vec3i64 corner(const SceneDescription& scene, double voxel_m) const {
    return Vec3i64::by_axis(
        [&](std::size_t c) { return std::llround((box[c] - box[3] - scene.lattice_origin_m[c]) / voxel_m); });
  }

  nlohmann::json root;
  std::size_t levels;
  std::vector<double> box;
};

Vec3i64 tile_of(const Vec3i64& at, std::int64_t edge) {
  const auto of = [edge](std::int64_t x) { return x < 0 ? -1 : x / edge; };
  return {of(at[0]), of(at[1]), of(at[2])};
}

bool is_of(const TileVoxel& voxel, const made::VoxelBytes& shards, bool has_normals) {
  const auto normal = has_normals ? normal_bytes(shards.normal.data()) : std::array<std::uint8_t, 3>{128, 128, 128};
  return voxel.rgba == shards.rgba && voxel.voxel_class == shards.voxel_class &&
         std::equal(normal.begin(), normal.end(), voxel.normal.begin());
}

/// Returns the number of voxels in the padding of tiles. A voxel counts once per adjacent tile of the cube.
std::size_t padding_of(const made::SceneVoxels& voxels, std::size_t level, std::int64_t edge) {
  const auto is_in_cube = [last = (std::int64_t(1) << level) - 1](const Vec3i64& tile) {
    return *std::min_element(tile.begin(), tile.end()) >= 0 && *std::max_element(tile.begin(), tile.end()) <= last;
  };
  std::size_t count = 0;
  for (const auto& [at, voxel] : voxels) {
    std::set<Vec3i64> near;
    for (int way = 0; way < 27; ++way)
      near.insert(tile_of({at[0] + way % 3 - 1, at[1] + way / 3 % 3 - 1, at[2] + way / 9 - 1}, edge));
    near.erase(tile_of(at, edge));
    count += std::size_t(std::count_if(near.begin(), near.end(), is_in_cube));
  }
  return count;
}

TEST(VoxelTileset, TilesAndTheVoxelsAroundThemAreThoseOfTheShards) {
  for (int round = 0; round < 4; ++round) {
    const made::RandomScene scene(round, true);
    const SceneDescription& written = scene.description();
    const int finest = round % 2;
    const std::int64_t edge = std::array{13, 20, 31, 40}[std::size_t(round)];
    TilesetOptions options;
    options.lod = finest;
    options.tile_voxels = std::uint32_t(edge);
    EXPECT_EQ(export_3dtiles(scene.xml(), options, scene / "out"), scene.voxels(finest).size());
    const Tree tree(scene / "out");
    for (int lod = finest; lod < 4 && lod - finest < int(tree.levels); ++lod) {
      const Vec3i64 corner = tree.corner(written, std::ldexp(written.voxel_size_m, lod));
      made::SceneVoxels expected;
      for (const auto& [at, voxel] : scene.voxels(lod))
        expected[{at[0] - corner[0], at[1] - corner[1], at[2] - corner[2]}] = voxel;
      TileVoxels own;
      std::size_t wrong = 0, of_padding = 0;
      const std::size_t level = tree.levels - 1 - std::size_t(lod - finest);
      for (const auto& [tile, voxels] : read_level(scene / "out", level, edge))
        for (const auto& [at, voxel] : voxels) {
          const auto shards = expected.find(at);
          wrong += shards == expected.end() || !is_of(voxel, shards->second, written.has_normals) ? 1 : 0;
          if (tile_of(at, edge) == tile)
            own[at] = voxel;
          else
            ++of_padding;
        }
      EXPECT_EQ(wrong, 0u);
      EXPECT_EQ(own.size(), expected.size());
      EXPECT_EQ(of_padding, padding_of(expected, level, edge));
    }
  }
}

TEST(VoxelTileset, NormalsEncodeToTheShardsTwoBytes) {
  for (int code = 0; code < 255 * 255; ++code) {
    const std::int8_t oct[2] = {std::int8_t(code % 255 - 127), std::int8_t(code / 255 - 127)};
    const std::array<std::uint8_t, 3> bytes = normal_bytes(oct);
    double n[3];
    decode_octahedral(oct, n);
    std::int8_t expected[2], back[2];
    encode_octahedral(n[0], n[1], n[2], expected);  // on the folds of the octahedron two codes have one direction
    encode_octahedral((bytes[0] - 128) / 127.0, (bytes[1] - 128) / 127.0, (bytes[2] - 128) / 127.0, back);
    ASSERT_TRUE(back[0] == expected[0] && back[1] == expected[1]) << int(oct[0]) << ' ' << int(oct[1]);
  }
}

TEST(VoxelTileset, IsTheSameForAnyNumberOfThreads) {
  const made::RandomScene scene(1);
  TilesetOptions options;
  options.tile_voxels = 24;
  export_3dtiles(scene.xml(), options, scene / "one");
  options.threads = 3;
  export_3dtiles(scene.xml(), options, scene / "three");
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(scene / "one")) {
    if (!entry.is_regular_file()) continue;
    ++files;
    const auto name = entry.path().lexically_relative(scene / "one");
    EXPECT_EQ(made::bytes_of(entry.path()), made::bytes_of(scene / "three" / name)) << name;
  }
  EXPECT_GT(files, 4u);
}

/// The tree's cube contains a scene of any size. The cube is at most 1.5 times as wide as the scene's longest side,
/// plus three voxels of the root.
TEST(VoxelTileset, TheCubeFitsTheScene) {
  std::mt19937_64 rng(test::RandomSeed{});
  for (int round = 0; round < 2000; ++round) {
    Box3i64 bounds;
    const std::int64_t maximum = std::int64_t(1) << (1 + rng() % 30);
    for (std::size_t c = 0; c < 3; ++c) {
      bounds.min[c] = std::int64_t(rng() % 2000000) - 1000000;
      bounds.end[c] = bounds.min[c] + 1 + std::int64_t(rng() % std::uint64_t(maximum));
    }
    const int finest = int(rng() % 4);
    const VoxelTiling tiling = tiling_of(bounds, finest, 0);
    const std::int64_t root_voxel = std::int64_t(1) << tiling.coarsest(), cube = root_voxel * tiling.edge;
    std::int64_t max_edge = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      ASSERT_LE(tiling.corner[c], bounds.min[c]);
      ASSERT_GE(tiling.corner[c] + cube, bounds.end[c]);
      ASSERT_EQ(tiling.corner[c] % root_voxel, 0);
      max_edge = std::max(max_edge, bounds.end[c] - bounds.min[c]);
    }
    ASSERT_LE(tiling.edge, 112u);
    ASSERT_LE(double(cube), 1.5 * double(max_edge) + 3.0 * double(root_voxel));
  }
}

TEST(VoxelTileset, LevelsAboveTheCellsHaveAVoxelWhereTheLevelBelowHasOne) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  made::write_random_scene(folder / "scene.xml", rng, true, true);
  TilesetOptions options;
  options.lod = 3;
  options.tile_voxels = 8;
  export_3dtiles(folder / "scene.xml", options, folder / "out");
  const Tree tree(folder / "out");
  const std::size_t levels = tree.levels;
  ASSERT_GT(levels, 1u);
  TileVoxels below = own_voxels(folder / "out", levels - 1, 8);
  for (std::size_t level = levels - 1; level-- > 0;) {
    std::map<Vec3i64, std::array<std::uint32_t, 2>> span;  // min and max red of the children
    std::map<Vec3i64, std::map<VoxelClass, std::uint32_t>> weights;
    for (const auto& [at, voxel] : below) {
      const auto [entry, first] = span.insert({{at[0] >> 1, at[1] >> 1, at[2] >> 1}, {255, 0}});
      entry->second = {std::min(entry->second[0], std::uint32_t(voxel.rgba[0])),
                       std::max(entry->second[1], std::uint32_t(voxel.rgba[0]))};
      weights[entry->first][voxel.voxel_class] += voxel.rgba[3];
    }
    const TileVoxels own = own_voxels(folder / "out", level, 8);
    ASSERT_EQ(own.size(), span.size());
    for (const auto& [at, voxel] : own) {
      ASSERT_TRUE(span.contains(at));
      EXPECT_GE(voxel.rgba[0], span.at(at)[0]);
      EXPECT_LE(voxel.rgba[0], span.at(at)[1]);
      for (const auto& [other, weight] : weights.at(at)) {
        const std::uint32_t own_weight = weights.at(at)[voxel.voxel_class];
        EXPECT_TRUE(weight < own_weight || (weight == own_weight && voxel.voxel_class <= other));
      }
    }
    below = own;
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "out/tiles/0/0/0/0.glb"));
}

TEST(VoxelTileset, IsNotWrittenWhereAShardIsDamagedOrTheDiskIsFull) {
  const TempFolder folder;
  made::write_scene_of(folder / "scene.xml", {made::small_shard()});
  const auto entries = [&] { return std::distance(std::filesystem::directory_iterator(folder.path()), {}); };
  TilesetOptions no_level;
  no_level.lod = 2;
  {
    const SmallDisk disk(500);
    EXPECT_THROW(export_3dtiles(folder / "scene.xml", {}, folder / "out"), InputError);
  }
  EXPECT_THROW(export_3dtiles(folder / "scene.xml", no_level, folder / "out"), InputError);
  std::filesystem::resize_file(folder / "shards/c_0_0_0.h5", 100);
  EXPECT_THROW(export_3dtiles(folder / "scene.xml", {}, folder / "out"), InputError);
  EXPECT_EQ(entries(), 2);
}

TEST(Md5, IsThatOfTheRfc) {
  const auto hex = [](std::string_view text) {
    std::string digits;
    for (const std::uint8_t b : md5_of(text)) {
      digits += "0123456789abcdef"[b >> 4];
      digits += "0123456789abcdef"[b & 15];
    }
    return digits;
  };
  EXPECT_EQ(hex(""), "d41d8cd98f00b204e9800998ecf8427e");
  EXPECT_EQ(hex("abc"), "900150983cd24fb0d6963f7d28e17f72");
  EXPECT_EQ(hex("12345678901234567890123456789012345678901234567890123456789012345678901234567890"),
            "57edf4a22be3c955ac49da2e2107b67a");
}

TEST(VoxelTileset, RefusesCellsTooFarApartForOneTree) {
  const TempFolder folder;
  const std::int64_t far = std::int64_t(1) << 40;
  made::write_scene_of(folder / "scene.xml", {made::shard_of({{{0, 0, 0}, {1, 1, 1, 1}, {}}}, {0, 0, 0}, 8),
                                              made::shard_of({{{far, 0, 0}, {1, 1, 1, 1}, {}}}, {far, 0, 0}, 8)});
  EXPECT_THROW(export_3dtiles(folder / "scene.xml", {}, folder / "out"), InputError);
}

}  // namespace
}  // namespace gigabake
