/// 3D Tiles: content files that make up the finest surface of a tileset, and their transforms.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "format/source/source.h"
#include "format/source/source_file.h"
#include "format/source/source_files.h"
#include "format/source/tiles/tileset_document.h"

namespace gigabake {

/// A content file with the product of all tile transforms from the root.
struct TilesetContent {
  std::filesystem::path path;
  ContentKind kind = ContentKind::glb;
  UpAxis gltf_up = UpAxis::y;
  Affine<World, World> world_from_tile;
  ByteRange range = {};  ///< in a composite
  std::string part;      ///< "[1]" in a composite
  std::shared_ptr<const Archive> archive = nullptr;
};

struct Tileset {
  std::vector<TilesetContent> contents;  ///< in document order
  std::vector<SkippedSource> skipped;
  std::optional<Point<Ecef>> anchor;  ///< place that the root states, if it is on the WGS84 earth
};

/// Opens a tileset. Nested and external tilesets are followed, also in archives; implicit tiles are those that their
/// subtrees mark as available. If a tile refines by REPLACE, its content counts only if there is no finer content below
/// it. If a finer file is missing, the nearest ancestor's content replaces all of its descendants, and the missing file
/// is listed: thus no surface is duplicated. `document`: the JSON of `file`.
/// A URI, tile, subtree or external tileset that cannot be used is listed; only its part of the tileset is missing.
/// Errors  InputError: the first tileset has an unknown version or required extension; external tilesets form a cycle.
///         Also: more than 2^24 tiles in all tilesets, more than 2^16 missing contents. Stopped.
Tileset open_tileset(const SourceFiles& files, const std::filesystem::path& file, const TilesetDocument& document,
                     const Progress& progress = {});

}  // namespace gigabake
