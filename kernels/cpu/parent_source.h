/// Extracts the input of the overviews above a volume from its levels (lattice/parent_source.h).
#pragma once

#include "kernels/body/cell.h"
#include "kernels/cpu/levels.h"
#include "lattice/rules.h"

namespace gigabake::kernels {

/// Returns the input of the overviews; empty if there are no levels. levels: before approximate() and prune(). surface,
/// lod: of the coarsest level.
ParentSource parent_source(const std::vector<Level>& levels, int lod, const LevelSurface& surface, MipFilter filter);

}  // namespace gigabake::kernels
