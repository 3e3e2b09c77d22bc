/// The failure of a bake that found triangles but no voxel.
#pragma once

#include "format/source/source.h"
#include "lattice/error.h"
#include "scheduler/plan.h"

namespace gigabake {

/// Returns the error to throw: it names the first material that is invisible everywhere (alpha 0), if there is one.
/// Cost  reads the materials of tiles up to the first that has such a material.
InputError nothing_visible(const std::filesystem::path& source, const SceneSources& sources, const BakePlan& plan);

}  // namespace gigabake
