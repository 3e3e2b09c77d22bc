/// 3D Tiles: which content files make up the finest surface of a tileset, and where they stand.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "format/source/source.h"
#include "format/source/source_file.h"
#include "format/source/source_files.h"
#include "format/source/tiles/tileset_document.h"

namespace gigabake {

/// A content file with all tile transforms from the root composed.
struct TilesetContent {
  std::filesystem::path path;
  ContentKind kind = ContentKind::glb;
  UpAxis gltf_up = UpAxis::y;
  Affine<World, World> world_from_tile;
  ByteRange range = {};  ///< in a composite
  std::string part;      ///< "[1]" there
  std::shared_ptr<const Archive> archive = nullptr;
};

struct Tileset {
  std::vector<TilesetContent> contents;  ///< in document order
  std::vector<SkippedSource> skipped;
  std::optional<Point<Ecef>> anchor;  ///< where its root says it stands, if that is on the WGS84 earth
};

/// Nested and external tilesets are followed, in archives too; implicit tiles are those that their subtrees call
/// available. With REPLACE a tile's content counts only where it has no finer one:
/// below; where a finer file is missing, the nearest ancestor's content stands in for all of its descendants, so that
/// no surface is there twice, and the missing file is listed.
/// `document`: what `file` holds.
/// A URI, a tile, a subtree or an external tileset that cannot be used costs only what it stands for, and is listed.
/// Errors  InputError: of the first tileset a version or a required extension that is not known; a cycle of external
///         tilesets or more than 2^24 tiles with them; more than 2^16 losses. Stopped.
Tileset open_tileset(const SourceFiles& files, const std::filesystem::path& file, const TilesetDocument& document,
                     const Progress& progress = {});

}  // namespace gigabake
