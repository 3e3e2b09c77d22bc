/// Compares a tile that is read whole with the same tile that is read in parts.
#pragma once

#include <filesystem>

#include "format/source/source.h"

namespace gigabake::test {

/// Fails the running test if reading with a sink differs from reading without one. Compares triangles, values, counts,
/// materials, placements and error messages, and checks that the parts conform to source.h. Returns the number of
/// parts.
std::size_t expect_same_in_parts(const TileRef& tile, const std::filesystem::path& root);

}  // namespace gigabake::test
