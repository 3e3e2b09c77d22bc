/// Export of a scene to voxel 3D Tiles for CesiumJS.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <utility>
#include <vector>

#include "core/base/progress.h"

namespace gigabake {

/// The format of a tileset. `tiles_1_1` uses the extensions 3DTILES_content_voxels and EXT_primitive_voxels, which
/// CesiumJS reads. `gltf_2_1` uses 3DTILES_tileset_voxels and EXT_voxels, the drafts of their successors.
enum class TilesetForm : std::uint8_t { tiles_1_1, gltf_2_1 };

struct TilesetOptions {
  int lod = 0;                    ///< the finest exported level
  std::uint32_t tile_voxels = 0;  ///< edge of a tile in voxels; 0: 80 to 112, depending on the scene's size
  int threads = 1;                ///< threads per rank
  bool update = false;            ///< updates an earlier export in the folder: unchanged tiles are reused
  TilesetForm form = TilesetForm::tiles_1_1;
};

/// The processes (ranks) that write one export together. The base class is a team of one process. Every rank must call
/// the same members in the same order, with steps of the same purpose.
class ExportTeam {
 public:
  virtual ~ExportTeam() = default;

  virtual int rank() const { return 0; }
  virtual int ranks() const { return 1; }
  /// Runs `step` on every rank.
  /// Errors  If the step throws on one rank, an exception is thrown on every rank.
  virtual void together(const std::function<void()>& step) const { step(); }
  /// Returns the bytes of all ranks, ordered by rank, on every rank. `own` has the bytes of the calling rank.
  virtual std::vector<std::vector<std::uint8_t>> exchange(std::vector<std::uint8_t> own) const {
    return {std::move(own)};
  }
  /// Returns the bytes of all ranks, ordered by rank, on rank 0; nothing on the other ranks.
  virtual std::vector<std::vector<std::uint8_t>> collect(std::vector<std::uint8_t> own) const {
    return {std::move(own)};
  }
};

/// Writes a new folder, or an archive if `target` ends in .3tz. It contains tileset.json, one implicit octree over the
/// whole scene (subtrees/), and tiles (tiles/). A folder also has a web page that displays the tiles, and a record for
/// updates (docs/format.md). Returns the number of voxels of level `lod`.
/// Each level from `lod` up has tiles (gzipped binary glTF), up to one tile that contains the scene. Levels coarser
/// than the cells' levels come from overviews. They are derived if the scene has no overviews. A scene with an origin
/// is positioned on the earth. If the team has several ranks, each must call this function, and all must be able to
/// access `target`.
/// Exact   Same bytes for any number of ranks and threads, and for an update. Colours are the shards' bytes; normals
///         encode to the bytes of the shards.
/// Cost    Memory: 256 MiB of unpacked levels, 20 MiB per thread, 100 bytes per tile. Disk: while an archive is
///         written, its tiles also exist as files next to it.
/// Errors  InputError: the level does not exist, a shard is damaged, the disk is full, or `target` is an existing
///         folder or file. An update requires an existing export instead. No file is left behind.
std::uint64_t export_3dtiles(const std::filesystem::path& scene_xml, const TilesetOptions& options,
                             const std::filesystem::path& target, const Progress& progress = {},
                             const ExportTeam& team = {});

}  // namespace gigabake
