/// The identity of a voxel set: a hash of every voxel summed mod 2^128, so that order, bricks, shards and cells do not show.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/shard.h"

namespace gigabake {

/// Hash of one voxel: XXH3-128 over lod, its lowest corner in lod-0 voxels (3 × int64, little endian), rgba, normal.
/// Constant and leaf-constant nodes hash as the voxels they stand for.
Hash128 voxel_hash(int lod, std::array<std::int64_t, 3> corner_lattice, const std::uint8_t rgba[4], const std::int8_t normal[2]);

/// Per lod, of a whole cell.
std::vector<Hash128> content_hash(const Shard& shard);

}  // namespace gigabake
