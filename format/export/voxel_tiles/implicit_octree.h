/// Tile availability in an implicit octree of 3D Tiles, and the subtree files that store it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gigabake {

/// The Morton codes of the tiles per level (bit 3n is bit n of x), sorted and unique. Element 0 is the root's level.
using TileLevels = std::vector<std::vector<std::uint64_t>>;

/// Returns the number of levels per subtree, at most 6 (37,449 tiles). It minimizes the number of subtrees on a path
/// from the root to the last of `levels` levels.
std::uint32_t subtree_levels(std::uint32_t levels);

/// Returns the file of the subtree whose root is tile `root` of level `level`, in the binary format of 3D Tiles 1.1.
/// Every available tile has content.
/// Range   `level` is a multiple of subtree_levels(tiles.size()).
std::string subtree_file(const TileLevels& tiles, std::uint32_t level, std::uint64_t root);
/// Returns the subtree of subtree_file() as a binary glTF 2.1 with 3DTILES_subtree.
std::vector<std::uint8_t> subtree_glb(const TileLevels& tiles, std::uint32_t level, std::uint64_t root);

}  // namespace gigabake
