/// Does the root of a tileset say that it stands on the earth, and where?
#pragma once

#include <filesystem>
#include <optional>

#include "format/source/source_file.h"
#include "lattice/frames.h"

namespace gigabake {

/// Where the root tile's transform puts its origin; else the centre of its bounding volume; nothing where neither is at
/// the surface of the WGS84 earth. A bounding region is always on the earth.
/// Errors  InputError(file, "root…"): malformed transform or volume, a region beyond the poles.
std::optional<Point<Ecef>> tileset_anchor(const std::filesystem::path& file, const Json& root);

}  // namespace gigabake
