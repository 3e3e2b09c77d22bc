/// The kernels' answer as the shard that holds it. Arrays move; nothing is copied.
#pragma once

#include "format/shard/shard.h"
#include "kernels/body/cell.h"

namespace gigabake {

/// The header's content_hash is the volume's: the kernels' own, which `verify` compares with what the file holds.
Shard shard_from_volume(kernels::CellVolume volume, ShardHeader header);

}  // namespace gigabake
