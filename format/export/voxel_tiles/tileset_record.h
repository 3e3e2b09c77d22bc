/// The record that an export writes to its folder: the inputs and the checksum of each tile. The next update of the
/// folder reads it.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "core/io/hash128.h"
#include "format/export/voxel_grid.h"
#include "format/export/voxel_tiles/voxel_tiling.h"

namespace gigabake {

struct TileRecord {
  Hash128 made_of;  ///< hash of the level's contents in the shards that the tile and its padding overlap
  VoxelStatistics statistics;
  std::uint64_t bytes = 0;  ///< size of the tile's file
  Hash128 checksum;         ///< checksum of the tile's file
  friend bool operator==(const TileRecord&, const TileRecord&) = default;
};
using TileRecords = std::map<TilePlace, TileRecord>;

struct TilesetRecord {
  std::string rule;  ///< all other inputs of tiles: exports with the same rule can share tiles
  TileRecords tiles;
};

inline constexpr const char* record_name = "export.json";

/// Returns the inputs that all tiles of an export share, as text: scene frame, tiling and form.
std::string rule_of(const SceneHeader& scene, const VoxelTiling& tiling, const std::string& form);

std::string record_text(const TilesetRecord& record);
/// Reads a folder's record. Returns an empty record if it has another version.
/// Errors  InputError naming the remedy: the folder is not an export of gigabake, or its record is damaged.
TilesetRecord read_record(const std::filesystem::path& folder);

/// Checks that the folder contains only files of exports, because an update replaces the folder.
/// Errors  InputError naming the first file that no export wrote.
void expect_only_exported_files(const std::filesystem::path& folder);

}  // namespace gigabake
