/// Availability of an implicit oct-tree of 3D Tiles, and its subtree files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gigabake {

/// Morton codes of a level's tiles (bit 3n is bit n of x), sorted, none twice. [0] is the root's level.
using TileLevels = std::vector<std::vector<std::uint64_t>>;

inline constexpr std::uint32_t subtree_levels = 4;

/// The subtree whose root is tile `root` of `level`, a multiple of subtree_levels: the binary format of 3D Tiles 1.1.
/// Every available tile has content.
std::string subtree_file(const TileLevels& tiles, std::uint32_t level, std::uint64_t root);

}  // namespace gigabake
