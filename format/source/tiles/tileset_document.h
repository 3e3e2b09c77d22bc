/// The JSON of a tileset, read as a stream, so that a million tiles do not need the memory of a million JSON values.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/math/frames.h"
#include "format/source/source_file.h"
#include "format/source/tiles/bounding_volume.h"
#include "format/source/tiles/implicit_tiling.h"

namespace gigabake {

enum class Refine : std::uint8_t { add, replace };

struct TilesetTile {
  std::vector<TilesetTile> children;
  std::uint64_t bad_children = 0;  ///< number of entries of `children` that are not tiles
  std::vector<std::string> uris;   ///< URIs of its contents, templates in an implicit tile; empty if missing
  std::unique_ptr<const Affine<World, World>> world_from_tile;  ///< the transform of only this tile; null: none
  std::unique_ptr<const ImplicitTiling> implicit;               ///< null: an explicit tile
  std::unique_ptr<const BoundingVolume> volume;                 ///< null: not requested, missing or malformed
  std::optional<Refine> refine;
  std::unique_ptr<const std::string> fault;  ///< why this tile and the tiles below cannot be used, or null
};

/// Returns the URIs of the contents of a tile and of all tiles below it.
std::vector<std::string> uris_below(const TilesetTile& tile);
/// Returns the number of files that may hold the surface of a tile or of the tiles below it. Point clouds do not count.
std::uint64_t contents_below(const TilesetTile& tile);

struct TilesetDocument {
  Json json;                        ///< without the root's children
  std::optional<TilesetTile> root;  ///< nullopt if the document is no tileset: it has no "root"
};

/// The members of tiles that parse_tileset() keeps.
enum class TileMembers : std::uint8_t { without_volumes, all };

/// Parses `file`, a tileset or another JSON.
/// Errors  InputError like parse_json(). Also if the tiles exceed memory_limit(). A malformed member of a tile is no
///         error, but sets the `fault` of the tile.
TilesetDocument parse_tileset(const std::filesystem::path& file, std::span<const std::uint8_t> text,
                              const Progress& progress = {}, TileMembers members = TileMembers::without_volumes);

}  // namespace gigabake
