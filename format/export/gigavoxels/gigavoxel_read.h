/// Reader of GigaVoxels scenes, written by export or by the thesis's programs.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "core/math/vec3.h"
#include "format/export/gigavoxels/gigavoxel_tree.h"

namespace gigabake {

/// Returns the octrees listed in a .gvp file, in its order.
/// Errors  InputError: not such a file, or a path leaves its folder.
std::vector<std::filesystem::path> gigavoxel_tree_files(const std::filesystem::path& gvp);

/// Reads tree.gvx or tree.gvo; the first bytes determine which.
/// Errors  InputError: invalid sizes, counts, links, depths or attributes; names file, element or byte, and rule.
GigavoxelTree read_gigavoxel_tree(const std::filesystem::path& tree_file);

/// A box of equal voxels of one depth, usually a single voxel.
struct GigavoxelBox {
  Vec3<std::uint64_t> lowest{}, extent{1, 1, 1};
  std::array<std::uint8_t, 4> rgba{};
  GradientBytes gradient{};
};

/// Visits every voxel of a depth that is not fully transparent. `bricks` is the depth's brick file.
/// Cost    One brick in memory, plus 16 bytes per brick.
/// Errors  InputError: the brick file is damaged, compressed, or lacks a brick that the tree names.
void for_each_gigavoxel(const GigavoxelTree& tree, std::uint32_t depth, const std::filesystem::path& bricks,
                        const std::function<void(const GigavoxelBox&)>& visit);

}  // namespace gigabake
