/// Clusters: groups of neighbouring triangles of a mesh. A cell that meets a corner of a large mesh moves, bins and
/// uploads the clusters near it, and no others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "format/source/mesh.h"

namespace gigabake {

/// Few enough that a cluster is small beside a cell, so many that its vertices are mostly its own.
inline constexpr std::size_t cluster_triangles = 512;
/// About what one takes, joined to others, whose triangles share their corners as those of a terrain do.
inline constexpr std::uint64_t cluster_bytes = cluster_triangles * (3 * 4 + 28 * 6 / 10);

/// The mesh's triangles in clusters of at most cluster_triangles: those whose centroids share a box of an oct-tree (a
/// prefix of their Morton codes; Lauterbach et al. 2009). Each cluster is a mesh with its own vertices; material and
/// position_step are the mesh's. Exact   Every triangle is in one cluster, with its corners in their order and their
/// values bit for bit. Range   Any positions: a triangle that is not finite, or far from all others, is in some
/// cluster. Cost    About 90 ns a triangle of one thread, and 8 bytes a triangle and 4 a vertex beside the result.
std::vector<Primitive> clusters_of(const Primitive& mesh);
/// The same clusters in the same order, one at a time: the visitor's until it returns.
void for_each_cluster(const Primitive& mesh, const std::function<void(const Primitive&)>& visit);

/// Clusters of one mesh as one mesh again, one behind the other.
Primitive joined(std::span<const std::shared_ptr<const Primitive>> clusters);

}  // namespace gigabake
