/// Makes tiles of the voxels of a scene and writes them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "format/export/gzip_pack.h"
#include "format/export/level_owners.h"
#include "format/export/made_levels.h"
#include "format/export/shard_levels.h"
#include "format/export/tileset_record.h"
#include "format/export/voxel_grid.h"
#include "format/export/voxel_tile.h"
#include "format/export/voxel_tileset.h"
#include "format/export/voxel_tiling.h"
#include "lattice/hash128.h"

namespace gigabake {

/// Scene metres of a tile, without its padding.
TileBox box_of(const VoxelTiling& tiling, const SceneHeader& scene, const TilePlace& tile);

/// What all threads share. Borrows.
struct TileSource {
  const PagedScene& scene;
  const LevelOwners& owners;
  const MadeLevels& made;
  const VoxelTiling& tiling;
  ShardLevels& levels;
  TilesetForm form;
};

/// One thread's. Tiles of neighbouring places after each other cost less.
class TileWriter {
 public:
  /// `target` is what messages name; tiles go below `folder`.
  TileWriter(const TileSource& source, std::filesystem::path target, std::filesystem::path folder);

  /// Returns the statistics of the tile's own voxels and its file's size and checksum; made_of is left out.
  /// Errors  InputError: damaged or missing shards, disk full.
  TileRecord write(const TilePlace& tile);
  /// The name of what the tile is made of: the same where its voxels and those around it are. None: of levels that are
  /// made here.
  std::optional<Hash128> made_of(const TilePlace& tile);
  /// Links or copies the same tile of an earlier export's folder. Returns false if that file is missing or is not the
  /// one of the record: then it must be written. Errors  InputError: it cannot be put here.
  bool take_over(const TilePlace& tile, const TileRecord& record, const std::filesystem::path& from);
  /// A tile without voxels.
  TileRecord write_empty(const TilePlace& tile);

 private:
  void fill(const TilePlace& tile);
  const std::vector<LevelOwner>& owners_near(const TilePlace& tile);
  TileRecord write_file(const TilePlace& tile);
  std::string name_of(const TilePlace& tile) const { return "tiles/" + path_of(tile) + ".glb"; }

  TileSource source_;
  std::filesystem::path target_, folder_;
  VoxelGrid grid_;
  GzipPacker packer_;
  std::vector<std::uint8_t> file_;         ///< before it is packed
  TilePlace block_{~std::uint32_t(0), 0};  ///< of 4³ tiles, whose owners are
  std::vector<LevelOwner> owners_;
};

}  // namespace gigabake
