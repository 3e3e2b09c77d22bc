/// Reader of GigaVoxels scenes that export_gigavoxel() or the thesis's programs wrote.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "core/math/vec3.h"
#include "format/export/gigavoxels/gigavoxel_tree.h"

namespace gigabake {

/// Returns the paths of the tree files that a .gvp file lists, in the order of the list.
/// Errors  InputError: the file is not a .gvp file, or a listed path leads out of its folder.
std::vector<std::filesystem::path> gigavoxel_tree_files(const std::filesystem::path& gvp);

/// Reads a tree file in XML form (tree.gvx) or binary form (tree.gvo). The first bytes determine the form.
/// Errors  InputError naming file, element or byte, and rule: a size, count, link, depth or attribute is invalid.
GigavoxelTree read_gigavoxel_tree(const std::filesystem::path& tree_file);

/// A box of equal voxels of one depth, usually a single voxel.
struct GigavoxelBox {
  Vec3<std::uint64_t> lowest{}, extent{1, 1, 1};
  std::array<std::uint8_t, 4> rgba{};
  GradientBytes gradient{};
};

/// Visits all voxels of depth `depth` with an alpha above 0. `bricks` is the brick file of this depth.
/// Cost    Holds one brick, and up to 16 bytes per brick of the file, in memory.
/// Errors  InputError: the brick file is damaged, compressed, or lacks a brick that the tree refers to.
void for_each_gigavoxel(const GigavoxelTree& tree, std::uint32_t depth, const std::filesystem::path& bricks,
                        const std::function<void(const GigavoxelBox&)>& visit);

}  // namespace gigabake
