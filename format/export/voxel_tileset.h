/// A scene as voxel 3D Tiles for CesiumJS.
#pragma once

#include <cstdint>
#include <filesystem>

#include "format/export/export_team.h"
#include "lattice/progress.h"

namespace gigabake {

/// tiles_1_1: 3DTILES_content_voxels and EXT_primitive_voxels, which CesiumJS reads.
/// gltf_2_1: 3DTILES_tileset_voxels and EXT_voxels, the draft that follows it.
enum class TilesetForm : std::uint8_t { tiles_1_1, gltf_2_1 };

struct TilesetOptions {
  int lod = 0;                    ///< the finest level
  std::uint32_t tile_voxels = 0;  ///< edge of a tile; 0: 80 to 112, as the scene's size asks for
  int threads = 1;                ///< of each rank
  bool update = false;            ///< of an earlier export of the folder: tiles that did not change stay as they are
  TilesetForm form = TilesetForm::tiles_1_1;
};

/// A new folder, or an archive of it where `target` ends in .3tz: tileset.json, one implicit oct-tree over the whole
/// scene (subtrees/), a packed binary glTF for each tile of each level from `lod` on (tiles/), up to one tile that
/// holds the scene, and a page that shows them (docs/format.md). Levels above the cells' are the parents'; only for
/// scenes without parents they are made. A scene with an origin stands on the earth.
/// With a team of several ranks each calls it, and `target` lies where all of them see it.
/// Exact   The same bytes for any number of ranks and threads, and for an update. Colours are the shards' bytes,
///         normals encode to them.
/// Cost    256 MiB of unpacked levels, 20 MiB a thread, 100 bytes a tile. An archive's tiles stand beside it meanwhile.
/// Errors  InputError: no such level, damaged shards, disk full, the target is there already; with update it is no
///         export. Nothing is left behind.
/// Returns the number of voxels of level `lod`.
std::uint64_t export_3dtiles(const std::filesystem::path& scene_xml, const TilesetOptions& options,
                             const std::filesystem::path& target, const Progress& progress = {},
                             const ExportTeam& team = {});

}  // namespace gigabake
