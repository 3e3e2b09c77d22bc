/// Stage 5 of a cell: the node table, without what a constant node already says.
#pragma once

#include <vector>

#include "kernels/body/cell.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

/// Builds the nodes of all levels and takes constant bricks out of the levels' arrays. A constant brick has all 512
/// voxels, equal in every channel; where everything below is the same value too, the whole branch is one node.
/// Exact   Expanding the nodes gives back the levels, bit by bit.
/// Errors  std::length_error beyond 2^32-1 nodes.
NodeTable prune(std::vector<Level>& levels, const ThreadPool& pool);

/// The nodes of levels of which every brick is stored, constant or not. Errors  as prune().
NodeTable brick_nodes(const std::vector<Level>& levels);

}  // namespace gigabake::kernels
