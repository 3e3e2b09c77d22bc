/// The kernels' answer as the shard that holds it. Arrays move; only node kinds and levels' columns change their type.
#pragma once

#include "format/shard.h"
#include "kernels/cell.h"

namespace gigabake {

/// The header's content_hash is the volume's: the kernels' own, which `verify` compares with what the file holds.
Shard shard_from_volume(kernels::CellVolume volume, ShardHeader header);

}  // namespace gigabake
