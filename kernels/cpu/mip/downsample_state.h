/// Extracts the input of the overviews above a volume from its levels (core/octree/downsample_state.h).
#pragma once

#include "core/base/rules.h"
#include "kernels/body/cell.h"
#include "kernels/cpu/mip/levels.h"

namespace gigabake::kernels {

/// Returns the input of the overviews; empty if there are no levels. levels: before approximate() and prune(). surface,
/// lod: of the coarsest level.
DownsampleState downsample_state(const std::vector<Level>& levels, int lod, const LevelSurface& surface,
                                 MipFilter filter);

}  // namespace gigabake::kernels
