/// The kernels' answer as the shard that holds it. Arrays move; only node kinds and levels' columns change their type.
#pragma once

#include <cstdint>
#include <vector>

#include "format/shard.h"
#include "kernels/cell.h"

namespace gigabake {

/// The header's content_hash is the volume's: the kernels' own, which `verify` compares with what the file holds.
Shard shard_from_volume(kernels::CellVolume volume, ShardHeader header);

/// Voxels per lod, those that constant nodes stand for included, as content_hash() counts them.
std::vector<std::uint64_t> voxel_counts(const Shard& shard);

}  // namespace gigabake
