/// Stage 5 of a cell: the node table, and the removal of bricks that constant nodes represent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"
#include "kernels/body/prune/node.h"

namespace gigabake::kernels {

/// Builds the nodes of all levels and removes constant bricks from the levels' arrays. A brick is constant if all its
/// 512 voxels exist and are equal in every channel. A branch of equal constant bricks becomes one
/// node.
/// Exact   Expanding the nodes reproduces the levels bit by bit.
/// Errors  std::length_error beyond 2^32-1 nodes.
NodeTable prune(std::vector<Level>& levels, const ThreadPool& pool);

/// Returns the nodes of levels that store all bricks, including constant bricks.
/// Errors  The errors of prune().
NodeTable brick_nodes(const std::vector<Level>& levels);

/// Returns the value of all voxels of a brick if it is constant, else nullopt.
std::optional<CommonVoxel> common_value(const Level& level, std::size_t brick);

/// Appends a node without children. `has_coverage` states whether its level has directional coverage, `has_classes`
/// whether the cell has classes. A brick gets the number `brick`, which is then incremented. Append all nodes of a
/// level, by rising key, from the coarsest level.
void append_node(std::uint64_t key, std::size_t lod, NodeKind kind, const CommonVoxel& voxel, bool has_coverage,
                 bool has_classes, std::uint32_t& brick, NodeTable& nodes);

/// Links parents to children: nodes [begin, end) are the parents of nodes [end, nodes.key.size()).
void link_children(NodeTable& nodes, std::size_t begin, std::size_t end);

}  // namespace gigabake::kernels
