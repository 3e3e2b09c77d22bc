/// Place of a tileset on the earth, from a comparison of the root with the content.
#pragma once

#include <optional>
#include <string>

#include "format/source/source_files.h"
#include "format/source/tiles/tileset.h"

namespace gigabake {

struct TilesetPlace {
  std::optional<Point<Ecef>> point;    ///< place on the earth; nullopt if the tileset has a local frame
  std::optional<std::string> warning;  ///< set if root and content are at different places
};

/// Returns the anchor of the root if some content is near it, else the centre of the content on the earth's surface.
/// The anchor must be compared with the content: the root's volume may contain the whole earth, be empty, or be an
/// exporter's default.
/// Cost    Opens at most 16 contents. Reads all their vertices only if the bounds of none are near the anchor.
TilesetPlace tileset_place(const SourceFiles& files, const Tileset& tileset);

}  // namespace gigabake
