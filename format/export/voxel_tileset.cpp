#include "format/export/voxel_tileset.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <optional>

#include "format/export/implicit_octree.h"
#include "format/export/voxel_tile.h"
#include "format/shard/brick_walk.h"
#include "format/system/output_file.h"
#include "format/system/publish_folder.h"
#include "lattice/error.h"
#include "lattice/georeference.h"
#include "lattice/morton.h"

namespace gigabake {
namespace {

using Json = nlohmann::ordered_json;
using Keys = std::vector<std::uint64_t>;

/// The cube that the oct-tree divides.
struct TilesetCube {
  LevelIndex lowest{};           ///< voxels of level 0; a multiple of the edge of a tile of `coarsest`
  int finest = 0, coarsest = 0;  ///< the levels that come from shards
  std::int64_t corners = 0;      ///< bits that are set in a cell's corner
  std::uint32_t levels = 0;      ///< of tiles: 0 is the root, levels − 1 is `finest`

  int lod(std::uint32_t tile_level) const { return finest + int(levels - 1 - tile_level); }
  std::uint32_t tile_level(int lod) const { return levels - 1 - std::uint32_t(lod - finest); }
  std::int64_t tile_edge(int lod) const { return std::int64_t(brick_edge) << lod; }
};

/// Errors  InputError: farther apart than a tile's number can say.
TilesetCube cube_of(const PagedScene& scene, int lod) {
  TilesetCube cube;
  cube.finest = lod;
  cube.coarsest = 62;
  scene.for_each_cell([&cube](const SceneCell& cell) {
    cube.coarsest = std::min(cube.coarsest, int(cell.lods) - 1);
    for (const std::int64_t x : cell.lattice_min) cube.corners |= x;
  });
  const auto [low, high] = scene.totals().window;
  const std::int64_t edge = cube.tile_edge(cube.coarsest);
  std::uint64_t tiles = 1;
  for (std::size_t c = 0; c < 3; ++c) {
    cube.lowest[c] = low[c] & -edge;
    tiles = std::max(tiles, std::uint64_t(high[c] - cube.lowest[c] + edge - 1) / std::uint64_t(edge));
  }
  const int above = std::bit_width(tiles - 1);
  cube.levels = std::uint32_t(cube.coarsest - cube.finest + above + 1);
  constexpr std::uint32_t most_levels = 21;  // bits of a place in a Morton code
  if (cube.levels > most_levels)
    throw InputError(scene.file(), "LatticeMin", "cells lie too far apart for one oct-tree");
  return cube;
}

class TilesetWriter {
 public:
  TilesetWriter(const std::filesystem::path& target, const std::filesystem::path& folder, const PagedScene& scene,
                const TilesetCube& cube, const Progress& progress)
      : target_(target),
        folder_(folder),
        scene_(scene),
        cube_(cube),
        progress_(progress),
        files_(target, folder, scene.header().has_normals),
        tiles_(cube.levels) {}

  /// The tiles of a level that the shards have.
  void write_level(int lod) {
    progress_.step(fmt::format("writing the tiles of lod {}", lod), voxels_of_level(scene_, lod));
    Keys& keys = tiles_[cube_.tile_level(lod)];
    const bool shared = (cube_.corners >> lod & 7) != 0;  // whether a tile can be of several bricks
    const auto add = [&](const LevelIndex& lowest, const DenseBrick& part) {
      const BrickCoordinate at{tile_place(lowest, 0, lod), tile_place(lowest, 1, lod), tile_place(lowest, 2, lod)};
      const std::uint64_t key = morton(at.x, at.y, at.z);
      VoxelTile tile;
      if (shared) files_.read(name(cube_.tile_level(lod), key), tile);
      add_voxels(tile, part, scene_.header().has_normals);
      write(cube_.tile_level(lod), key, tile);
      keys.push_back(key);
    };
    for_each_block_part(scene_, lod, add, progress_);
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    add_missing_parents(cube_.tile_level(lod));
  }

  /// The tiles above those, each of eight.
  void write_coarser_level(std::uint32_t level) {
    const Keys& below = tiles_[level + 1];
    progress_.step("writing coarser tiles", below.size());
    for (std::size_t i = 0; i < below.size();) {
      const std::size_t first = i;
      const std::uint64_t key = below[i] >> 3;
      std::array<std::optional<VoxelTile>, 8> read;
      std::array<const VoxelTile*, 8> children{};
      for (; i < below.size() && below[i] >> 3 == key; ++i) {
        VoxelTile& child = read[below[i] & 7].emplace();
        files_.read(name(level + 1, below[i]), child);
        children[below[i] & 7] = &child;
      }
      write(level, key, coarser_tile(children));
      tiles_[level].push_back(key);
      progress_.advance(i - first);
    }
  }

  void write_subtrees() const {
    for (std::uint32_t level = 0; level < tiles_.size(); level += subtree_levels)
      for (const std::uint64_t root : tiles_[level]) {
        progress_.advance(0);
        OutputFile out(target_, folder_ / ("subtrees/" + place(level, root) + ".subtree"));
        out.write(subtree_file(tiles_, level, root));
        out.finish();
      }
  }

  void write_tileset() const {
    OutputFile out(target_, folder_ / "tileset.json");
    out.write(tileset().dump(2) + "\n");
    out.finish();
  }

 private:
  std::uint32_t tile_place(const LevelIndex& lowest, std::size_t axis, int lod) const {
    return std::uint32_t((lowest[axis] - (cube_.lowest[axis] >> lod)) / brick_edge);
  }
  static std::string place(std::uint32_t level, std::uint64_t key) {
    const BrickCoordinate at = demorton(key);
    return fmt::format("{}/{}/{}/{}", level, at.x, at.y, at.z);
  }
  static std::string name(std::uint32_t level, std::uint64_t key) { return "tiles/" + place(level, key) + ".glb"; }

  double edge_m(std::uint32_t level) const {
    return double(cube_.tile_edge(cube_.lod(level))) * scene_.header().voxel_size_m;
  }
  std::array<double, 3> corner_m() const {
    std::array<double, 3> corner{};
    for (std::size_t c = 0; c < 3; ++c)
      corner[c] = scene_.header().lattice_origin_m[c] + double(cube_.lowest[c]) * scene_.header().voxel_size_m;
    return corner;
  }

  void write(std::uint32_t level, std::uint64_t key, const VoxelTile& tile) const {
    const BrickCoordinate at = demorton(key);
    TileBox box{corner_m(), edge_m(level)};
    const std::array<std::uint32_t, 3> number{at.x, at.y, at.z};
    for (std::size_t c = 0; c < 3; ++c) box.centre_m[c] += (number[c] + 0.5) * box.edge_m;
    files_.write(name(level, key), tile, box);
  }

  /// A tile whose level has no voxel in it, but the level below has: a tree has no such gaps.
  void add_missing_parents(std::uint32_t level) {
    if (level + 1 >= tiles_.size()) return;
    Keys& keys = tiles_[level];
    const std::size_t own = keys.size();
    for (const std::uint64_t child : tiles_[level + 1]) {
      const std::uint64_t key = child >> 3;
      if (std::binary_search(keys.begin(), keys.begin() + std::ptrdiff_t(own), key)) continue;
      if (keys.size() > own && keys.back() == key) continue;
      write(level, key, VoxelTile());
      keys.push_back(key);
    }
    std::inplace_merge(keys.begin(), keys.begin() + std::ptrdiff_t(own), keys.end());
  }

  Json voxel_class() const {
    Json properties;
    if (scene_.header().has_normals) properties["normal"] = {{"type", "VEC3"}, {"componentType", "FLOAT32"}};
    properties["color"] = {{"type", "VEC4"}, {"componentType", "UINT8"}, {"normalized", true}};
    return {{"properties", properties}};
  }

  Json root() const {
    const double half = edge_m(0) / 2;
    const std::array<double, 3> corner = corner_m();
    Json root = {
        {"boundingVolume",
         {{"box", {corner[0] + half, corner[1] + half, corner[2] + half, half, 0, 0, 0, half, 0, 0, 0, half}}}},
        {"geometricError", edge_m(0) / brick_edge},
        {"refine", "REPLACE"},
        {"content",
         {{"uri", "tiles/{level}/{x}/{y}/{z}.glb"},
          {"extensions", {{"3DTILES_content_voxels", {{"dimensions", {8, 8, 8}}, {"class", "voxel"}}}}}}},
        {"implicitTiling",
         {{"subdivisionScheme", "OCTREE"},
          {"subtreeLevels", subtree_levels},
          {"availableLevels", tiles_.size()},
          {"subtrees", {{"uri", "subtrees/{level}/{x}/{y}/{z}.subtree"}}}}}};
    if (scene_.header().origin) {
      const Affine<Ecef, Scene> ecef = ecef_from_enu(*scene_.header().origin);
      Json columns = Json::array();
      for (std::size_t column = 0; column < 4; ++column) {
        for (std::size_t row = 0; row < 3; ++row) columns.push_back(ecef.m[row][column]);
        columns.push_back(column == 3 ? 1.0 : 0.0);
      }
      root["transform"] = columns;
    }
    return root;
  }

  Json tileset() const {
    std::uint64_t count = 0;
    for (const Keys& keys : tiles_) count += keys.size();
    const Json tile_count = {{"type", "SCALAR"}, {"componentType", "UINT32"}, {"semantic", "TILESET_TILE_COUNT"}};
    return {{"asset", {{"version", "1.1"}, {"generator", scene_.header().generator}}},
            {"extensionsUsed", {"3DTILES_content_voxels"}},
            {"extensionsRequired", {"3DTILES_content_voxels"}},
            {"schema",
             {{"id", "gigabake"},
              {"classes", {{"voxel", voxel_class()}, {"tileset", {{"properties", {{"tileCount", tile_count}}}}}}}}},
            {"metadata", {{"class", "tileset"}, {"properties", {{"tileCount", count}}}}},
            {"geometricError", 2 * edge_m(0) / brick_edge},
            {"root", root()}};
  }

  const std::filesystem::path& target_;
  const std::filesystem::path& folder_;
  const PagedScene& scene_;
  TilesetCube cube_;
  const Progress& progress_;
  VoxelTileFiles files_;
  TileLevels tiles_;
};

}  // namespace

std::uint64_t export_3dtiles(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& folder,
                             const Progress& progress) {
  const auto [scene, voxels] = open_scene_level(scene_xml, lod);
  if (scene.totals().cells == 0) throw InputError(scene_xml, "PagedOctTree", "the scene has no cells");
  const TilesetCube cube = cube_of(scene, lod);
  FolderPublication publication(folder);
  TilesetWriter writer(publication.target(), publication.aside(), scene, cube, progress);
  for (int level = lod; level <= cube.coarsest; ++level) writer.write_level(level);
  for (std::uint32_t level = cube.tile_level(cube.coarsest); level > 0; --level) writer.write_coarser_level(level - 1);
  writer.write_subtrees();
  writer.write_tileset();
  publication.publish();
  return voxels;
}

}  // namespace gigabake
