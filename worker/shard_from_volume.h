/// The kernels' answer as the shard that holds it. Arrays move; nothing is copied.
#pragma once

#include "format/shard/packed_shard.h"
#include "format/shard/shard.h"
#include "kernels/body/cell.h"
#include "kernels/pack/packer.h"

namespace gigabake {

/// The header's content_hash is the volume's: the kernels' own, which `verify` compares with what the file holds.
Shard shard_from_volume(kernels::CellVolume volume, ShardHeader header);

/// The same of a cell that a device has packed. Takes its levels, nodes and hashes; borrows its memory.
PackedShard shard_from_packed(kernels::PackedCell& cell, ShardHeader header);

}  // namespace gigabake
