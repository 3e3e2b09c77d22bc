/// Reads GigaVoxels scenes: those that export writes, and those of the thesis's own programs.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "format/export/gigavoxel_tree.h"

namespace gigabake {

/// The oct-trees that a .gvp file lists, in its order. Errors  InputError: not such a file, paths out of its folder.
std::vector<std::filesystem::path> gigavoxel_tree_files(const std::filesystem::path& gvp);

/// tree.gvx or tree.gvo, by its first bytes.
/// Errors  InputError: sizes, counts, links, depths or attributes that are none of a tree; file, element or byte, rule.
GigavoxelTree read_gigavoxel_tree(const std::filesystem::path& tree_file);

/// A box of equal voxels of one depth; most are single ones.
struct GigavoxelBox {
  std::array<std::uint64_t, 3> lowest{}, extent{1, 1, 1};
  std::array<std::uint8_t, 4> rgba{};
  GradientBytes gradient{};
};

/// Every voxel of a depth that is not transparent. `bricks` is the depth's brick file.
/// Cost    One brick in memory, and 16 bytes for each.
/// Errors  InputError: the brick file is damaged, compressed, or lacks a brick that the tree names.
void for_each_gigavoxel(const GigavoxelTree& tree, std::uint32_t depth, const std::filesystem::path& bricks,
                        const std::function<void(const GigavoxelBox&)>& visit);

}  // namespace gigabake
