/// The JSON of a tileset, read as a stream: a list of a million tiles takes what tiles need, not what JSON does.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/source/source_file.h"
#include "format/source/tiles/implicit_tiling.h"
#include "lattice/frames.h"
#include "lattice/progress.h"

namespace gigabake {

enum class Refine : std::uint8_t { add, replace };

struct TilesetTile {
  std::vector<TilesetTile> children;
  std::vector<std::string> uris;  ///< of its contents; templates where the tile is implicit; empty where one is missing
  std::unique_ptr<const Affine<World, World>> world_from_tile;  ///< its own transform; null: none
  std::unique_ptr<const ImplicitTiling> implicit;               ///< null: an explicit tile
  std::optional<Refine> refine;
  std::unique_ptr<const std::string> fault;  ///< why it cannot be placed or read, with all below it; null: it can
};

struct TilesetDocument {
  Json json;                        ///< all of it but the root's children
  std::optional<TilesetTile> root;  ///< nothing where the document has no "root": it is no tileset
};

/// What `file` holds, be it a tileset or another JSON.
/// Errors  InputError, as parse_json(); what the tiles take is more than memory_limit() allows. A malformed member of a
///         tile is that tile's fault.
TilesetDocument parse_tileset(const std::filesystem::path& file, std::span<const std::uint8_t> text,
                              const Progress& progress = {});

}  // namespace gigabake
