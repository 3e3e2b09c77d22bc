/// Place on the earth that the root of a tileset states.
#pragma once

#include <filesystem>
#include <optional>

#include "core/math/frames.h"
#include "format/source/source_file.h"

namespace gigabake {

/// Returns the origin of the root tile's transform; else the centre of its bounding volume. Returns nullopt if neither
/// is at the surface of the WGS84 earth. A bounding region is always on the earth.
/// Errors  InputError(file, "root…"): the transform or the volume is malformed, or angles of a region are out of range.
std::optional<Point<Ecef>> tileset_anchor(const std::filesystem::path& file, const Json& root);

}  // namespace gigabake
