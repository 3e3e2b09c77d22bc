/// Checks of a shard's invariants, on which all readers may rely.
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
/// Checks the order (level by level from the root, Morton order) and the numbering of bricks. Checks that every node
/// but the root has exactly one parent.
void check_nodes(const std::filesystem::path& path, const ShardHeader& header, const NodeTable& nodes);
/// Checks that the level has `bricks_of_nodes` bricks, and that `first` counts the bits of the masks, starting at 0.
void check_bricks_of_level(const std::filesystem::path& path, const BrickLevel& level, int lod,
                           std::uint64_t bricks_of_nodes);

/// Returns the number of brick nodes per level. Ignores lods beyond the header's.
/// Range   Both columns have the same length.
std::vector<std::uint64_t> brick_counts(const ShardHeader& header, const std::vector<std::uint8_t>& lod,
                                        const std::vector<NodeKind>& kind);

/// Checks bricks of a level, starting at `first_brick`: `first` increases by the number of bits in each mask, which is
/// never 0.
/// Range   8 words of mask per brick; bricks+1 entries of `first`.
void check_bricks(const std::filesystem::path& path, int lod, std::uint64_t first_brick,
                  std::span<const std::uint64_t> mask, std::span<const std::uint64_t> first);
/// Checks that the alpha of voxels, starting at `first_voxel` of the level, is never 0.
void check_coverage(const std::filesystem::path& path, int lod, std::uint64_t first_voxel,
                    std::span<const std::uint8_t> rgba);
/// Checks that the plane of each voxel, starting at `first_voxel` of the level, is a valid code.
/// Range   facing_bytes per voxel; empty if the level has no such channel.
void check_planes(const std::filesystem::path& path, int lod, std::uint64_t first_voxel,
                  std::span<const std::uint8_t> facing);
/// Checks the planes of constant nodes like the planes of voxels, starting at row `first_node`.
void check_planes_of_nodes(const std::filesystem::path& path, std::uint64_t first_node, std::span<const Facing> facing);

}  // namespace gigabake
