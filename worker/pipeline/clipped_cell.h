/// The part of a stored cell that lies inside an area of interest.
#pragma once

#include "core/base/thread_pool.h"
#include "format/area/area_in_scene.h"
#include "format/shard/shard_reader.h"
#include "kernels/body/cell.h"

namespace gigabake {

/// Computes the volume of a cell from the voxels of lod 0 and the leaves that its shard stores and that are inside the
/// area.
/// `parameters` are the parameters of the bake that wrote the shard.
/// Exact   The volume equals a bake with the area if the bake has max_error 0. Else stored voxels are quantized again.
/// Errors  InputError: the shard is damaged.
kernels::CellVolume clipped_volume(const ShardReader& shard, const kernels::CellParameters& parameters,
                                   const AreaInScene& area, const ThreadPool& pool);

}  // namespace gigabake
