/// Where a tileset stands: what its root says is compared with where its content is.
#pragma once

#include <optional>
#include <string>

#include "format/source/source_files.h"
#include "format/source/tiles/tileset.h"

namespace gigabake {

struct TilesetPlace {
  std::optional<Point<Ecef>> point;    ///< on the earth; none: a local frame
  std::optional<std::string> warning;  ///< the root states another place than the content has
};

/// Returns the anchor of the root if some content is near it, else the centre of the content on the earth's surface.
/// A root's volume may contain the whole earth, be empty, or be a default that nobody has set.
/// Cost    Opens at most 16 contents. All their vertices are read only if none is where the root says.
TilesetPlace tileset_place(const SourceFiles& files, const Tileset& tileset);

}  // namespace gigabake
