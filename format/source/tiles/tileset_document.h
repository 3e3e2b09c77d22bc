/// The JSON of a tileset, read as a stream: a million tiles need the memory of tiles, not that of JSON values.
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
#include "format/source/tiles/implicit_tiling.h"

namespace gigabake {

enum class Refine : std::uint8_t { add, replace };

struct TilesetTile {
  std::vector<TilesetTile> children;
  std::uint64_t bad_children = 0;  ///< entries of `children` that are not tiles
  std::vector<std::string> uris;   ///< of its contents; templates if the tile is implicit; empty if one is missing
  std::unique_ptr<const Affine<World, World>> world_from_tile;  ///< its own transform; null: none
  std::unique_ptr<const ImplicitTiling> implicit;               ///< null: an explicit tile
  std::optional<Refine> refine;
  std::unique_ptr<const std::string> fault;  ///< why it cannot be placed or read, with all tiles below it; null: it can
};

struct TilesetDocument {
  Json json;                        ///< without the root's children
  std::optional<TilesetTile> root;  ///< nullopt if the document has no "root": it is no tileset
};

/// Parses `file`, a tileset or another JSON.
/// Errors  InputError, as parse_json(); the tiles need more than memory_limit(). A malformed member of a tile is a
///         fault of that tile.
TilesetDocument parse_tileset(const std::filesystem::path& file, std::span<const std::uint8_t> text,
                              const Progress& progress = {});

}  // namespace gigabake
