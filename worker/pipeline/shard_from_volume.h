/// Converts kernel results to shards. Arrays are moved, not copied.
#pragma once

#include <optional>

#include "core/octree/parameters.h"
#include "format/job/cell_job.h"
#include "format/shard/packed_shard.h"
#include "format/shard/shard.h"
#include "kernels/body/cell.h"
#include "kernels/pack/packer.h"

namespace gigabake {

/// Returns the shard of a volume. The header's content_hash comes from the kernels; `verify` compares it with the
/// file's content.
Shard shard_from_volume(kernels::CellVolume volume, ShardHeader header);

/// Returns the shard of a cell that a device has packed. Moves the cell's levels, nodes and hashes. The shard points
/// into PackedCell::memory, so `cell` must outlive it.
PackedShard shard_from_packed(kernels::PackedCell& cell, ShardHeader header);

/// Returns true if the header is the one that this bake would write. The fingerprint covers all fields; comparing the
/// fields too detects an edited file.
bool is_of_job(const ShardHeader& header, const CellJob& job, const BakeParameters& parameters,
               const std::optional<Geodetic>& origin);

}  // namespace gigabake
