/// 3D Tiles: content files that make up the finest surface of a tileset, and their transforms.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "format/source/source.h"
#include "format/source/source_file.h"
#include "format/source/source_files.h"
#include "format/source/tiles/bounding_volume.h"
#include "format/source/tiles/tileset_document.h"

namespace gigabake {

/// A content file with the product of all tile transforms from the root.
struct TilesetContent {
  std::filesystem::path path;
  ContentKind kind = ContentKind::glb;
  UpAxis gltf_up = UpAxis::y;
  Affine<World, World> world_from_tile;
  ByteRange range = {};  ///< bytes of a tile in a composite
  std::string part;      ///< "[1]" in a composite
  std::shared_ptr<const Archive> archive = nullptr;
};

struct Tileset {
  std::vector<TilesetContent> contents;  ///< in document order
  std::vector<SkippedSource> skipped;
  std::optional<Point<Ecef>> anchor;  ///< place that the root states, if it is on the WGS84 earth
  std::uint64_t outside = 0;          ///< contents that were not opened, because their tiles are outside the area
};

/// Makes the filter for an area of interest from the anchor of the tileset. Empty without an area.
using MakeVolumeFilter = std::function<VolumeFilter(const std::optional<Point<Ecef>>& anchor)>;

/// Opens a tileset. Follows nested and external tilesets, also in archives. An implicit tile exists if its subtree
/// marks it as available. If a tile refines by REPLACE, its content counts only if there is no finer content below it.
/// If a finer file is missing, the file is listed as skipped. The content of the nearest ancestor then replaces all
/// descendants of this ancestor, so that no surface is duplicated. `document` is the parsed `file`.
/// A URI, tile, subtree or external tileset that cannot be used is listed as skipped. Only its part of the tileset is
/// missing.
/// The files of a tile that the filter excludes are not opened, nor the files of tiles below it. If there is a filter,
/// the document must have volumes.
/// Errors  InputError: the first tileset has an unknown version or required extension, or external tilesets form a
///         cycle. Also if there are more than 2^24 tiles in all tilesets, or more than 2^16 skipped contents. Stopped:
///         the caller cancelled the step.
Tileset open_tileset(const SourceFiles& files, const std::filesystem::path& file, const TilesetDocument& document,
                     const MakeVolumeFilter& make_filter = {}, const Progress& progress = {});

}  // namespace gigabake
