/// Writer of a scene's voxels as tiles.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/io/hash128.h"
#include "format/export/derived_levels.h"
#include "format/export/level_owners.h"
#include "format/export/shard_levels.h"
#include "format/export/voxel_grid.h"
#include "format/export/voxel_tiles/gzip_pack.h"
#include "format/export/voxel_tiles/tileset_record.h"
#include "format/export/voxel_tiles/voxel_tile.h"
#include "format/export/voxel_tiles/voxel_tileset.h"
#include "format/export/voxel_tiles/voxel_tiling.h"

namespace gigabake {

/// Returns the tile's box in scene metres, without padding.
TileBox box_of(const VoxelTiling& tiling, const SceneHeader& scene, const TilePlace& tile);

/// State shared by all threads. Borrows its members.
struct TileSource {
  const PagedScene& scene;
  const LevelOwners& owners;
  const DerivedLevels& made;
  const VoxelTiling& tiling;
  ShardLevels& levels;
  TilesetForm form;
};

/// Writer of tiles for one thread. It is faster if consecutive tiles are neighbours.
class TileWriter {
 public:
  /// Writes tiles below `folder`. Messages name `target`.
  TileWriter(const TileSource& source, std::filesystem::path target, std::filesystem::path folder);

  /// Writes the tile. Returns its record; only made_of is not set.
  /// Errors  InputError: a shard is damaged or missing, or the disk is full.
  TileRecord write(const TilePlace& tile);
  /// Returns a hash of the shards' contents from which the tile and its padding are made. Equal hashes mean equal
  /// tiles. Returns nullopt for derived levels.
  std::optional<Hash128> made_of(const TilePlace& tile);
  /// Links or copies the tile's file from `from`, the folder of an earlier export. Returns false if this file is
  /// missing or does not match the record; the caller must then write the tile.
  /// Errors  InputError: the tile cannot be written to the new folder.
  bool take_over(const TilePlace& tile, const TileRecord& record, const std::filesystem::path& from);
  /// Writes a tile without voxels.
  TileRecord write_empty(const TilePlace& tile);
  /// Reads the levels for a tile that a writer will write later (ShardLevels::read_ahead()).
  void read_ahead(const TilePlace& tile);

 private:
  /// The owners near the tiles of one block of 4³ tiles.
  struct BlockOwners {
    TilePlace block{~std::uint32_t(0), 0};
    std::vector<LevelOwner> owners;
  };

  void fill(const TilePlace& tile);
  template <class Visit>
  void for_each_shard_of(const TilePlace& tile, BlockOwners& near, const Visit& visit);
  const std::vector<LevelOwner>& owners_near(const TilePlace& tile, BlockOwners& near);
  TileRecord write_file(const TilePlace& tile);
  std::string name_of(const TilePlace& tile) const { return "tiles/" + path_of(tile) + ".glb"; }

  TileSource source_;
  std::filesystem::path target_, folder_;
  VoxelGrid grid_;
  GzipPacker packer_;
  std::vector<std::uint8_t> file_;  ///< content of the tile's file before compression
  BlockOwners near_, ahead_;        ///< of the last tile that was written, and read ahead
};

}  // namespace gigabake
