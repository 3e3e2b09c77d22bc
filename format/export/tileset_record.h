/// What an export leaves in its folder for the next one: of each tile, what it was made of and which bytes it is.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "format/export/voxel_grid.h"
#include "format/export/voxel_tiling.h"
#include "lattice/hash128.h"

namespace gigabake {

struct TileRecord {
  Hash128 made_of;  ///< the contents of the level in the shards that the tile and its padding lie in
  VoxelStatistics statistics;
  std::uint64_t bytes = 0;  ///< of the tile's file
  Hash128 checksum;         ///< of these bytes
  friend bool operator==(const TileRecord&, const TileRecord&) = default;
};
using TileRecords = std::map<TilePlace, TileRecord>;

struct TilesetRecord {
  std::string rule;  ///< all else that tiles depend on: two exports of one rule share tiles
  TileRecords tiles;
};

inline constexpr const char* record_name = "export.json";

/// What tiles of this scene, this tiling and this version of the tiles' format have in common.
std::string rule_of(const SceneHeader& scene, const VoxelTiling& tiling, const std::string& form);

std::string record_text(const TilesetRecord& record);
/// Errors  InputError: the folder is no export of ours, or its record is damaged: what to do.
TilesetRecord read_record(const std::filesystem::path& folder);

/// An update replaces the folder, so it must hold nothing but files of exports.
/// Errors  InputError: names the first other file.
void expect_only_exported_files(const std::filesystem::path& folder);

}  // namespace gigabake
