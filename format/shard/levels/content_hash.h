/// A hash that identifies a set of voxels. Voxel hashes are summed mod 2^128, so the sum does not depend on the order
/// of voxels or on their partition into bricks, shards and cells.
#pragma once

#include <cstdint>
#include <vector>

#include "core/math/vec3.h"
#include "format/shard/shard.h"

namespace gigabake {

/// Returns the XXH3-128 hash of a 34-byte record: lod (int32), the voxel's lowest corner in lod-0 voxels of the lattice
/// (3 × int64), rgba, normal. If `directional_coverage` is not null, or `has_classes`, the record has 6 more bytes:
/// facing (zeros if it is null) and the class (uint16). Integers are little endian. A voxel of a constant node has the
/// same hash as a stored voxel.
Hash128 voxel_hash(int lod, Vec3i64 corner_lattice, const std::uint8_t rgba[4], const std::int8_t normal[2],
                   const std::uint8_t* directional_coverage = nullptr, bool has_classes = false,
                   VoxelClass voxel_class = no_class);

/// Returns the content hash per lod of a complete shard. Verification compares it with the hash that
/// core/octree/voxel_hash.h computed during baking.
/// Cost    About 16 ns per voxel and thread.
std::vector<Hash128> content_hash(const Shard& shard, int threads = 1);

/// Returns the content hash of a single level. `lod` is relative to the shard's finest level.
/// Cost    About 16 ns per voxel, on the calling thread.
Hash128 content_hash(const ShardHeader& header, const NodeTable& nodes, const BrickLevel& level, int lod);

}  // namespace gigabake
