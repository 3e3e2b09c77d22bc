/// The error for a bake or a plan that has triangles but no visible voxel.
#pragma once

#include <string_view>

#include "core/base/error.h"
#include "format/source/source.h"
#include "scheduler/plan/plan.h"

namespace gigabake {

/// Returns the error to throw. It names the first invisible material (alpha 0), if there is one.
/// `consequence` completes the sentence "nothing is visible, so …".
/// Cost    Reads the materials of tiles up to the first tile with an invisible material.
InputError nothing_visible(const std::filesystem::path& source, const SceneSources& sources, const BakePlan& plan,
                           std::string_view consequence);

}  // namespace gigabake
