/// The downsample state of a volume: the input of the overviews above it (core/octree/downsample_state.h).
#pragma once

#include "core/base/rules.h"
#include "kernels/body/cell.h"
#include "kernels/cpu/mip/levels.h"

namespace gigabake::kernels {

/// Returns the downsample state of a volume. It is empty if there are no levels.
/// Range   `levels` are the levels before quantize_groups() and prune(). `surface` and `lod` belong to the coarsest
///         level.
DownsampleState downsample_state(const std::vector<Level>& levels, int lod, const LevelSurface& surface,
                                 MipFilter filter);

}  // namespace gigabake::kernels
