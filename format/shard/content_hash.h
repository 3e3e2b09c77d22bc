/// The identity of a voxel set: a hash of every voxel summed mod 2^128, so that order, bricks, shards and cells do not
/// show.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/shard/shard.h"

namespace gigabake {

/// XXH3-128 over 34 bytes: lod (int32), the voxel's lowest corner in lod-0 voxels of the lattice (3 × int64), rgba,
/// normal; integers little endian. Voxels of constant nodes hash as if they were stored.
Hash128 voxel_hash(int lod, std::array<std::int64_t, 3> corner_lattice, const std::uint8_t rgba[4],
                   const std::int8_t normal[2], const std::uint8_t* facing = nullptr);

/// Per lod, of a whole cell as it was read: the check of the hash that lattice/voxel_hash.h made while baking.
/// Cost  about 16 ns a voxel and thread.
std::vector<Hash128> content_hash(const Shard& shard, int threads = 1);

/// Returns the hash of one level that was read alone. lod: of the shard. Cost  as above.
Hash128 content_hash(const ShardHeader& header, const NodeTable& nodes, const BrickLevel& level, int lod);

}  // namespace gigabake
