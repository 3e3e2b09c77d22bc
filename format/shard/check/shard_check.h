/// Checks of the invariants of a shard. All readers rely on these invariants.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "format/shard/shard.h"

namespace gigabake {

/// Checks the attributes of the root group.
/// Errors  All functions of this file: InputError naming `path`, the dataset and the first row that breaks a rule.
void check_header(const std::filesystem::path& path, const ShardHeader& header);
/// Checks the order of the nodes: level by level from the root, and in Morton order within a level. Checks the
/// numbering of bricks, and that every node but the root has exactly one parent.
void check_leaves(const std::filesystem::path& path, const NodeTable& nodes, const std::vector<BrickLevel>& levels);
void check_nodes(const std::filesystem::path& path, const ShardHeader& header, const NodeTable& nodes);
/// Checks that the level has `bricks_of_nodes` bricks, and that level.first is the running sum of the mask bits per
/// brick. The sum starts at 0.
void check_bricks_of_level(const std::filesystem::path& path, const BrickLevel& level, int lod,
                           std::uint64_t bricks_of_nodes);

/// Returns the number of brick nodes per level. Ignores nodes whose lod is not below header.lods.
/// Range   Both columns have the same length.
std::vector<std::uint64_t> brick_counts(const ShardHeader& header, const std::vector<std::uint8_t>& lod,
                                        const std::vector<NodeKind>& kind);

/// Checks consecutive bricks of a level, starting at brick `first_brick`. Each brick has at least one mask bit, and
/// `first` increases by the number of mask bits.
/// Range   `mask` has 8 words per brick; `first` has one entry more than there are bricks.
void check_bricks(const std::filesystem::path& path, int lod, std::uint64_t first_brick,
                  std::span<const std::uint64_t> mask, std::span<const std::uint64_t> first);
/// Checks that no voxel has alpha 0. `rgba` begins at voxel `first_voxel` of the level.
void check_coverage(const std::filesystem::path& path, int lod, std::uint64_t first_voxel,
                    std::span<const std::uint8_t> rgba);
/// Checks that the plane byte of each voxel is valid (is_plane()). `directional_coverage` begins at voxel `first_voxel`
/// of the level.
/// Range   `directional_coverage` has directional_coverage_bytes per voxel; it is empty if the level does not have this
///         channel.
void check_planes(const std::filesystem::path& path, int lod, std::uint64_t first_voxel,
                  std::span<const std::uint8_t> directional_coverage);
/// Checks the plane byte of each node like check_planes(). `directional_coverage` begins at row `first_node` of the
/// node table.
void check_planes_of_nodes(const std::filesystem::path& path, std::uint64_t first_node,
                           std::span<const DirectionalCoverage> directional_coverage);

}  // namespace gigabake
