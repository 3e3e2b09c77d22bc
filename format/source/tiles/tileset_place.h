/// Place of a tileset on the earth: the root's place is compared with that of its content.
#pragma once

#include <optional>
#include <string>

#include "format/source/source_files.h"
#include "format/source/tiles/tileset.h"

namespace gigabake {

struct TilesetPlace {
  std::optional<Point<Ecef>> point;    ///< on the earth; none: a local frame
  std::optional<std::string> warning;  ///< the root states another place than that of the content
};

/// Returns the anchor of the root if some content is near it, else the centre of the content on the earth's surface.
/// A root's volume may contain the whole earth, be empty, or be an exporter's default.
/// Cost    Opens at most 16 contents. Reads all their vertices only if the bounds of none are near the anchor.
TilesetPlace tileset_place(const SourceFiles& files, const Tileset& tileset);

}  // namespace gigabake
