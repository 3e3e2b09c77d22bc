/// The invariants of a shard: everything a reader may rely on without looking.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "format/shard/shard.h"

namespace gigabake {

/// Errors (all)  InputError naming `path`, the dataset and the first row that breaks a rule.
void check_header(const std::filesystem::path& path, const ShardHeader& header);
/// Level by level from the root, Morton order, every child linked from exactly one parent, bricks numbered in order.
void check_nodes(const std::filesystem::path& path, const ShardHeader& header, const NodeTable& nodes);
/// The level has the bricks that its nodes say, and `first` counts the masks' bits, from 0 on.
void check_bricks_of_level(const std::filesystem::path& path, const BrickLevel& level, int lod,
                           std::uint64_t bricks_of_nodes);

/// How many brick nodes there are of each level. Range  both columns of one length; lods beyond the header's are
/// ignored.
std::vector<std::uint64_t> brick_counts(const ShardHeader& header, const std::vector<std::uint8_t>& lod,
                                        const std::vector<NodeKind>& kind);

/// Bricks from `first_brick` of a level on: `first` rises by the number of each mask's bits, which is never 0.
/// Range  8 words of mask a brick; one entry of `first` more than bricks.
void check_bricks(const std::filesystem::path& path, int lod, std::uint64_t first_brick,
                  std::span<const std::uint64_t> mask, std::span<const std::uint64_t> first);
/// Voxels from `first_voxel` of a level on: alpha is never 0.
void check_coverage(const std::filesystem::path& path, int lod, std::uint64_t first_voxel,
                    std::span<const std::uint8_t> rgba);
/// Voxels from `first_voxel` of a level on: each plane is one.
/// Range  facing_bytes a voxel; none where the level has no such channel.
void check_planes(const std::filesystem::path& path, int lod, std::uint64_t first_voxel,
                  std::span<const std::uint8_t> facing);
/// Rows from `first_node` of the nodes on: as voxels.
void check_planes_of_nodes(const std::filesystem::path& path, std::uint64_t first_node, std::span<const Facing> facing);

}  // namespace gigabake
