/// Availability of an implicit octree of 3D Tiles, and its subtree files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gigabake {

/// Morton codes of each level's tiles (bit 3n is bit n of x), sorted and unique. [0] is the root's level.
using TileLevels = std::vector<std::vector<std::uint64_t>>;

/// Returns the number of levels per subtree that minimizes the number of files; a file has at most 37,449 bits.
std::uint32_t subtree_levels(std::uint32_t levels);

/// Returns the subtree file of tile `root` of `level`, in the binary format of 3D Tiles 1.1. Every available tile has
/// content.
/// Range   level is a multiple of subtree_levels(tiles.size()).
std::string subtree_file(const TileLevels& tiles, std::uint32_t level, std::uint64_t root);
/// Returns the same subtree as a binary glTF 2.1 with 3DTILES_subtree.
std::vector<std::uint8_t> subtree_glb(const TileLevels& tiles, std::uint32_t level, std::uint64_t root);

}  // namespace gigabake
