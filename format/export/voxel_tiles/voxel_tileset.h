/// Export of a scene to voxel 3D Tiles for CesiumJS.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <utility>
#include <vector>

#include "core/base/progress.h"

namespace gigabake {

/// tiles_1_1: 3DTILES_content_voxels and EXT_primitive_voxels, which CesiumJS reads.
/// gltf_2_1: 3DTILES_tileset_voxels and EXT_voxels, the draft of their successors.
enum class TilesetForm : std::uint8_t { tiles_1_1, gltf_2_1 };

struct TilesetOptions {
  int lod = 0;                    ///< the finest exported level
  std::uint32_t tile_voxels = 0;  ///< edge of a tile; 0: 80 to 112, depending on the scene's size
  int threads = 1;                ///< per rank
  bool update = false;            ///< updates an earlier export in the folder: unchanged tiles are reused
  TilesetForm form = TilesetForm::tiles_1_1;
};

/// The processes that write one export together; the base class is a team of one process. Every
/// rank must call the same members in the same order, with the same steps.
class ExportTeam {
 public:
  virtual ~ExportTeam() = default;

  virtual int rank() const { return 0; }
  virtual int ranks() const { return 1; }
  /// Runs `step` on every rank.
  /// Errors  Thrown on every rank if the step fails on one.
  virtual void together(const std::function<void()>& step) const { step(); }
  /// Returns every rank's bytes, by rank, on every rank.
  virtual std::vector<std::vector<std::uint8_t>> exchange(std::vector<std::uint8_t> own) const {
    return {std::move(own)};
  }
};

/// Writes a new folder, or an archive if `target` ends in .3tz. It holds tileset.json, one implicit octree over the
/// whole scene (subtrees/), tiles (tiles/), and a page that displays them (docs/format.md). Returns the number of
/// voxels of level `lod`.
/// Each level from `lod` up has tiles (gzipped binary glTF), up to one tile that contains the scene. Levels above the
/// cells' come from overviews, or are derived if the scene has none. A scene with an origin is positioned on the earth.
/// If the team has several ranks, each must call this function, and all must be able to access `target`.
/// Exact   Same bytes for any number of ranks and threads, and for an update. Colours are the shards' bytes; normals
///         encode to the shards' bytes.
/// Cost    Memory: 256 MiB of unpacked levels, 20 MiB per thread, 100 bytes per tile. Disk: during the export, an
///         archive's tiles also exist as files next to it.
/// Errors  InputError: no such level, damaged shards, disk full, or the target exists; with update, the target is no
///         export. No file is left behind.
std::uint64_t export_3dtiles(const std::filesystem::path& scene_xml, const TilesetOptions& options,
                             const std::filesystem::path& target, const Progress& progress = {},
                             const ExportTeam& team = {});

}  // namespace gigabake
