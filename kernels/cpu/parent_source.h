/// What the levels above a volume are made of, taken from its levels (lattice/parent_source.h).
#pragma once

#include "kernels/body/cell.h"
#include "kernels/cpu/levels.h"
#include "lattice/rules.h"

namespace gigabake::kernels {

/// levels: before approximate() and prune(); surface: of the last of them. Empty where there are none.
/// lod: of the last of them.
ParentSource parent_source(const std::vector<Level>& levels, int lod, const LevelSurface& surface, MipFilter filter);

}  // namespace gigabake::kernels
