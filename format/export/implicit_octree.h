/// Availability of an implicit oct-tree of 3D Tiles, and its subtree files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gigabake {

/// Morton codes of a level's tiles (bit 3n is bit n of x), sorted, none twice. [0] is the root's level.
using TileLevels = std::vector<std::vector<std::uint64_t>>;

/// Levels of a subtree: as few files as 37,449 bits each allow.
std::uint32_t subtree_levels(std::uint32_t levels);

/// The subtree whose root is tile `root` of `level`, a multiple of subtree_levels(tiles.size()): the binary format of
/// 3D Tiles 1.1. Every available tile has content.
std::string subtree_file(const TileLevels& tiles, std::uint32_t level, std::uint64_t root);
/// The same as a binary glTF 2.1 with 3DTILES_subtree.
std::vector<std::uint8_t> subtree_glb(const TileLevels& tiles, std::uint32_t level, std::uint64_t root);

}  // namespace gigabake
