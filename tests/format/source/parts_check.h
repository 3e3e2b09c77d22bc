/// That a tile is the same, read whole and handed over in parts.
#pragma once

#include <filesystem>

#include "format/source/source.h"

namespace gigabake::test {

/// Fails the running test where reading with a sink gives other triangles, values, counts, materials or placements than
/// reading without, in parts that are not as source.h has them, or refuses with another line. Returns the parts.
std::size_t expect_same_in_parts(const TileRef& tile, const std::filesystem::path& root);

}  // namespace gigabake::test
